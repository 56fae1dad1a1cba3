#include "victorious/apps/cluster/cluster_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/apps/cluster/cluster_test.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

using postgres::TaskCounts;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using PostgresClusterStatusTest = PostgresClusterTest;

TEST_F(PostgresClusterStatusTest, SaysWhatRunsAndWhatFailed) {
  const auto reader = ClusterReader::Open(url_);
  ASSERT_TRUE(reader) << reader.error().message;
  const ClusterStatus nothing = (*reader)->Read().value();
  EXPECT_EQ(nothing.videos, TaskCounts());
  EXPECT_THAT(nothing.tasks, IsEmpty());
  EXPECT_FALSE(nothing.left_s);

  for (const char* video : {"/a.mp4", "/b.mp4", "/c.mp4"}) Submit(video);
  const auto done = queue_->Claim().value();
  ASSERT_TRUE(queue_->Complete(*done));
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    ASSERT_TRUE(queue_->Fail(*queue_->Claim().value(), "cannot be read"));
  }
  const auto running = queue_->Claim().value();
  ASSERT_TRUE(running);
  const VideoRecord video = store_->PutVideo({.content_id = "c", .name = "/c.mp4"}).value();
  IndexBatch batch;
  for (const std::int64_t frame : {30, 60}) {
    const ModelRecord model =
        store_->PutModel({.name = std::to_string(frame), .content_id = "m", .kind = ModelKind::kCad}).value();
    batch.progress.push_back(
        {.search = {.video = video.id, .model = model.id, .next_frame = frame, .options_json = "{}"},
         .expected_next_frame = 0});
  }
  ASSERT_TRUE(store_->Commit(batch));

  const ClusterStatus status = (*reader)->Read().value();
  EXPECT_EQ(status.videos, (TaskCounts{.running = 1, .done = 1, .failed = 1}));
  EXPECT_GT(status.video_s.value_or(-1), 0);
  EXPECT_GT(status.left_s.value_or(-1), 0);
  ASSERT_THAT(status.tasks, SizeIs(2));
  EXPECT_EQ(status.tasks[0].video, "/c.mp4");
  EXPECT_EQ(status.tasks[0].next_frame, 30);
  EXPECT_EQ(status.tasks[0].record.worker, kWorker);
  EXPECT_GE(status.tasks[0].record.silent_s.value_or(-1), 0);
  EXPECT_LT(status.tasks[0].record.silent_s.value_or(99), 60);
  EXPECT_EQ(status.tasks[1].video, "/b.mp4");
  EXPECT_EQ(status.tasks[1].record.reason, "cannot be read");
  EXPECT_FALSE(status.tasks[1].record.silent_s);
}

TEST(GapsBetweenTest, AreTimesThatNoneCovers) {
  constexpr std::int64_t kSecond = 1'000'000;
  const auto covered = [](std::int64_t from_s, std::int64_t to_s) {
    return CoveredTime{.source = "udp://a", .from_utc_us = from_s * kSecond, .to_utc_us = to_s * kSecond};
  };
  const std::vector<CoveredTime> times = {covered(0, 10), covered(2, 4), covered(11, 12), covered(20, 30)};
  EXPECT_EQ(GapsBetween(times), (std::vector<UtcInterval>{{12 * kSecond, 20 * kSecond}})) << "one second is none";
  EXPECT_THAT(GapsBetween({}), IsEmpty());
}

TEST_F(PostgresClusterStatusTest, SaysWhatIsKnownOfALiveSource) {
  const auto reader = ClusterReader::Open(url_).value();
  SubmitLive("udp://a:1");
  ClusterStatus status = reader->Read().value();
  EXPECT_EQ(status.videos, TaskCounts());
  ASSERT_THAT(status.sources, SizeIs(1));
  EXPECT_EQ(status.sources[0].source, "udp://a:1");
  EXPECT_EQ(status.sources[0].record.state, WorkState::kQueued);
  EXPECT_FALSE(status.sources[0].behind_s);

  ASSERT_TRUE(queue_->Claim().value());
  const VideoRecord video = store_->PutVideo({.content_id = "live", .name = "udp://a:1"}).value();
  const std::int64_t now_us = NowUtcMicroseconds();
  IndexBatch batch;
  batch.covered = {{video.id, 0, "udp://a:1", now_us - 60'000'000, now_us - 50'000'000},
                   {video.id, 99, "udp://a:1", now_us - 20'000'000, now_us - 3'000'000}};
  ASSERT_TRUE(store_->Commit(batch));
  status = reader->Read().value();
  ASSERT_THAT(status.sources, SizeIs(1));
  EXPECT_EQ(status.sources[0].record.worker, kWorker);
  EXPECT_EQ(status.sources[0].covered, (UtcInterval{now_us - 60'000'000, now_us - 3'000'000}));
  EXPECT_NEAR(status.sources[0].behind_s.value_or(0), 3, 1);
  EXPECT_EQ(status.sources[0].gaps, (std::vector<UtcInterval>{{now_us - 50'000'000, now_us - 20'000'000}}));
  EXPECT_THAT(status.tasks, IsEmpty());
}

TEST_F(PostgresClusterStatusTest, HidesTheCredentialsOfSources) {
  const std::string source = "rtsp://ann:secret@host/one";
  SubmitLive(source);
  const auto task = queue_->Claim().value();
  ASSERT_TRUE(queue_->Release(*task, {}, source + ": no packet for 10 s"));
  const VideoRecord video = store_->PutVideo({.content_id = "live", .name = source}).value();
  const std::int64_t now_us = NowUtcMicroseconds();
  ASSERT_TRUE(store_->Commit({.covered = {{video.id, 0, source, now_us - 1'000'000, now_us}}}));
  const ClusterStatus status = ClusterReader::Open(url_).value()->Read().value();
  ASSERT_THAT(status.sources, SizeIs(1));
  EXPECT_EQ(status.sources[0].source, "rtsp://host/one");
  EXPECT_EQ(status.sources[0].record.reason, "rtsp://host/one: no packet for 10 s");
  EXPECT_TRUE(status.sources[0].covered) << "the times are those of the whole address";
}

TEST_F(PostgresClusterStatusTest, NamesTheVideosOfGaps) {
  const auto reader = ClusterReader::Open(url_).value();
  const VideoRecord video = store_->PutVideo({.content_id = "a", .name = "/a.mp4"}).value();
  const ModelRecord model = store_->PutModel({.name = "m", .content_id = "m", .kind = ModelKind::kCad}).value();
  IndexBatch batch;
  batch.progress.push_back({.search = {.video = video.id, .model = model.id, .next_frame = 1, .options_json = "{}"},
                            .expected_next_frame = 0});
  ASSERT_TRUE(store_->Commit(batch));
  VideoCut cut{.video = video.id, .plan = "p"};
  cut.segments.push_back({{0, 60}, SegmentState::kOpen, ""});
  const std::int64_t id = segments_->Put(cut, std::span(&model.id, 1), {}).value();
  ASSERT_TRUE(segments_->GiveUp(id, {0, 60}, "signal 11"));
  ClusterStatus status = reader->Read().value();
  ASSERT_THAT(status.quarantined, SizeIs(1));
  EXPECT_EQ(status.quarantined[0].video, "/a.mp4");
  EXPECT_EQ(status.quarantined[0].segment.reason, "signal 11");
  EXPECT_THAT(status.gaps, IsEmpty());

  const CoverageGap gap{.video = video.id, .frames = {0, 60}, .from_s = 0, .to_s = 5.9, .reason = "signal 11"};
  ASSERT_TRUE(segments_->Finish(id, std::span(&gap, 1)));
  status = reader->Read().value();
  EXPECT_THAT(status.quarantined, IsEmpty());
  ASSERT_THAT(status.gaps, SizeIs(1));
  EXPECT_EQ(status.gaps[0].video, "/a.mp4");
  EXPECT_EQ(status.gaps[0].gap, gap);
}

}  // namespace
}  // namespace victorious
