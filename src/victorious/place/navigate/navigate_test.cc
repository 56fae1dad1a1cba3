#include "victorious/place/navigate/navigate.h"

#include <algorithm>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "testing/chi_squared.h"
#include "testing/synthetic_landmarks.h"

namespace victorious {
namespace {

using testing::LandmarkFlight;
using testing::LandmarkFlightOptions;

struct Errors {
  std::vector<double> places_m;
  std::vector<double> turns_deg;
  int inside = 0;  // frames whose true place lies in the 90 % ellipsoid

  [[nodiscard]] double Place(double share) const { return At(places_m, share); }
  [[nodiscard]] double Turn(double share) const { return At(turns_deg, share); }
  [[nodiscard]] double Inside() const { return static_cast<double>(inside) / static_cast<double>(places_m.size()); }

  static double At(std::vector<double> values, double share) {
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  }

  void Add(const LandmarkFlight& flight, const Navigation& navigation, bool only_seen = false) {
    for (std::size_t k = 0; k < navigation.frames.size(); ++k) {
      if (only_seen && navigation.frames[k].landmarks == 0) continue;
      const Vector6 error = flight.ErrorOf(navigation.frames[k], k);
      const Eigen::Vector3d place = error.head<3>();
      places_m.push_back(place.norm());
      turns_deg.push_back(DegreesFromRadians(error.tail<3>().norm()));
      const Eigen::Matrix3d covariance = navigation.frames[k].covariance.topLeftCorner<3, 3>();
      inside += place.dot(covariance.llt().solve(place)) <= testing::kChiSquared90Of3 ? 1 : 0;
    }
  }
};

Navigation Estimate(const LandmarkFlight& flight, const NavigateOptions& options = {}) {
  Expected<Navigation> navigation = Navigate(flight.input(), options);
  EXPECT_TRUE(navigation.has_value());
  return navigation ? *std::move(navigation) : Navigation{};
}

TEST(Navigate, RemovesTelemetryOffset) {
  Errors errors;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const LandmarkFlight flight({.seed = seed});
    const Navigation navigation = Estimate(flight);
    ASSERT_EQ(navigation.frames.size(), flight.frames.size());
    errors.Add(flight, navigation);
    const std::size_t middle = flight.frames.size() / 2;
    ASSERT_TRUE(navigation.frames[middle].offset);
    EXPECT_LT((navigation.frames[middle].offset->place_enu_m - flight.offsets[middle].head<3>()).norm(), 4);
  }
  EXPECT_LT(errors.Place(0.5), 1.0);
  EXPECT_LT(errors.Place(0.95), 2.5);
  EXPECT_LT(errors.Turn(0.5), 0.5);
}

TEST(Navigate, FollowsTelemetryJumps) {
  Errors errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const LandmarkFlight flight({.seed = seed, .jump_m = 40});
    errors.Add(flight, Estimate(flight));
  }
  EXPECT_LT(errors.Place(0.5), 1.2);
  EXPECT_LT(errors.Place(0.95), 3);
}

TEST(Navigate, WorksWithoutTelemetry) {
  Errors errors;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const LandmarkFlight flight({.seed = seed, .telemetry = false});
    const Navigation navigation = Estimate(flight);
    ASSERT_EQ(navigation.frames.size(), flight.frames.size());
    EXPECT_FALSE(navigation.frames.front().offset);
    errors.Add(flight, navigation);
  }
  EXPECT_LT(errors.Place(0.5), 1.5);
  EXPECT_LT(errors.Place(0.95), 5);
}

TEST(Navigate, CovarianceContainsTheTruth) {
  Errors with;
  Errors without;
  Errors self_located;
  NavigateOptions options;
  options.landmark = {.centre_m = 0.001, .rotation_deg = 0.001, .correlation_s = 0};  // as simulated
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const LandmarkFlight noisy({.seed = seed, .noise_position_m = 1, .noise_attitude_deg = 0.3});
    with.Add(noisy, Estimate(noisy, options));
    const LandmarkFlight alone({.seed = seed, .telemetry = false});
    without.Add(alone, Estimate(alone, options));
    const LandmarkFlight located({.seed = seed, .common_m = 2, .landmark_m = 1});
    self_located.Add(located, Estimate(located, options));
  }
  for (const Errors* errors : {&with, &without, &self_located}) {
    EXPECT_GT(errors->Inside(), 0.8);
    EXPECT_LT(errors->Inside(), 0.985);
  }
  RecordProperty("inside_with_telemetry", std::to_string(with.Inside()));
  RecordProperty("inside_without", std::to_string(without.Inside()));
  RecordProperty("inside_self_located", std::to_string(self_located.Inside()));
}

TEST(Navigate, IsRobustToAWrongLandmark) {
  for (const bool telemetry : {true, false}) {
    Errors right;
    Errors wrong;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      LandmarkFlight flight({.seed = seed, .landmarks = 8, .telemetry = telemetry});
      right.Add(flight, Estimate(flight));
      Landmark& moved = flight.landmarks[3];
      const TangentPlane plane(moved.place);
      moved.place = plane.GeodeticFromEnu({30, -40, 0});
      const Navigation navigation = Estimate(flight);
      for (std::size_t i = 0; i < flight.sightings.size(); ++i) {
        if (flight.sightings[i].model == 3) {
          EXPECT_FALSE(navigation.landmark_by_sighting[i]) << seed;
        }
      }
      wrong.Add(flight, navigation, true);
    }
    EXPECT_LT(wrong.Place(0.5), 1.3 * right.Place(0.5)) << telemetry;
    EXPECT_LT(wrong.Place(0.95), 1.5 * right.Place(0.95)) << telemetry;
  }
}

// Landmarks that are hardly ever in view together: sightings before and after contradict the wrong one.
TEST(Navigate, WrongLandmarkIsRejectedWithoutTelemetry) {
  for (const std::size_t wrong : {0U, 1U, 3U}) {
    int believed = 0;
    int doubted = 0;
    Errors errors;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      LandmarkFlight flight({.seed = seed, .frames = 165, .landmarks = 4, .telemetry = false});
      Landmark& moved = flight.landmarks[wrong];
      moved.place = TangentPlane(moved.place).GeodeticFromEnu({-30, 40, 0});
      const Navigation navigation = Estimate(flight);
      for (std::size_t i = 0; i < flight.sightings.size(); ++i) {
        const bool is_wrong = flight.sightings[i].model == wrong;
        believed += is_wrong && navigation.landmark_by_sighting[i] ? 1 : 0;
        doubted += !is_wrong && !navigation.landmark_by_sighting[i] ? 1 : 0;
      }
      errors.Add(flight, navigation, true);
    }
    EXPECT_EQ(believed, 0) << wrong;
    EXPECT_LE(doubted, 5) << wrong;
    EXPECT_LT(errors.Place(0.95), 5) << wrong;
  }
}

TEST(Navigate, RejectsFalseSightings) {
  Errors errors;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const LandmarkFlight flight({.seed = seed, .outlier_fraction = 0.3});
    const Navigation navigation = Estimate(flight);
    int believed_wrong = 0;
    int lost_right = 0;
    for (std::size_t i = 0; i < flight.sightings.size(); ++i) {
      believed_wrong += flight.is_wrong[i] && navigation.landmark_by_sighting[i] ? 1 : 0;
      lost_right += !flight.is_wrong[i] && !navigation.landmark_by_sighting[i] ? 1 : 0;
    }
    EXPECT_LE(believed_wrong, 2) << seed;
    EXPECT_LE(lost_right, 4) << seed;
    errors.Add(flight, navigation);
  }
  EXPECT_LT(errors.Place(0.5), 1.0);
  EXPECT_LT(errors.Place(0.95), 3);
}

TEST(Navigate, AssignsSightingsToLandmarksOfOneModel) {
  for (const bool telemetry : {true, false}) {
    LandmarkFlight flight({.seed = 4, .landmarks = 5, .telemetry = telemetry});
    std::vector<std::size_t> truth;
    for (LandmarkSighting& sighting : flight.sightings) {
      truth.push_back(sighting.model);
      sighting.model = 0;
    }
    flight.landmarks_by_model = {{0, 1, 2, 3, 4}};
    const Navigation navigation = Estimate(flight);
    int right = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) right += navigation.landmark_by_sighting[i] == truth[i] ? 1 : 0;
    EXPECT_GT(right, 0.95 * static_cast<double>(truth.size())) << telemetry;
  }
}

// Only a subset of the hypotheses is tried as the reference: each landmark must occur in it.
TEST(Navigate, AssignsSightingsToSecondLandmarkOfOneModel) {
  LandmarkFlight flight({.seed = 4, .frames = 480, .frame_rate = 60, .landmarks = 2});
  std::erase_if(flight.sightings, [](const LandmarkSighting& sighting) { return sighting.model == 0; });
  ASSERT_GE(flight.sightings.size(), 60U);
  for (LandmarkSighting& sighting : flight.sightings) sighting.model = 0;
  flight.landmarks_by_model = {{0, 1}};
  const Navigation navigation = Estimate(flight);
  const auto right = std::ranges::count(navigation.landmark_by_sighting, std::optional<std::size_t>(1));
  EXPECT_GT(right, 0.9 * static_cast<double>(flight.sightings.size()));
}

// A town of identical landmarks: those far from the camera do not change the result. (candidates_test.cc shows that
// they are no candidates with telemetry.)
TEST(Navigate, ThousandsOfDistantLandmarksDoNotChangeTheResult) {
  for (const bool telemetry : {true, false}) {
    // Without telemetry every landmark is a hypothesis in every frame: a shorter flight over a smaller town.
    const int side = telemetry ? 71 : 32;
    LandmarkFlight flight({.seed = 4, .frames = telemetry ? 120 : 40, .landmarks = 5, .telemetry = telemetry});
    flight.landmarks_by_model.assign(1, {0, 1, 2, 3, 4});
    std::vector<std::size_t> truth;
    for (LandmarkSighting& sighting : flight.sightings) truth.push_back(std::exchange(sighting.model, 0));
    const auto right = [&](const Navigation& navigation) {
      int count = 0;
      for (std::size_t i = 0; i < truth.size(); ++i) count += navigation.landmark_by_sighting[i] == truth[i] ? 1 : 0;
      return static_cast<double>(count) / static_cast<double>(truth.size());
    };
    const Navigation few = Estimate(flight);
    const TangentPlane plane(flight.landmarks.front().place);
    for (int i = 0; i < side * side; ++i) {
      const Eigen::Vector3d place(300.0 * (i / side + 2), 300.0 * (i % side - side / 2), 0);
      flight.landmarks_by_model.front().push_back(flight.landmarks.size());
      flight.landmarks.push_back({.model = "any", .place = plane.GeodeticFromEnu(place), .heading_rad = 0.3 * i});
    }
    const Navigation many = Estimate(flight);
    EXPECT_GT(right(many), 0.95) << telemetry;
    if (!telemetry) continue;
    for (std::size_t k = 0; k < few.frames.size(); ++k) {
      EXPECT_LT(flight.ErrorOf(many.frames[k], k).head<3>().norm(),
                flight.ErrorOf(few.frames[k], k).head<3>().norm() + 1);
    }
  }
}

TEST(Navigate, WorksFromDirectionsOnly) {
  Errors errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    LandmarkFlight flight({.seed = seed, .landmarks = 8});
    for (LandmarkSighting& sighting : flight.sightings) {
      sighting.information.topLeftCorner<3, 3>().setZero();
      const Eigen::Vector3d along = sighting.camera_from_landmark.translation.normalized();
      sighting.information.bottomRightCorner<3, 3>() =
          (Eigen::Matrix3d::Identity() - along * along.transpose()) / (0.03 * 0.03);
    }
    for (Landmark& landmark : flight.landmarks) landmark.heading_rad.reset();
    errors.Add(flight, Estimate(flight));
  }
  EXPECT_LT(errors.Place(0.5), 8);  // telemetry alone: about 15 m
  EXPECT_GT(errors.Inside(), 0.7);
}

TEST(Navigate, WithoutSightingsEqualsTelemetry) {
  LandmarkFlight flight({.seed = 2});
  flight.sightings.clear();
  const Navigation navigation = Estimate(flight);
  ASSERT_EQ(navigation.frames.size(), flight.frames.size());
  const NavigatedFrame& frame = navigation.frames[60];
  EXPECT_EQ(frame.landmarks, 0);
  EXPECT_NEAR(frame.camera.place.altitude_m, flight.frames[60].measured->place.altitude_m, 0.5);
  EXPECT_NEAR(*frame.camera.sigma_position_m, 10, 4);
}

TEST(Navigate, WithoutTelemetryAndSightingsGivesNoPoses) {
  LandmarkFlight flight({.seed = 2, .telemetry = false});
  flight.sightings.clear();
  EXPECT_TRUE(Estimate(flight).frames.empty());
  EXPECT_EQ(Estimate(flight).status, NavigationStatus::kNothingObserved);
  EXPECT_TRUE(Navigate({}, {})->frames.empty());
}

TEST(Navigate, RefusesOptionsOutOfRange) {
  NavigateOptions options;
  options.gate_sigma = -1;
  EXPECT_EQ(Navigate({}, options).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace victorious
