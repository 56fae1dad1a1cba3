#include "victorious/jobs/index/between_frames.h"

#include <cmath>

#include <gtest/gtest.h>

namespace victorious {
namespace {

SightingRecord SightingAt(double time_s, double x_px, std::int64_t track) {
  SightingRecord sighting{.model = 3,
                          .frame = static_cast<std::int64_t>(std::lround(30 * time_s)),
                          .time_s = time_s,
                          .box = {x_px, 20, 40, 10},
                          .outline = {{x_px, 20}, {x_px + 40, 20}, {x_px + 20, 30}},
                          .score = 0.9,
                          .matches = 12,
                          .distance_m = 50,
                          .sigma_distance_m = 1,
                          .track = track};
  sighting.observation.emplace();
  return sighting;
}

TEST(SightingsBetween, LieBetweenThoseOfTheSameTrack) {
  std::vector<SightingRecord> before = {SightingAt(1.0, 100, 7), SightingAt(1.0, 300, 8)};
  std::vector<SightingRecord> after = {SightingAt(1.1, 160, 7), SightingAt(1.1, 300, 9)};
  before[0].is_missed = true;
  after[0].score = 0.6;
  after[0].matches = 5;
  after[0].box.width = 70;
  const std::vector<SightingRecord> between = SightingsBetween(before, after, 31, 1.0 + 1.0 / 30);
  ASSERT_EQ(between.size(), 1U) << "tracks 8 and 9 are seen in one frame each";
  EXPECT_EQ(between[0].frame, 31);
  EXPECT_NEAR(between[0].box.x, 120, 1e-9);
  EXPECT_NEAR(between[0].box.width, 50, 1e-9);
  EXPECT_NEAR(between[0].outline[2].x(), 145, 1e-9) << "in the middle of the box, as before";
  EXPECT_EQ(between[0].score, 0.6);
  EXPECT_EQ(between[0].matches, 5);
  EXPECT_EQ(between[0].source, SightingSource::kTracked);
  EXPECT_FALSE(between[0].is_missed) << "it was not searched for";
  EXPECT_FALSE(between[0].observation) << "what is interpolated is no measurement";
  EXPECT_FALSE(between[0].distance_m);
}

TEST(SightingsBetween, NeedATrack) {
  std::vector<SightingRecord> before = {SightingAt(1.0, 100, 7)};
  std::vector<SightingRecord> after = {SightingAt(1.1, 160, 7)};
  before[0].track.reset();
  after[0].track.reset();
  EXPECT_TRUE(SightingsBetween(before, after, 31, 1.05).empty());
}

TEST(PartOfMotion, IsNoneOrAllOfIt) {
  const Similarity2 motion{.scale = 1.1, .rotation_rad = 0.2, .translation = {30, -4}};
  EXPECT_TRUE(PartOfMotion(motion, 0).Matrix().isApprox(Similarity2{}.Matrix()));
  EXPECT_TRUE(PartOfMotion(motion, 1).Matrix().isApprox(motion.Matrix()));
  EXPECT_NEAR(PartOfMotion(motion, 0.5).rotation_rad, 0.1, 1e-12);
}

}  // namespace
}  // namespace victorious
