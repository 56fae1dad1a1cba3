#include "victorious/apps/cluster/index_task.h"

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
  EXPECT_EQ(read->segment_s, 0);
  EXPECT_FALSE(read->part);
  EXPECT_FALSE(read->redo_other);
  IndexTask redone = task;
  redone.redo_other = true;
  const auto again = ToQueue(redone, "0123", postgres::TaskPriority::kPerson);
  EXPECT_EQ(again->key, queued->key) << "the same results are wanted";
  EXPECT_TRUE(FromQueue(again->kind, again->payload)->redo_other);
}

TEST(IndexTask, OpenSegmentsAreItsParts) {
  const IndexTask task{.video = "/a.mp4", .options = {"--models", "/m"}, .program = "1-x", .segment_s = 60};
  const auto queued = ToQueue(task, "0123", postgres::TaskPriority::kBatch);
  EXPECT_EQ(FromQueue(queued->kind, queued->payload)->segment_s, 60);
  const VideoCut cut{.id = 12,
                     .video = 7,
                     .plan = "plan",
                     .segments = {{{0, 600}, SegmentState::kDone, ""},
                                  {{600, 1200}, SegmentState::kOpen, ""},
                                  {{1200, 1260}, SegmentState::kQuarantined, "signal 11"},
                                  {{1260, 2000}, SegmentState::kOpen, ""}}};
  const auto parts = PartsOf(task, queued->key, cut);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NE(parts[0].key, parts[1].key);
  EXPECT_EQ(parts[0].program, "1-x");
  const auto read = FromQueue(parts[1].kind, parts[1].payload);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->video, "/a.mp4");
  EXPECT_THAT(read->options, ElementsAre("--models", "/m"));
  EXPECT_EQ(read->segment_s, 0) << "it is not cut again";
  EXPECT_EQ(read->part->cut, 12);
  EXPECT_EQ(read->part->frames, (FrameInterval{1260, 2000}));
  VideoCut other = cut;
  other.id = 13;
  EXPECT_NE(PartsOf(task, queued->key, other)[0].key, parts[0].key);
}

// A worker whose folder has other models would delete the results of all videos.
TEST(IndexTask, OtherModelsThanSubmittedAreRefused) {
  const IndexTask task{.video = "/a.mp4", .options = {}, .program = "1-x", .targets = {{"car", "c1"}, {"truck", "t1"}}};
  const auto queued = ToQueue(task, "0123", postgres::TaskPriority::kBatch);
  const auto read = FromQueue(queued->kind, queued->payload);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->targets, task.targets);
  const VideoCut cut{.id = 1, .video = 7, .plan = "", .segments = {{{0, 600}, SegmentState::kOpen, ""}}};
  const auto part = PartsOf(task, queued->key, cut).at(0);
  EXPECT_EQ(FromQueue(part.kind, part.payload)->targets, task.targets);
  const std::string text = TargetsText(task.targets);
  const ModelRecord car{.name = "car", .content_id = "c1"};
  const ModelRecord truck{.name = "truck", .content_id = "t1"};
  EXPECT_TRUE(CheckTargets(text, std::vector{truck, car}));
  const auto refusal = [&](const std::vector<ModelRecord>& present) {
    const Status checked = CheckTargets(text, present);
    return checked ? "none" : checked.error().message;
  };
  EXPECT_THAT(refusal({car, {.name = "truck", .content_id = "t2"}}), HasSubstr("truck was replaced"));
  EXPECT_THAT(refusal({car}), HasSubstr("truck was removed"));
  EXPECT_THAT(refusal({car, truck, {.name = "bus", .content_id = "b1"}}), HasSubstr("bus was added"));
  for (const char* invalid : {"", "[]", R"({"car": 1})", "{\"car\": \"\xFF\"}"}) {
    EXPECT_EQ(CheckTargets(invalid, {}).error().code, ErrorCode::kInvalidArgument) << invalid;
  }
}

TEST(IndexTask, NamesTheContentOfItsFiles) {
  const IndexTask task{.video = "/a.mp4",
                       .options = {},
                       .program = "1-x",
                       .content_id = "c1",
                       .files = {{"/a.mp4", std::string(32, '1'), 7}, {"/m/car.vmodel", std::string(32, 'f'), 0}}};
  const auto queued = ToQueue(task, "0123", postgres::TaskPriority::kBatch);
  const auto read = FromQueue(queued->kind, queued->payload);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->content_id, "c1");
  EXPECT_EQ(read->files, task.files);
  const VideoCut cut{.id = 1, .video = 7, .plan = "", .segments = {{{0, 600}, SegmentState::kOpen, ""}}};
  const auto part = PartsOf(task, queued->key, cut).at(0);
  EXPECT_EQ(FromQueue(part.kind, part.payload)->files, task.files);
  for (const char* files : {"1", "[1]", R"([{"path": "/a"}])", R"([{"path": "/a", "content_id": "b", "bytes": 1}])"}) {
    const auto invalid =
        FromQueue("index", std::string(R"({"video": "v", "program": "1", "options": [], "files": )") + files + "}");
    ASSERT_FALSE(invalid) << files;
    EXPECT_THAT(invalid.error().message, HasSubstr("files must be"));
  }
}

TEST(IndexTask, InvalidPayloadsAreErrors) {
  EXPECT_THAT(FromQueue("stitch", "{}").error().message, HasSubstr("stitch"));
  for (const char* payload : {"", "[]", R"({"video": "a\u0000b", "program": "1", "options": []})",
                              "{\"video\": \"\xFF\"}", "{}", R"({"video": 1, "program": "1", "options": []})",
                              R"({"video": "v", "program": "1"})", R"({"video": "v", "program": "1", "options": [1]})",
                              R"({"video": "v", "program": "1", "options": ["--models"]})",
                              R"({"video": "v", "program": "1", "options": ["--draw", "/home/ann/x.mp4"]})",
                              R"({"video": "v", "program": "1", "options": ["--models", "--draw"]})",
                              R"({"video": "v", "program": "1", "options": ["--db=x", "y"]})"}) {
    const auto task = FromQueue("index", payload);
    ASSERT_FALSE(task) << payload;
    EXPECT_EQ(task.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(task.error().message, HasSubstr("not valid"));
  }
  EXPECT_EQ(FromQueue("two\nlines", "{}").error().message.find('\n'), std::string::npos);
  for (const char* part : {"", R"(, "cut": 1, "from": 0, "to": 0)", R"(, "cut": 1, "from": -5, "to": 10)",
                           R"(, "cut": "1", "from": 0, "to": 10)", R"(, "segment_s": -1)"}) {
    const auto task = FromQueue("segment", std::string(R"({"video": "v", "program": "1", "options": [])") + part + "}");
    ASSERT_FALSE(task) << part;
    EXPECT_THAT(task.error().message, HasSubstr("not valid"));
  }
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
