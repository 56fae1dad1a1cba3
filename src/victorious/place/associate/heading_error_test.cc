#include "victorious/place/associate/heading_error.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/associate/associate_objects.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const GeodeticPoint kHeadingOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};

enum class Path { kCircle, kStraight };

// Seen for 8 s from a camera that circles by 120 degrees, or flies straight, with a yaw that is off.
ObservedTracklet SeenWithHeading(std::int64_t id, const Vector3d& place, double error_deg, Path path = Path::kCircle,
                                 const Vector3d& velocity = Vector3d::Zero(), double range_factor = 1) {
  Random random(static_cast<std::uint64_t>(id));
  const TangentPlane plane(kHeadingOrigin);
  ObservedTracklet tracklet{.record = {.id = id, .object = id, .video = 1, .model = id}};
  for (int frame = 0; frame < 80; ++frame) {
    const double time_s = 0.1 * frame;
    const double angle_rad = 0.26 * time_s;
    const Vector3d camera = path == Path::kCircle ? Vector3d(75 * std::sin(angle_rad), -75 * std::cos(angle_rad), 100)
                                                  : Vector3d(10 * time_s - 40, -75, 100);
    const Vector3d line = place + time_s * velocity - camera;
    BearingObservation observation;
    observation.line = {
        .time_s = time_s,
        .camera = plane.GeodeticFromEnu(camera),
        .azimuth_rad = std::atan2(line.x(), line.y()) + RadiansFromDegrees(error_deg) + 2e-3 * random.Normal(),
        .elevation_rad = std::asin(line.z() / line.norm()) + 2e-3 * random.Normal(),
        .range_m = line.norm() * range_factor * (1 + 0.01 * random.Normal()),
        .sigma_rad = 2e-3,
        .sigma_range_m = 2};
    observation.heading_rad = RadiansFromDegrees(30 + error_deg);
    tracklet.frames.push_back(frame);
    tracklet.scores.push_back(0.99);
    tracklet.observations.push_back(observation);
  }
  tracklet.record.frames = 80;
  tracklet.record.last_time_s = 7.9;
  return tracklet;
}

TEST(HeadingError, IsThatOnWhichDifferentObjectsAgree) {
  for (const double given_deg : {-18.3, -5.0, 4.1, 5.0, 12.0}) {
    std::vector<ObservedTracklet> tracklets = {SeenWithHeading(1, {0, 0, 1}, given_deg),
                                               SeenWithHeading(2, {8, 5, 1}, given_deg),
                                               SeenWithHeading(3, {-16, 9, 2}, given_deg)};
    const auto error = EstimateHeadingError(tracklets);
    ASSERT_TRUE(error) << given_deg;
    EXPECT_NEAR(DegreesFromRadians(error->error_rad), given_deg, 0.3);
    EXPECT_EQ(error->objects, 3);

    TurnBack(*error, tracklets);
    EXPECT_FALSE(EstimateHeadingError(tracklets)) << "corrected";
    const std::vector<ObjectRecord> objects = AssociateTracklets(tracklets, {}, {});
    ASSERT_EQ(objects.size(), 3U);
    const TangentPlane plane(kHeadingOrigin);
    for (const ObjectRecord& object : objects) {
      ASSERT_TRUE(object.place);
      EXPECT_FALSE(object.place->IsMoving());
      EXPECT_NEAR(DegreesFromRadians(object.heading_rad.value()), 30, 0.5);
    }
    const Vector3d error_m = plane.EnuFromGeodetic(objects[0].place->point) - Vector3d(0, 0, 1);
    EXPECT_LT(error_m.head<2>().norm(), objects[0].place->ce90_m);
    EXPECT_LT(error_m.head<2>().norm(), 1);
  }
}

TEST(HeadingError, OfExactYawAndOfAWrongFieldOfViewThereIsNone) {
  EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 0), SeenWithHeading(2, {8, 5, 1}, 0)}));
  EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 0, Path::kCircle, {0, 0, 0}, 1.2),
                                                SeenWithHeading(2, {8, 5, 1}, 0, Path::kCircle, {0, 0, 0}, 1.2)}));
}

TEST(HeadingError, OneObjectIsNotEnough) {
  EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 5)}));
  EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 0), SeenWithHeading(2, {8, 5, 1}, 5)}));
}

TEST(HeadingError, DrivingObjectsAndStraightFlightsShowNone) {
  EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 0, Path::kCircle, {5, 0, 0}),
                                                SeenWithHeading(2, {8, 5, 1}, 0, Path::kCircle, {-6, 0, 0}),
                                                SeenWithHeading(3, {-6, 7, 1}, 0, Path::kCircle, {0, 7, 0})}));
  EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 5, Path::kStraight),
                                                SeenWithHeading(2, {8, 5, 1}, 5, Path::kStraight)}));
}

// Two vehicles that drive across a straight flight: lines turned by some 8 degrees meet, too.
TEST(HeadingError, ConvoyPastAStraightFlightShowsNone) {
  for (const Vector3d& velocity : {Vector3d(0, 1.5, 0), Vector3d(0, -1.5, 0), Vector3d(1, 2, 0)}) {
    EXPECT_FALSE(EstimateHeadingError(std::vector{SeenWithHeading(1, {0, 0, 1}, 0, Path::kStraight, velocity),
                                                  SeenWithHeading(2, {8, 5, 1}, 0, Path::kStraight, velocity)}))
        << velocity.transpose();
  }
}

}  // namespace
}  // namespace victorious
