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
  const postgres::NewTask queued = ToQueue(task, "0123", postgres::TaskPriority::kPerson);
  EXPECT_EQ(queued.key, R"(0123 ["--models","/m","--every","5"])") << "other options are another task";
  EXPECT_EQ(queued.program, "1-x");
  EXPECT_EQ(queued.priority, postgres::TaskPriority::kPerson);
  const auto read = FromQueue(queued.kind, queued.payload);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->video, task.video);
  EXPECT_THAT(read->options, ElementsAre("--models", "/m", "--every", "5"));
  EXPECT_EQ(read->program, "1-x");
}

TEST(IndexTask, InvalidPayloadsAreErrors) {
  EXPECT_THAT(FromQueue("stitch", "{}").error().message, HasSubstr("stitch"));
  for (const char* payload :
       {"", "[]", "{}", R"({"video": 1, "program": "1", "options": []})", R"({"video": "v", "program": "1"})",
        R"({"video": "v", "program": "1", "options": [1]})"}) {
    EXPECT_FALSE(FromQueue("index", payload)) << payload;
  }
}

}  // namespace
}  // namespace victorious
