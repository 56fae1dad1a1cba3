#include "victorious/place/associate/box_place.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "testing/chi_squared.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/observe/box_bearing.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const GeodeticPoint kBoxOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};
const cv::Size kImage(640, 480);

struct BoxFlight {
  std::uint64_t seed = 1;
  Vector3d velocity_enu{0, 0, 0};  // of the object, which is at the origin at time 0
  double length_m = 4.4;
  int frames = 60;      // 10 per second
  double from_m = -60;  // initial east coordinate of the camera
  double speed_m_s = 20;
  bool circles = false;
};

CameraState CameraAt(const BoxFlight& flight, double time_s) {
  Vector3d camera(flight.from_m + flight.speed_m_s * time_s, -70, 100);
  if (flight.circles) camera = Vector3d(90 * std::cos(0.4 * time_s), 90 * std::sin(0.4 * time_s), 100);
  const Vector3d to = time_s * flight.velocity_enu - camera;
  return {.time_s = time_s,
          .place = TangentPlane(kBoxOrigin).GeodeticFromEnu(camera),
          .attitude = Attitude{std::atan2(to.x(), to.y()) + 0.01, std::asin(to.z() / to.norm()) + 0.005, 0.02},
          .hfov_rad = RadiansFromDegrees(20),
          .sigma_position_m = 0.05,
          .sigma_attitude_rad = 1e-4};
}

// The box around the object, with the same offset from its centre in all frames.
std::vector<BearingObservation> Fly(const BoxFlight& flight, const ObjectType* type, double centre_fraction) {
  Random random(flight.seed);
  const double off_x = centre_fraction * random.Normal();
  const double off_y = centre_fraction * random.Normal();
  const double seen_fraction = 0.85 * (1 + 0.2 * random.Normal());
  std::vector<BearingObservation> observations;
  for (int i = 0; i < flight.frames; ++i) {
    const double time_s = 0.1 * i;
    const CameraState camera = CameraAt(flight, time_s);
    const GeodeticPoint object = TangentPlane(kBoxOrigin).GeodeticFromEnu(time_s * flight.velocity_enu);
    const auto middle = PredictBox(object, {0, 0, 10, 6}, camera, camera, kImage);
    const double range_m = TangentPlane(camera.place).EnuFromGeodetic(object).norm();
    const double side_px = 320 / std::tan(RadiansFromDegrees(10)) * seen_fraction * flight.length_m / range_m;
    const double x = middle->box.x + 5 + off_x * side_px;
    const double y = middle->box.y + 3 + off_y * side_px;
    const auto observation =
        MakeBoxBearingObservation({x - side_px / 2, y - side_px / 3, side_px, side_px / 1.5}, kImage, camera, type, 1);
    EXPECT_TRUE(observation);
    observations.push_back(*observation);
  }
  return observations;
}

BoxPlaceOptions Exact() {
  BoxPlaceOptions options;
  options.locate.common.range_fraction = 0;
  return options;
}

TEST(EstimateBoxPlaces, StaticObjectLiesInsideErrorEllipsoid) {
  constexpr int kFlights = 60;
  int inside = 0;
  for (int seed = 0; seed < kFlights; ++seed) {
    const BoxFlight flight{.seed = static_cast<std::uint64_t>(seed) + 7};
    const auto places = EstimateBoxPlaces(Fly(flight, nullptr, kBoxCentreFraction), BoxMotion::kUnknown, {}, Exact());
    ASSERT_TRUE(places.front() && places.back());
    const Vector3d error = TangentPlane(kBoxOrigin).EnuFromGeodetic(places.back()->point);
    inside += error.dot(places.back()->covariance_enu_m2.inverse() * error) < testing::kChiSquared90Of3 ? 1 : 0;
    EXPECT_LT(places.back()->ce90_m, 5);
    EXPECT_EQ(places.front()->point, places.back()->point);
  }
  EXPECT_GE(inside, 0.85 * kFlights);
}

TEST(EstimateBoxPlaces, ObjectTypeLengthGivesRange) {
  const BoxFlight hovers{.frames = 10, .speed_m_s = 0};
  EXPECT_FALSE(EstimateBoxPlaces(Fly(hovers, nullptr, 0), BoxMotion::kStatic, {}, {}).back())
      << "one line of sight, and no range";
  const auto place = EstimateBoxPlaces(Fly(hovers, FindObjectType("car"), 0), BoxMotion::kStatic, {}, {}).back();
  ASSERT_TRUE(place);
  const double error_m = TangentPlane(kBoxOrigin).EnuFromGeodetic(place->point).norm();
  EXPECT_LT(error_m, 60);
  EXPECT_GT(place->ce90_m, 20) << "only the length of cars is known";
}

TEST(EstimateBoxPlaces, MovingObjectIsLocatedAtEachTime) {
  const BoxFlight flight{.velocity_enu = {-6, 4, 0}, .frames = 150, .circles = true};
  const auto places = EstimateBoxPlaces(Fly(flight, FindObjectType("car"), 0), BoxMotion::kUnknown, {}, {});
  int located = 0;
  for (int i = 0; i < flight.frames; ++i) {
    if (!places[static_cast<std::size_t>(i)]) continue;
    ++located;
    const Geolocation& place = *places[static_cast<std::size_t>(i)];
    const Vector3d off = TangentPlane(kBoxOrigin).EnuFromGeodetic(place.point) - 0.1 * i * flight.velocity_enu;
    EXPECT_LT(off.head<2>().norm(), place.ce90_m) << i;
    EXPECT_LT((*place.velocity_enu - flight.velocity_enu).norm(), 4) << i;
  }
  EXPECT_GE(located, flight.frames / 2);
}

// A camera that flies straight cannot distinguish an object that drives straight from a static object elsewhere.
TEST(EstimateBoxPlaces, MovingObjectIsPlacedOnTheGround) {
  const BoxFlight flight{.velocity_enu = {-4, -4, 0}, .frames = 30};
  const auto observations = Fly(flight, nullptr, 0.05);
  const ObjectGround ground = ObjectGround::AtPlace({.point = TangentPlane(kBoxOrigin).GeodeticFromEnu({8, 3, -1.2}),
                                                     .covariance_enu_m2 = Eigen::Matrix3d::Identity()});
  const auto places = EstimateBoxPlaces(observations, BoxMotion::kMoving, ground, {});
  int inside = 0;
  for (int i = 0; i < flight.frames; ++i) {
    const auto& place = places[static_cast<std::size_t>(i)];
    ASSERT_TRUE(place);
    const Vector3d off = TangentPlane(kBoxOrigin).EnuFromGeodetic(place->point) - 0.1 * i * flight.velocity_enu;
    inside += off.head<2>().norm() < place->ce90_m ? 1 : 0;
    EXPECT_LT(off.norm(), 4) << i;
    EXPECT_LT((*place->velocity_enu - flight.velocity_enu).norm(), 1) << i;
  }
  EXPECT_GE(inside, 0.9 * flight.frames);
  // Without the ground, the length of its type gives the range, and nothing else does.
  for (const auto& place : EstimateBoxPlaces(Fly(flight, FindObjectType("car"), 0), BoxMotion::kMoving, {}, {})) {
    ASSERT_TRUE(place);
    EXPECT_GT(place->ce90_m, 10);
  }
  for (const auto& place : EstimateBoxPlaces(observations, BoxMotion::kMoving, {}, {})) {
    EXPECT_FALSE(place) << "the range is unknown";
  }
}

TEST(EstimateBoxPlaces, GroundIsAPriorOfStaticObject) {
  const auto observations = Fly({.seed = 3, .frames = 12}, nullptr, 0.1);
  const ObjectGround ground = ObjectGround::AtPlace({.point = TangentPlane(kBoxOrigin).GeodeticFromEnu({8, 3, -1.2}),
                                                     .covariance_enu_m2 = Eigen::Matrix3d::Identity()});
  const auto alone = EstimateBoxPlaces(observations, BoxMotion::kUnknown, {}, {}).back();
  const auto on_ground = EstimateBoxPlaces(observations, BoxMotion::kUnknown, ground, {}).back();
  ASSERT_TRUE(alone && on_ground);
  EXPECT_LT(TangentPlane(kBoxOrigin).EnuFromGeodetic(on_ground->point).head<2>().norm(), on_ground->ce90_m);
  EXPECT_LT(on_ground->ce90_m, 0.7 * alone->ce90_m);
}

TEST(EstimateBoxPlaces, UnknownGroundHeightFallsBackToTypeLength) {
  class UnknownGround final : public Ground {
   public:
    [[nodiscard]] std::optional<double> HeightAt(const GeodeticPoint& /*point*/) const override { return {}; }
    [[nodiscard]] double Spacing() const override { return 1; }
    [[nodiscard]] double MaxSlope() const override { return 1; }
  };
  const ObjectGround ground{std::make_shared<const UnknownGround>(), 1};
  const auto observations = Fly({.frames = 10, .speed_m_s = 0}, FindObjectType("car"), 0);
  for (const BoxMotion motion : {BoxMotion::kStatic, BoxMotion::kMoving}) {
    const auto place = EstimateBoxPlaces(observations, motion, ground, {}).back();
    ASSERT_TRUE(place);
    EXPECT_LT(TangentPlane(kBoxOrigin).EnuFromGeodetic(place->point).norm(), 60);
  }
}

TEST(EstimateBoxPlaces, GroundPointIsTheIntersectionOfItsLines) {
  const BoxFlight flight{.frames = 30};
  std::vector<CameraState> states;
  std::vector<GroundPointObservation> ground_points;
  for (int i = 0; i < flight.frames; ++i) {
    states.push_back(CameraAt(flight, 0.1 * i));
    const auto seen = PredictBox(kBoxOrigin, {0, 0, 2, 2}, states.back(), states.back(), kImage);
    ground_points.push_back({i, 0.1 * i, {seen->box.x + 1, seen->box.y + 1}});
  }
  const auto place = LocateGroundPoint(ground_points, CameraTrajectory(states, 1), kImage, {});
  ASSERT_TRUE(place);
  EXPECT_LT(TangentPlane(kBoxOrigin).EnuFromGeodetic(place->point).norm(), 0.5);
  EXPECT_FALSE(LocateGroundPoint(std::span(ground_points).first(1), CameraTrajectory(states, 1), kImage, {}))
      << "one line";
}

TEST(EstimateBoxPlaces, StaticMotionSuppressesVelocity) {
  const BoxFlight flight{.velocity_enu = {-1, 0.7, 0}, .frames = 150, .circles = true};  // as if it moved slowly
  const auto observations = Fly(flight, nullptr, 0);
  const auto moves = [](const std::optional<Geolocation>& place) { return place && place->IsMoving(); };
  EXPECT_TRUE(std::ranges::all_of(EstimateBoxPlaces(observations, BoxMotion::kUnknown, {}, {}), moves));
  for (const auto& place : EstimateBoxPlaces(observations, BoxMotion::kStatic, {}, {})) {
    ASSERT_TRUE(place);
    EXPECT_FALSE(place->IsMoving());
  }
}

TEST(EstimateBoxPlaces, ConsistencyDependsOnDistanceAndCovariance) {
  const std::vector<BearingObservation> observations = Fly({}, nullptr, 0);
  Geolocation place{.point = kBoxOrigin, .covariance_enu_m2 = Eigen::Matrix3d::Identity()};
  EXPECT_TRUE(IsConsistentWithPlace(observations[20], place, {}));
  place.point = TangentPlane(kBoxOrigin).GeodeticFromEnu({30, 0, 0});
  EXPECT_FALSE(IsConsistentWithPlace(observations[20], place, {}));
  place.covariance_enu_m2 *= 400;
  EXPECT_TRUE(IsConsistentWithPlace(observations[20], place, {})) << "it may stand there, as far as is known";
}

}  // namespace
}  // namespace victorious
