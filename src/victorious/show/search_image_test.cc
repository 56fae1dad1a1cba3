#include "victorious/show/search_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_flight.h"
#include "testing/drawn_objects.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using testing::DrawnFlight;
using ::testing::Each;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::PhotoOf;
using testing::ShortFlight;
using ::testing::SizeIs;

// Two frames per second: the crate is absent for longer than the maximum gap of a segment.
testing::FlightOptions SlowFlight(std::uint64_t seed = 5) {
  testing::FlightOptions options = ShortFlight();
  options.seed = seed;
  options.fps = 2;
  return options;
}

std::unique_ptr<IndexStore> IndexedWith(const DrawnFlight& flight, double keep_interval_s) {
  IndexOptions options;
  options.keep.interval_s = keep_interval_s;
  std::unique_ptr<IndexStore> store = flight.Store("index.db");
  const auto report = Indexer::Create({flight.Model(0)}, options)
                          .value()
                          .Index({.video = flight.video(), .threads = 2}, CancelToken(), *store);
  EXPECT_TRUE(report) << report.error().message;
  return store;
}

std::vector<VideoSegment> Search(const Photo& example, IndexStore& store, const SightingFilter& filter = {}) {
  Expected<ImageSearch> found = SearchByImage(example, filter, {}, store);
  EXPECT_TRUE(found) << found.error().message;
  if (!found) return {};
  EXPECT_GT(found->searched_frames, 0);
  EXPECT_GT(found->searched_videos, 0);
  return std::move(found->segments);
}

std::optional<Box> TruthBox(const DrawnFlight& flight, int object, std::int64_t frame) {
  const std::vector<testing::TruthRow> rows = flight.flight().Truth(static_cast<int>(frame));
  const auto row = std::ranges::find(rows, object, &testing::TruthRow::object_index);
  return row == rows.end() ? std::nullopt : std::optional(row->box);
}

TEST(SearchByImage, FindsTheMomentsThatShowTheQueryObject) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  const std::vector<VideoSegment> moments = Search(PhotoOf(flight.flight(), 0), *store);
  ASSERT_THAT(moments, SizeIs(2)) << "at the start, and when the camera returns";
  for (const VideoSegment& moment : moments) {
    EXPECT_EQ(moment.video, flight.video());
    EXPECT_NEAR(moment.time_s, static_cast<double>(moment.frame) / 2, 1e-3);
    const std::optional<Box> truth = TruthBox(flight, 0, moment.frame);
    ASSERT_TRUE(truth);
    EXPECT_GT(IntersectionOverUnion(moment.box, *truth), 0.7);
    EXPECT_LE(moment.first_time_s, moment.time_s);
    EXPECT_GE(moment.last_time_s, moment.time_s);
    EXPECT_EQ(moment.frames, std::lround((moment.last_time_s - moment.first_time_s) * 2) + 1);
    EXPECT_TRUE(TruthBox(flight, 0, std::lround(moment.first_time_s * 2)));
    EXPECT_TRUE(TruthBox(flight, 0, std::lround(moment.last_time_s * 2)));
    EXPECT_GT(moment.score, 0.9);
  }
  EXPECT_GE(moments[0].matches, moments[1].matches) << "best first";
}

// The truck has no model: its example image is a crop of the video itself.
TEST(SearchByImage, AcceptsACropOfAFrame) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  const int frame = 4;
  const Box box = TruthBox(flight, 1, frame).value();
  const Photo example = PreparePhoto("frame.png", flight.flight().Render(frame).image, {}, box).value();
  const std::vector<VideoSegment> moments = Search(example, *store);
  ASSERT_FALSE(moments.empty());
  EXPECT_NEAR(moments[0].time_s, frame / 2.0, 0.6);
  EXPECT_GT(IntersectionOverUnion(moments[0].box, TruthBox(flight, 1, moments[0].frame).value()), 0.6);
}

TEST(SearchByImage, FindsNothingForAnAbsentObject) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  const testing::SyntheticFlight elsewhere(SlowFlight(99));
  EXPECT_THAT(Search(PhotoOf(elsewhere, 0), *store), IsEmpty());
  EXPECT_THAT(Search(PhotoOf(elsewhere, 1), *store), IsEmpty());
}

TEST(SearchByImage, SearchesOnlyTheGivenVideosAndTimes) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  const DrawnFlight other(SlowFlight(99));
  const auto report = Indexer::Create({other.Model(0)}, {})
                          .value()
                          .Index({.video = other.video(), .threads = 2}, CancelToken(), *store);
  ASSERT_TRUE(report) << report.error().message;

  const Photo crate = PhotoOf(flight.flight(), 0);
  EXPECT_THAT(Search(crate, *store), AllOf(Not(IsEmpty()), Each(Field(&VideoSegment::video, flight.video()))));
  EXPECT_THAT(Search(crate, *store, {.video_name = flight.video()}), SizeIs(2));
  EXPECT_THAT(Search(crate, *store, {.video_name = other.video()}), IsEmpty());

  const std::vector<VideoSegment> early = Search(crate, *store, {.from_s = 0.5, .to_s = 4});
  ASSERT_THAT(early, SizeIs(1));
  EXPECT_GE(early[0].first_time_s, 0.5);
  EXPECT_LE(early[0].last_time_s, 4);
}

// Consecutive kept frames with the object are one segment, whatever the interval between them.
TEST(SearchByImage, SparseKeptFramesAreJoinedToOneMoment) {
  testing::FlightOptions options = SlowFlight();
  options.fps = 0.25;
  const DrawnFlight flight(options);
  const auto store = IndexedWith(flight, 4);
  EXPECT_THAT(Search(PhotoOf(flight.flight(), 0), *store), SizeIs(2));
}

TEST(SearchByImage, UnselectedVideosNeedNotBeReadable) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  ASSERT_TRUE(store->PutVideo(
      {.content_id = "other", .name = "other.mp4", .width = 1, .height = 1, .features_json = R"({"newer": 1})"}));
  const Photo crate = PhotoOf(flight.flight(), 0);
  EXPECT_THAT(Search(crate, *store, {.video_name = flight.video()}), SizeIs(2));
  const auto all = SearchByImage(crate, {}, {}, *store);
  ASSERT_FALSE(all);
  EXPECT_THAT(all.error().message, AllOf(HasSubstr("other.mp4"), HasSubstr("newer"), Not(HasSubstr("\n"))));
}

// The state after another process has added a video in the meantime.
TEST(SearchByImage, FramesOfUnknownVideosAreSkipped) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  const VideoRecord other =
      store->PutVideo({.content_id = "other", .name = "other.mp4", .width = 1, .height = 1}).value();
  IndexBatch batch;
  batch.kept_frames.push_back(
      {.video = other.id, .frame = 0, .time_s = 0, .features = {.image_width = 1, .image_height = 1}});
  ASSERT_TRUE(store->Commit(batch));
  EXPECT_THAT(Search(PhotoOf(flight.flight(), 0), *store), SizeIs(2));
}

TEST(SearchByImage, LiveSourcesAreNamedWithoutTheirPasswords) {
  const DrawnFlight flight(SlowFlight());
  const auto store = IndexedWith(flight, 0);
  VideoRecord video = store->Videos()->front();
  video.name = "rtsp://ann:secret@host/one";
  ASSERT_TRUE(store->PutVideo(video));
  const std::vector<VideoSegment> moments = Search(PhotoOf(flight.flight(), 0), *store);
  EXPECT_THAT(moments, AllOf(Not(IsEmpty()), Each(Field(&VideoSegment::video, "rtsp://host/one"))));
}

TEST(SearchByImage, ErrorsNameTheReason) {
  const DrawnFlight flight(SlowFlight());
  const Photo crate = PhotoOf(flight.flight(), 0);
  const auto empty = SearchByImage(crate, {}, {}, *flight.Store("empty.db"));
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(empty.error().message, HasSubstr("index a video first"));

  const auto store = IndexedWith(flight, 0);
  const auto too_late = SearchByImage(crate, {.from_s = 1000}, {}, *store);
  ASSERT_FALSE(too_late);
  EXPECT_THAT(too_late.error().message, HasSubstr("--from"));

  const cv::Mat plain(100, 100, CV_8UC3, cv::Scalar::all(128));
  const auto nothing_on_it = SearchByImage(PreparePhoto("plain.png", plain, {}, {}).value(), {}, {}, *store);
  ASSERT_FALSE(nothing_on_it);
  EXPECT_EQ(nothing_on_it.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(nothing_on_it.error().message, HasSubstr("plain.png: 0 features"));

  RecognizeOptions options;
  options.match.ratio = 7;
  const auto out_of_range = SearchByImage(crate, {}, options, *store);
  ASSERT_FALSE(out_of_range);
  EXPECT_THAT(out_of_range.error().message, HasSubstr("match.ratio = 7"));
}

}  // namespace
}  // namespace victorious
