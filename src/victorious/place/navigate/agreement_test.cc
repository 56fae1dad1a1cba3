#include "victorious/place/navigate/agreement.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/rotation_vector.h"
#include "victorious/place/navigate/covariance.h"

namespace victorious {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::Optional;

constexpr std::size_t kFrames = 12;
constexpr double kFrame_s = 0.1;

// Three landmarks of one model on the ground; a camera 100 m above flies east over them and looks straight down.
class AgreementTest : public ::testing::Test {
 protected:
  AgreementTest() {
    for (const Vector3d& place : {Vector3d(0, 0, 0), Vector3d(25, 10, 0), Vector3d(60, -15, 0)}) {
      landmarks_.push_back({{Quaterniond::Identity(), place}, 1e-4 * Matrix6::Identity()});
    }
    landmarks_by_model_ = {{0, 1, 2}};
    flight_.sigmas = {.offset_position_m = 10,
                      .offset_attitude_rad = 0.05,
                      .drift_position_m = 0.5,
                      .drift_attitude_rad = 0.003,
                      .speed_m_s = 40,
                      .speed_change_m_s = 5,
                      .angular_rate_rad_s = 0.3,
                      .angular_rate_change_rad_s = 0.3};
    flight_.frames.resize(kFrames);
    for (std::size_t k = 0; k < kFrames; ++k) flight_.frames[k].time_s = kFrame_s * static_cast<double>(k);
  }

  static Vector3d PlaceAt(std::size_t frame) { return {5.0 * static_cast<double>(frame), 0, 100}; }
  static Quaterniond CameraFromEnuThere() { return CameraFromEnu({0, -kPi / 2, 0}); }

  // Telemetry of the true attitude, off by `off_m` east.
  void AddTelemetry(double off_m) {
    flight_.has_telemetry = true;
    for (std::size_t k = 0; k < kFrames; ++k) {
      flight_.frames[k].measured =
          TelemetryPose{PlaceAt(k) + Vector3d(off_m, 0, 0), {0, -kPi / 2, 0}, Quaterniond::Identity()};
    }
  }

  // The exact sighting of a landmark, moved by `error` m in the camera's axes.
  LandmarkSighting Sighting(std::size_t frame, std::size_t landmark, const Vector3d& error = Vector3d::Zero()) const {
    LandmarkSighting sighting{.frame = frame};
    const Rigid3& known = landmarks_[landmark].enu_from_landmark;
    sighting.camera_from_landmark = {CameraFromEnuThere() * known.rotation,
                                     CameraFromEnuThere() * (known.translation - PlaceAt(frame)) + error};
    sighting.information = 1e4 * Matrix6::Identity();  // 0.01 rad, 0.01 m
    sighting.information.bottomRightCorner<3, 3>() /= 100;
    return sighting;
  }

  std::vector<std::optional<std::size_t>> Associate(const std::vector<bool>& wrong = {false, false, false}) const {
    const Candidates candidates(flight_, landmarks_, landmarks_by_model_, sightings_, {});
    return FindConsensusAssociation(flight_, landmarks_, sightings_, candidates, wrong);
  }

  FlightInput flight_;
  std::vector<FlightLandmark> landmarks_;
  std::vector<std::vector<std::size_t>> landmarks_by_model_;
  std::vector<LandmarkSighting> sightings_;
};

TEST_F(AgreementTest, ASightingOfAKnownLandmarkGivesTheCameraPose) {
  const PoseHypothesis hypothesis = PoseFromSighting(Sighting(3, 1), landmarks_[1]);
  EXPECT_LT((hypothesis.place - PlaceAt(3)).norm(), 1e-9);
  EXPECT_LT(hypothesis.camera_from_enu.angularDistance(CameraFromEnuThere()), 1e-9);
}

// The covariance is that of many draws of the errors of the sighting and of the landmark.
TEST_F(AgreementTest, TheCovarianceOfThePoseIsThatOfItsDraws) {
  const LandmarkSighting exact = Sighting(3, 1);
  const PoseHypothesis expected = PoseFromSighting(exact, landmarks_[1]);
  Random random(1);
  const auto draw = [&](double rotation_rad, double translation_m) {
    Vector6 error;
    for (int i = 0; i < 6; ++i) error[i] = (i < 3 ? rotation_rad : translation_m) * random.Normal();
    return error;
  };
  Matrix6 sampled = Matrix6::Zero();
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    LandmarkSighting seen = exact;
    const Vector6 seen_error = draw(0.01, 0.1);
    seen.camera_from_landmark.rotation = RotationFromVector(seen_error.head<3>()) * seen.camera_from_landmark.rotation;
    seen.camera_from_landmark.translation += seen_error.tail<3>();
    FlightLandmark known = landmarks_[1];
    const Vector6 known_error = draw(0.01, 0.01);
    known.enu_from_landmark.rotation = RotationFromVector(known_error.head<3>()) * known.enu_from_landmark.rotation;
    known.enu_from_landmark.translation += known_error.tail<3>();
    const PoseHypothesis drawn = PoseFromSighting(seen, known);
    Vector6 off;
    off << VectorFromRotation(drawn.camera_from_enu.conjugate() * expected.camera_from_enu),
        drawn.place - expected.place;
    sampled += off * off.transpose() / kDraws;
  }
  EXPECT_LT((sampled - expected.covariance).norm(), 0.1 * expected.covariance.norm());
}

// Landmarks of one model look alike: only together do they say which is which.
TEST_F(AgreementTest, ConsensusSaysWhichLandmarkEachSightingIsOf) {
  AddTelemetry(8);
  sightings_ = {Sighting(0, 0), Sighting(1, 1), Sighting(2, 0), Sighting(5, 1), Sighting(8, 2), Sighting(9, 1)};
  EXPECT_THAT(Associate(),
              ElementsAre(Optional(0U), Optional(1U), Optional(0U), Optional(1U), Optional(2U), Optional(1U)));
}

TEST_F(AgreementTest, WithoutTelemetrySightingsOfDifferentLandmarksStillAgree) {
  sightings_ = {Sighting(0, 0), Sighting(0, 1), Sighting(0, 2), Sighting(1, 0), Sighting(1, 1), Sighting(1, 2)};
  EXPECT_THAT(Associate(),
              ElementsAre(Optional(0U), Optional(1U), Optional(2U), Optional(0U), Optional(1U), Optional(2U)));
}

TEST_F(AgreementTest, ASightingThatNoLandmarkExplainsIsAnOutlier) {
  AddTelemetry(0);
  sightings_ = {Sighting(0, 0), Sighting(1, 1), Sighting(3, 1, {0, 12, 0}), Sighting(5, 2)};
  EXPECT_THAT(Associate(), ElementsAre(Optional(0U), Optional(1U), Eq(std::nullopt), Optional(2U)));
}

TEST_F(AgreementTest, AnExcludedLandmarkIsAssociatedWithNothing) {
  AddTelemetry(0);
  sightings_ = {Sighting(0, 0), Sighting(1, 1), Sighting(3, 1), Sighting(5, 2)};
  EXPECT_THAT(Associate({false, true, false}),
              ElementsAre(Optional(0U), Eq(std::nullopt), Eq(std::nullopt), Optional(2U)));
}

TEST_F(AgreementTest, InitialStatesFollowTelemetryAtTheOffsetOfTheNearestSighting) {
  AddTelemetry(8);
  sightings_ = {Sighting(2, 0)};
  const std::vector<std::optional<std::size_t>> association = {0};
  const std::vector<FlightState> states = EstimateInitialStates(flight_, landmarks_, sightings_, association);
  ASSERT_EQ(states.size(), kFrames);
  for (std::size_t k = 0; k < kFrames; ++k) {
    EXPECT_LT((states[k].place - PlaceAt(k)).norm(), 1e-6) << k;
    EXPECT_LT((states[k].place_offset - Vector3d(8, 0, 0)).norm(), 1e-6) << k;
    EXPECT_LT(states[k].camera_from_enu.angularDistance(CameraFromEnuThere()), 1e-6) << k;
  }
}

TEST_F(AgreementTest, WithoutTelemetryInitialStatesAreInterpolatedBetweenTheSightings) {
  sightings_ = {Sighting(2, 0), Sighting(6, 1)};
  const std::vector<std::optional<std::size_t>> association = {0, 1};
  const std::vector<FlightState> states = EstimateInitialStates(flight_, landmarks_, sightings_, association);
  EXPECT_LT((states[0].place - PlaceAt(2)).norm(), 1e-6) << "constant before the first";
  for (const std::size_t k : {2, 3, 4, 5, 6}) EXPECT_LT((states[k].place - PlaceAt(k)).norm(), 1e-6) << k;
  EXPECT_LT((states[kFrames - 1].place - PlaceAt(6)).norm(), 1e-6) << "and after the last";
}

TEST_F(AgreementTest, OutliersGiveNoInitialState) {
  AddTelemetry(8);
  sightings_ = {Sighting(2, 0)};
  const std::vector<std::optional<std::size_t>> association = {std::nullopt};
  const std::vector<FlightState> states = EstimateInitialStates(flight_, landmarks_, sightings_, association);
  EXPECT_LT((states[2].place - flight_.frames[2].measured->place).norm(), 1e-9) << "telemetry as measured";
}

}  // namespace
}  // namespace victorious
