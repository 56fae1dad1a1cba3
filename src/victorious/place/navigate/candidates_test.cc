#include "victorious/place/navigate/candidates.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::size_t kSide = 71;

// Landmarks of one model, every 50 m over some kilometres; a camera 100 m above looks straight down at one.
class CandidatesTest : public ::testing::Test {
 protected:
  CandidatesTest() {
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
      const Vector3d place(50.0 * static_cast<double>(i / kSide), 50.0 * static_cast<double>(i % kSide), 0);
      landmarks_.push_back({{Quaterniond::Identity(), place}, 0.01 * Matrix6::Identity()});
    }
    of_models_.resize(1);
    of_models_.front().resize(landmarks_.size());
    std::iota(of_models_.front().begin(), of_models_.front().end(), 0);
    flight_.frames.resize(2);
    flight_.frames[1].time_s = 0.1;
    flight_.sigmas = {.offset_position_m = 10, .offset_attitude_rad = 0.05, .speed_m_s = 40, .angular_rate_rad_s = 0.3};
    sighting_.camera_from_landmark.translation = {0, 0, 100};
    sighting_.information = Matrix6::Identity();
  }

  // Telemetry in one frame, sighting in the other: the camera is above landmark `below`, with a telemetry error of
  // `off`.
  std::vector<std::size_t> LandmarksFor(std::size_t below, const Vector3d& off) {
    const Vector3d place = landmarks_[below].enu_from_landmark.translation + Vector3d(0, 0, 100) + off;
    flight_.frames[0].measured = TelemetryPose{place, {0, -kPi / 2, 0}, Quaterniond::Identity()};
    flight_.has_telemetry = true;
    return OfSighting();
  }

  std::vector<std::size_t> OfSighting() {
    sighting_.frame = 1;
    const Candidates candidates(flight_, landmarks_, of_models_, std::span(&sighting_, 1), {});
    const auto of = candidates.LandmarksFor(0);
    return {of.begin(), of.end()};
  }

  FlightInput flight_;
  std::vector<FlightLandmark> landmarks_;
  std::vector<std::vector<std::size_t>> of_models_;
  LandmarkSighting sighting_;
};

TEST_F(CandidatesTest, AreNearThePlaceByTelemetry) {
  const std::size_t below = 30 * kSide + 40;
  const std::vector<std::size_t> near = LandmarksFor(below, {15, -20, 5});
  EXPECT_TRUE(std::ranges::binary_search(near, below));
  EXPECT_LT(near.size(), 60);
  for (const std::size_t landmark : near) {
    const Vector3d apart =
        landmarks_[landmark].enu_from_landmark.translation - landmarks_[below].enu_from_landmark.translation;
    EXPECT_LT(apart.norm(), 250) << landmark;
  }
}

TEST_F(CandidatesTest, AreTheNearestIfNoneIsInRange) { EXPECT_EQ(LandmarksFor(0, {-5000, 0, 0}).size(), 16); }

TEST_F(CandidatesTest, AreAllOfAFew) {
  of_models_.front() = {3, 7, 4000};
  EXPECT_EQ(LandmarksFor(3, {-5000, 0, 0}), of_models_.front());
}

TEST_F(CandidatesTest, AreAllWithoutTelemetry) { EXPECT_EQ(OfSighting(), of_models_.front()); }

}  // namespace
}  // namespace victorious
