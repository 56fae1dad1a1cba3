// Segments of a video that are searched apart, in any order, give what one pass gives.
#include <algorithm>
#include <functional>
#include <ranges>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/drawn_flight.h"
#include "testing/fault_injecting_store.h"
#include "testing/memory_segment_store.h"
#include "victorious/base/file.h"
#include "victorious/jobs/index/indexer.h"

namespace victorious {
namespace {

using testing::Contents;
using testing::DrawnFlight;
using testing::FaultInjectingStore;
using ::testing::HasSubstr;
using testing::MemorySegmentStore;
using testing::ShortFlight;
using ::testing::SizeIs;
using testing::VideosOf;

constexpr double kSegment_s = 1;

// Tracks restart every 5 frames; 10 frames per second.
IndexOptions ManyRestarts() {
  IndexOptions options;
  options.follow.restart_interval_frames = 5;
  options.keep.interval_s = 0.7;
  return options;
}

// One video, and workers that share its segments.
class IndexerSegmentsTest : public ::testing::Test {
 protected:
  Indexer MakeIndexer(std::vector<ObjectModel> models) const {
    return Indexer::Create(std::move(models), options_).value();
  }
  IndexJob Job() const { return {.video = flight_.video(), .telemetry = {}, .threads = threads_}; }

  SegmentedReport Begin(const Indexer& indexer, IndexStore& store) {
    const auto report = indexer.IndexBySegments(Job(), kSegment_s, CancelToken(), store, segments_);
    EXPECT_TRUE(report) << report.error().message;
    return report.value_or(SegmentedReport{});
  }

  std::vector<FrameInterval> OpenSegments(IndexStore& store) {
    std::vector<FrameInterval> open;
    const std::vector<VideoCut> cuts = segments_.CutsOf(VideosOf(store).at(0).id).value();
    for (const VideoCut& cut : cuts) {
      for (const Segment& segment : cut.segments) {
        if (segment.state == SegmentState::kOpen) open.push_back(segment.frames);
      }
    }
    return open;
  }

  void SearchAll(const Indexer& indexer, IndexStore& store) {
    std::vector<FrameInterval> open = OpenSegments(store);
    std::ranges::reverse(open);
    for (const FrameInterval& frames : open) {
      const auto report = indexer.IndexSegment(Job(), frames, CancelToken(), store, segments_);
      EXPECT_TRUE(report) << report.error().message;
    }
  }

  std::string OnePass(std::vector<ObjectModel> models) const {
    const auto store = flight_.Store("one.db");
    EXPECT_TRUE(MakeIndexer(std::move(models)).Index(Job(), CancelToken(), *store));
    return Contents(*store);
  }

  DrawnFlight flight_{ShortFlight(40)};
  IndexOptions options_ = ManyRestarts();
  MemorySegmentStore segments_;
  int threads_ = 2;
};

TEST_F(IndexerSegmentsTest, GiveWhatOnePassGives) {
  for (const int every : {0, 1, 7}) {
    for (const bool follow : {true, false}) {
      options_.every = every;
      options_.follow.enabled = follow;
      const auto store = flight_.Store("segments.db");
      const Indexer indexer = MakeIndexer(flight_.Models());
      EXPECT_TRUE(Begin(indexer, *store).waits_for);
      EXPECT_THAT(OpenSegments(*store), SizeIs(4)) << "of a second each";
      EXPECT_TRUE(Begin(indexer, *store).waits_for) << "until they are searched";
      SearchAll(indexer, *store);
      const SegmentedReport end = Begin(indexer, *store);
      EXPECT_FALSE(end.waits_for);
      const std::string contents = Contents(*store);
      EXPECT_EQ(contents, OnePass(flight_.Models())) << every << (follow ? ", followed" : "");
      EXPECT_THAT(contents, HasSubstr("finished"));
      const auto one = flight_.Store("one.db");
      EXPECT_EQ(store->FindSearch(1, 1).value()->options_json, one->FindSearch(1, 1).value()->options_json);
      EXPECT_THAT(segments_.CutsOf(1).value(), SizeIs(0));
      std::filesystem::remove(flight_ / "segments.db");
      std::filesystem::remove(flight_ / "one.db");
    }
  }
}

TEST_F(IndexerSegmentsTest, GiveWhatOnePassGivesWhereSomeFramesAreTracked) {
  options_.follow.frame_interval_s = 0.2;
  const auto store = flight_.Store("segments.db");
  const Indexer indexer = MakeIndexer(flight_.Models());
  EXPECT_TRUE(Begin(indexer, *store).waits_for);
  EXPECT_THAT(OpenSegments(*store), SizeIs(4)) << "of 10 frames, after which tracks restart";
  SearchAll(indexer, *store);
  EXPECT_FALSE(Begin(indexer, *store).waits_for);
  EXPECT_EQ(Contents(*store), OnePass(flight_.Models()));
}

// A worker queues no more segments of a long video than some, and has them joined before it queues the next ones.
TEST_F(IndexerSegmentsTest, AreJoinedAPartAtATime) {
  options_.tracklets.gap_s = 0.1;  // so that the next join needs little of the past
  for (const bool follow : {true, false}) {
    options_.follow.enabled = follow;
    const auto store = flight_.Store("segments.db");
    const Indexer indexer = MakeIndexer(flight_.Models());
    ASSERT_TRUE(Begin(indexer, *store).waits_for);
    const std::vector<FrameInterval> open = OpenSegments(*store);
    ASSERT_THAT(open, SizeIs(4));
    std::int64_t results_left = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      ASSERT_TRUE(indexer.IndexSegment(Job(), open[i], CancelToken(), *store, segments_));
      const bool is_last = i + 1 == open.size();
      for (int again = 0; again < (is_last ? 1 : 2); ++again) {
        EXPECT_EQ(Begin(indexer, *store).waits_for.has_value(), !is_last);
        EXPECT_EQ(store->FindSearch(1, 1).value()->next_frame, open[i].to);
      }
      if (is_last) break;
      const std::int64_t cut = segments_.CutsOf(1).value().at(0).id;
      results_left = 0;
      ASSERT_TRUE(segments_.VisitResults(cut, [&](FrameInterval, std::span<const std::byte>) -> Status {
        ++results_left;
        return {};
      }));
      EXPECT_LE(results_left, follow ? 3 : 2) << "what was joined is deleted, but for what the next join needs";
    }
    EXPECT_EQ(Contents(*store), OnePass(flight_.Models())) << (follow ? "followed" : "");
    std::filesystem::remove(flight_ / "segments.db");
    std::filesystem::remove(flight_ / "one.db");
  }
}

// Of the same name and size: the results of its segments are those of another video.
TEST_F(IndexerSegmentsTest, OtherContentIsNotJoined) {
  const auto store = flight_.Store("segments.db");
  const Indexer indexer = MakeIndexer(flight_.Models());
  ASSERT_TRUE(Begin(indexer, *store).waits_for);
  SearchAll(indexer, *store);
  std::string bytes = ReadFile(flight_.video()).value();
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);  // in a packet
  ASSERT_TRUE(WriteFileAtomically(flight_.video(), bytes));
  const auto again = indexer.IndexBySegments(Job(), kSegment_s, CancelToken(), *store, segments_);
  ASSERT_TRUE(again) << again.error().message;
  const std::vector<VideoRecord> videos = VideosOf(*store);
  ASSERT_THAT(videos, SizeIs(1)) << "the former content is replaced";
  EXPECT_FALSE(store->FindSearch(videos[0].id, 1).value().has_value()) << "nothing of it was joined";
}

TEST_F(IndexerSegmentsTest, ShortVideoIsIndexedAtOnce) {
  const auto store = flight_.Store("segments.db");
  const auto report =
      MakeIndexer(flight_.Models()).IndexBySegments(Job(), 60, CancelToken(), *store, segments_).value();
  EXPECT_FALSE(report.waits_for);
  EXPECT_EQ(report.index.frames_searched, 24) << "one each 0.2 s, and where the tracks restart";
  EXPECT_EQ(Contents(*store), OnePass(flight_.Models()));
}

// Stopped in its middle, a pass goes on in segments; those are joined by a process that is killed, and by the next one.
TEST_F(IndexerSegmentsTest, InterruptedPassAndJoinGoOn) {
  options_.keep.interval_s = 0;  // a commit every 32 frames
  options_.every = 1;
  const auto store = flight_.Store("segments.db");
  const Indexer indexer = MakeIndexer(flight_.Models());
  int commits = 0;
  FaultInjectingStore failing(
      *store, [&]() -> Status { return ++commits > 1 ? Fail(ErrorCode::kInternal, "killed") : Status(); });
  EXPECT_FALSE(indexer.Index(Job(), CancelToken(), failing));
  const auto next_frame = store->FindSearch(1, 1).value()->next_frame;
  EXPECT_GT(next_frame, 0);
  EXPECT_LT(next_frame, 40);
  const double segment_s = 0.5;
  ASSERT_TRUE(indexer.IndexBySegments(Job(), segment_s, CancelToken(), *store, segments_)->waits_for);
  EXPECT_LE(OpenSegments(*store).front().from, next_frame);
  SearchAll(indexer, *store);
  commits = 1;
  EXPECT_FALSE(indexer.IndexBySegments(Job(), segment_s, CancelToken(), failing, segments_));
  EXPECT_FALSE(indexer.IndexBySegments(Job(), segment_s, CancelToken(), *store, segments_)->waits_for);
  EXPECT_EQ(Contents(*store), OnePass(flight_.Models()));
}

TEST_F(IndexerSegmentsTest, NewModelIsSearchedAlone) {
  const auto store = flight_.Store("segments.db");
  const auto index = [&](const std::vector<ObjectModel>& models) {
    const Indexer indexer = MakeIndexer(models);
    ASSERT_TRUE(Begin(indexer, *store).waits_for);
    SearchAll(indexer, *store);
    ASSERT_FALSE(Begin(indexer, *store).waits_for);
    ASSERT_FALSE(Begin(indexer, *store).waits_for) << "nothing is left to do";
  };
  index({flight_.Model(0)});
  index(flight_.Models());
  const auto one = flight_.Store("one.db");
  ASSERT_TRUE(MakeIndexer({flight_.Model(0)}).Index(Job(), CancelToken(), *one));
  ASSERT_TRUE(MakeIndexer(flight_.Models()).Index(Job(), CancelToken(), *one));
  EXPECT_EQ(Contents(*store), Contents(*one));
}

// They are left: their task has nothing to do any more.
TEST_F(IndexerSegmentsTest, OtherModelsOrFramesAreNoSegment) {
  const auto store = flight_.Store("segments.db");
  const Indexer indexer = MakeIndexer(flight_.Models());
  ASSERT_TRUE(Begin(indexer, *store).waits_for);
  std::string said;
  IndexJob job = Job();
  job.inform = [&](const std::string& text) { said = text; };
  EXPECT_EQ(indexer.IndexSegment(job, {0, 11}, CancelToken(), *store, segments_)->frames_searched, 0);
  EXPECT_THAT(said, HasSubstr("frames 0 to 10"));
  const auto other = MakeIndexer({flight_.Model(0)}).IndexSegment(Job(), {0, 10}, CancelToken(), *store, segments_);
  EXPECT_EQ(other->frames_searched, 0);
  EXPECT_THAT(OpenSegments(*store), SizeIs(4));
  EXPECT_GT(indexer.IndexSegment(Job(), {0, 10}, CancelToken(), *store, segments_)->frames_searched, 0);
  const auto again = indexer.IndexSegment(Job(), {0, 10}, CancelToken(), *store, segments_);
  EXPECT_EQ(again->frames_searched, 0) << "it is done";
}

// Two tasks search one video for different models at the same time, each by its own cut.
TEST_F(IndexerSegmentsTest, SearchesForDifferentModelsDoNotDisturbEachOther) {
  const auto store = flight_.Store("segments.db");
  const Indexer first = MakeIndexer({flight_.Model(0)});
  const Indexer second = MakeIndexer({flight_.Model(1)});
  ASSERT_TRUE(Begin(first, *store).waits_for);
  ASSERT_TRUE(Begin(second, *store).waits_for);
  EXPECT_THAT(OpenSegments(*store), SizeIs(8));
  SearchAll(first, *store);
  EXPECT_THAT(OpenSegments(*store), SizeIs(4));
  EXPECT_FALSE(Begin(first, *store).waits_for);
  SearchAll(second, *store);
  EXPECT_FALSE(Begin(second, *store).waits_for);
  const auto one = flight_.Store("one.db");
  ASSERT_TRUE(first.Index(Job(), CancelToken(), *one));
  ASSERT_TRUE(second.Index(Job(), CancelToken(), *one));
  EXPECT_EQ(Contents(*store), Contents(*one));
}

// The rest is what one pass finds there; the gap is told.
TEST_F(IndexerSegmentsTest, QuarantinedSegmentIsAGap) {
  const auto store = flight_.Store("segments.db");
  const Indexer indexer = MakeIndexer(flight_.Models());
  ASSERT_TRUE(Begin(indexer, *store).waits_for);
  ASSERT_TRUE(segments_.GiveUp(segments_.CutsOf(1).value().at(0).id, {10, 20}, "signal 11"));
  SearchAll(indexer, *store);
  ASSERT_FALSE(Begin(indexer, *store).waits_for);
  const std::vector<CoverageGap> gaps = segments_.Gaps().value();
  ASSERT_THAT(gaps, SizeIs(1));
  EXPECT_EQ(gaps[0].frames, (FrameInterval{10, 20}));
  EXPECT_NEAR(gaps[0].from_s, 1, 1e-9);
  EXPECT_NEAR(gaps[0].to_s, 1.9, 1e-9);
  EXPECT_EQ(gaps[0].reason, "signal 11");
  const auto one = flight_.Store("one.db");
  ASSERT_TRUE(indexer.Index(Job(), CancelToken(), *one));
  const auto boxes = [](IndexStore& index, bool with_gap) {
    std::vector<std::string> lines;
    for (const SightingRecord& sighting : testing::SightingsOf(index, {.include_rejected = true})) {
      if (!with_gap && sighting.frame >= 10 && sighting.frame < 20) continue;
      lines.push_back(fmt::format("{} {} {} {}", sighting.frame, sighting.model, sighting.box.x, sighting.score));
    }
    std::ranges::sort(lines);
    return lines;
  };
  EXPECT_EQ(boxes(*store, true), boxes(*one, false));
  EXPECT_TRUE(store->FindSearch(1, 1).value()->finished);
}

// A file whose middle is damaged. By several threads, a decoder does not repair it in the same way each time.
TEST_F(IndexerSegmentsTest, DamagedVideoIsIndexedAsAWhole) {
  threads_ = 1;
  std::string bytes = ReadFile(flight_.video()).value();
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2),
            bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2) + 600, '\0');
  ASSERT_TRUE(WriteFileAtomically(flight_.video(), bytes));
  const auto store = flight_.Store("segments.db");
  const Indexer indexer = MakeIndexer(flight_.Models());
  if (Begin(indexer, *store).waits_for) {
    SearchAll(indexer, *store);
    EXPECT_TRUE(segments_.CutsOf(1).value().at(0).is_whole);
    EXPECT_FALSE(Begin(indexer, *store).waits_for);
  }
  EXPECT_THAT(segments_.CutsOf(1).value(), SizeIs(0));
  EXPECT_EQ(Contents(*store), OnePass(flight_.Models()));
}

}  // namespace
}  // namespace victorious
