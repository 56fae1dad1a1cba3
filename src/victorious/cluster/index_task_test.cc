#include "victorious/cluster/index_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(IndexTask, ComesBackAsItWasSubmitted) {
  const IndexTask task{
      .video = "/data/a \"flight\".mp4", .options = {"--models", "/m", "--every", "5"}, .program = "1-x"};
  const auto queued = ToQueue(task, "0123", postgres::TaskPriority::kPerson);
  ASSERT_TRUE(queued) << queued.error().message;
  EXPECT_EQ(queued->key, R"(0123 ["--models","/m","--every","5"])") << "other options are another task";
  EXPECT_EQ(queued->program, "1-x");
  EXPECT_EQ(queued->priority, postgres::TaskPriority::kPerson);
  const auto read = FromQueue(queued->kind, queued->payload);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->video, task.video);
  EXPECT_THAT(read->options, ElementsAre("--models", "/m", "--every", "5"));
  EXPECT_EQ(read->program, "1-x");
}

TEST(IndexTask, InvalidPayloadsAreErrors) {
  EXPECT_THAT(FromQueue("stitch", "{}").error().message, HasSubstr("stitch"));
  for (const char* payload :
       {"", "[]", R"({"video": "a\u0000b", "program": "1", "options": []})", "{\"video\": \"\xFF\"}", "{}",
        R"({"video": 1, "program": "1", "options": []})", R"({"video": "v", "program": "1"})",
        R"({"video": "v", "program": "1", "options": [1]})"}) {
    const auto task = FromQueue("index", payload);
    ASSERT_FALSE(task) << payload;
    EXPECT_EQ(task.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(task.error().message, HasSubstr("not valid"));
  }
  EXPECT_EQ(FromQueue("two\nlines", "{}").error().message.find('\n'), std::string::npos);
}

TEST(IndexTask, TextsThatJsonCannotHoldAreRefused) {
  const auto submit = [](const std::string& video, const std::string& option) {
    return ToQueue({.video = video, .options = {"--models", option}, .program = "1"}, "0", {});
  };
  EXPECT_TRUE(submit("/d/\xC3\xA9.mp4", "/m"));
  for (const auto& [video, option] : {std::pair<std::string, std::string>("/d/\xFF\n.mp4", "/m"),
                                      {"/d/a.mp4", "/m/\xC3"},
                                      {std::string("/d/a\0b", 6), "/m"}}) {
    const auto task = submit(video, option);
    ASSERT_FALSE(task) << video;
    EXPECT_EQ(task.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(task.error().message, HasSubstr("not UTF-8"));
    EXPECT_EQ(task.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace victorious
