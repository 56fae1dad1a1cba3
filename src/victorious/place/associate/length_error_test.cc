#include "victorious/place/associate/length_error.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/ground.h"
#include "victorious/place/associate/associate_objects.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const GeodeticPoint kLengthOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};

struct SeenVehicle {
  std::int64_t model = 1;
  Vector3d place = {0, 0, 1};
  double length_factor = 1;  // given length over true
  double heading_deg = 0;
  Vector3d velocity = Vector3d::Zero();
  double turn_rad_s = 0;  // of the camera's course
};

// Seen for 4 s from a camera that flies east at 10 m/s, 100 m above the origin.
ObservedTracklet SeenWithLength(std::int64_t id, const SeenVehicle& seen) {
  Random random(static_cast<std::uint64_t>(id));
  const TangentPlane plane(kLengthOrigin);
  ObservedTracklet tracklet{
      .record = {.id = id, .object = id, .video = 1, .model = seen.model}, .is_category = false, .is_cad_model = true};
  Vector3d camera(-20, -75, 100);
  for (int frame = 0; frame < 40; ++frame) {
    const double time_s = 0.1 * frame;
    const double turned_rad = seen.turn_rad_s * time_s;
    camera += Vector3d(std::cos(turned_rad), std::sin(turned_rad), 0);
    const Vector3d line = seen.place + time_s * seen.velocity - camera;
    BearingObservation observation;
    observation.line = {.time_s = time_s,
                        .camera = plane.GeodeticFromEnu(camera),
                        .azimuth_rad = std::atan2(line.x(), line.y()) + 1e-4 * random.Normal(),
                        .elevation_rad = std::asin(line.z() / line.norm()) + 1e-4 * random.Normal(),
                        .range_m = line.norm() * seen.length_factor * (1 + 0.01 * random.Normal()),
                        .sigma_rad = 1e-4,
                        .sigma_range_m = 2};
    observation.heading_rad = RadiansFromDegrees(seen.heading_deg + 2 * random.Normal());
    tracklet.frames.push_back(frame);
    tracklet.scores.push_back(0.99);
    tracklet.observations.push_back(observation);
  }
  tracklet.record.frames = 40;
  tracklet.record.last_time_s = 3.9;
  return tracklet;
}

std::vector<LengthError> ErrorsOf(const std::vector<ObservedTracklet>& tracklets, const ObjectOptions& options = {}) {
  return FindLengthErrors(tracklets, CompareRanges(tracklets, options), options);
}

TEST(LengthError, IsThatOfAnObjectThatWouldMoveAcrossItsHeading) {
  for (const double given : {0.5, 2.0, 3.28}) {
    std::vector<ObservedTracklet> tracklets = {SeenWithLength(1, {.length_factor = given, .heading_deg = 0})};
    const std::vector<LengthError> errors = ErrorsOf(tracklets);
    ASSERT_EQ(errors.size(), 1U) << given;
    EXPECT_EQ(errors[0].model, 1);
    EXPECT_NEAR(errors[0].factor * given, 1, 0.05);
    EXPECT_EQ(errors[0].objects, 1);

    const std::vector<ObjectRecord> driving = AssociateTracklets(tracklets, {}, {});
    ASSERT_FALSE(driving[0].place) << "as given";
    EXPECT_TRUE(driving[0].place_rejected.contains("off its heading")) << driving[0].place_rejected;
    CorrectLengths(errors, tracklets);
    const std::vector<ObjectRecord> standing = AssociateTracklets(tracklets, {}, {});
    ASSERT_TRUE(standing[0].place) << given;
    EXPECT_FALSE(standing[0].place->IsMoving());
    EXPECT_LT(TangentPlane(kLengthOrigin).EnuFromGeodetic(standing[0].place->point).norm(), 3);
  }
}

TEST(LengthError, IsThatOfAnObjectThatWouldTurnWithTheCamera) {
  EXPECT_EQ(ErrorsOf({SeenWithLength(1, {.length_factor = 2, .heading_deg = 90, .turn_rad_s = 0.3})}).size(), 1U);
}

// Which of the two is true, nothing but its height tells.
TEST(LengthError, OfAnObjectAlongTheFlightIsDecidedByItsHeight) {
  const ObservedTracklet along = SeenWithLength(1, {.length_factor = 2, .heading_deg = 90});
  EXPECT_TRUE(ErrorsOf({along}).empty());
  EXPECT_EQ(ErrorsOf({along, SeenWithLength(2, {.model = 2, .place = {9, 8, 2}, .heading_deg = 90})}).size(), 1U);
  ObjectOptions options;
  options.ground = std::make_shared<FlatGround>(kLengthOrigin.altitude_m);
  EXPECT_EQ(ErrorsOf({along}, options).size(), 1U);
}

TEST(LengthError, DrivingObjectsHaveNone) {
  const SeenVehicle oncoming{.heading_deg = 270, .velocity = {-10, 0, 0}};
  EXPECT_TRUE(ErrorsOf({SeenWithLength(1, oncoming)}).empty()) << "along the flight";
  EXPECT_TRUE(ErrorsOf({SeenWithLength(1, {.heading_deg = 180, .velocity = {0, -10, 0}})}).empty()) << "across it";
  SeenVehicle sideways = oncoming;  // as a helicopter may
  sideways.heading_deg = 0;
  EXPECT_TRUE(ErrorsOf({SeenWithLength(1, sideways), SeenWithLength(2, {.model = 2, .place = {9, 8, 2}})}).empty());
}

TEST(LengthError, ObjectsOfOneModelMustAgree) {
  const ObservedTracklet wrong = SeenWithLength(1, {.length_factor = 2});
  EXPECT_EQ(
      ErrorsOf({wrong, SeenWithLength(2, {.place = {20, 5, 1}, .length_factor = 2, .heading_deg = 30})})[0].objects, 2);
  EXPECT_TRUE(ErrorsOf({wrong, SeenWithLength(2, {.place = {20, 5, 1}})}).empty());
  EXPECT_TRUE(ErrorsOf({SeenWithLength(1, {.length_factor = 6})}).empty()) << "rather a false find";
  EXPECT_TRUE(ErrorsOf({SeenWithLength(1, {.length_factor = 1.1})}).empty()) << "of sizes and cameras";
}

TEST(LengthError, IsOneOfEachModel) {
  const std::vector<LengthError> errors = {{.model = 3, .factor = 0.5, .objects = 1}};
  EXPECT_EQ(LengthFactorOf(errors, 3), 0.5);
  EXPECT_EQ(LengthFactorOf(errors, 4), 1);
  EXPECT_EQ(DescribeLengthFactor(0.5), "stands still only if the model is 2.0 times too long");
}

}  // namespace
}  // namespace victorious
