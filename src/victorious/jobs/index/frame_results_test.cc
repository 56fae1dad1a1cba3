#include "victorious/jobs/index/frame_results.h"

#include <limits>

#include <gtest/gtest.h>

namespace victorious {
namespace {

// All values differ, and have bits that a text would lose.
std::vector<FrameResult> SomeResults() {
  FrameResult motion_only{.frame = 119, .is_whole = false, .now_from_before = {}, .sightings = {}};
  FrameResult full{.frame = 120, .is_whole = true, .now_from_before = Similarity2{1.1, -0.3, {0.1, 1.0 / 3}}};
  SightingRecord sighting{.video = 2,
                          .model = 3,
                          .frame = 120,
                          .time_s = 12.1,
                          .box = {0.1, 0.2, 30.3, std::numeric_limits<double>::denorm_min()},
                          .outline = {{1.1, 2.2}, {3.3, -4.4}},
                          .score = 0.7,
                          .source = SightingSource::kTracked,
                          .is_missed = true,
                          .matches = 11,
                          .view_index = 5,
                          .view = ViewDirection{0.4, 0.5},
                          .in_plane_rad = -0.6,
                          .sigma_view_rad = 0.01,
                          .distance_m = 123.4,
                          .sigma_distance_m = 5.6,
                          .track = 2'000'001};
  BearingObservation& observation = sighting.observation.emplace();
  observation.line = {.time_s = 12.1,
                      .camera = {0.8, 0.2, 321.5},
                      .azimuth_rad = 1.2,
                      .elevation_rad = -0.9,
                      .range_m = 123.5,
                      .sigma_rad = 0.003,
                      .sigma_range_m = 7.5,
                      .clock_shift = ClockShift{{1, 2, 3}, 0.1, 0.2},
                      .focal_shift = FocalShift{0.05, 0.1, 0.2}};
  observation.heading_rad = 2.5;
  observation.sigma_position_m = 1.5;
  observation.sigma_attitude_rad = 0.004;
  observation.recognition_id = 9;
  full.sightings.push_back(sighting);
  full.sightings.push_back({.video = 2, .model = 4, .frame = 120, .time_s = 12.1});
  return {motion_only, full};
}

TEST(FrameResults, ComeBackAsTheyWere) {
  const std::vector<FrameResult> written = SomeResults();
  const std::vector<std::byte> bytes = PackFrameResults(written);
  const auto read = UnpackFrameResults(bytes);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ(read->front().frame, 119);
  EXPECT_FALSE(read->front().now_from_before);
  const FrameResult& full = read->back();
  EXPECT_TRUE(full.is_whole);
  EXPECT_EQ(full.now_from_before->translation, written[1].now_from_before->translation);
  const SightingRecord& before = written[1].sightings[0];
  const SightingRecord& now = full.sightings[0];
  EXPECT_EQ(now.frame, 120);
  EXPECT_EQ(now.model, 3);
  EXPECT_EQ(now.box.height, before.box.height);
  EXPECT_EQ(now.outline, before.outline);
  EXPECT_EQ(now.source, SightingSource::kTracked);
  EXPECT_TRUE(now.is_missed);
  EXPECT_EQ(now.view->off_nadir_rad, 0.5);
  EXPECT_EQ(now.track, 2'000'001);
  EXPECT_EQ(now.observation->line.camera, before.observation->line.camera);
  EXPECT_EQ(now.observation->line.clock_shift->camera_enu_m, before.observation->line.clock_shift->camera_enu_m);
  EXPECT_EQ(now.observation->line.focal_shift->elevation_rad, before.observation->line.focal_shift->elevation_rad);
  EXPECT_EQ(now.observation->heading_rad, 2.5);
  EXPECT_FALSE(full.sightings[1].observation);
  // Every byte: what was read is written as before.
  EXPECT_EQ(PackFrameResults(*read), bytes);
}

TEST(FrameResults, SmallestSightingLastComesBack) {
  const std::vector<FrameResult> written = {{.frame = 5, .is_whole = true, .sightings = {SightingRecord{.frame = 5}}}};
  const std::vector<std::byte> bytes = PackFrameResults(written);
  const auto read = UnpackFrameResults(bytes);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->at(0).sightings.size(), 1U);
  EXPECT_EQ(PackFrameResults(*read), bytes);
}

TEST(FrameResults, DamagedBytesAreAnError) {
  const std::vector<std::byte> bytes = PackFrameResults(SomeResults());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto read = UnpackFrameResults(std::span(bytes).first(size));
    ASSERT_FALSE(read) << size;
    EXPECT_EQ(read.error().code, ErrorCode::kDataLoss);
  }
}

}  // namespace
}  // namespace victorious
