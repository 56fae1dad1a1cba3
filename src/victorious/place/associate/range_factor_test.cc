#include "victorious/place/associate/range_factor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/associate/associate_objects.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

const GeodeticPoint kRangeOrigin{RadiansFromDegrees(48), RadiansFromDegrees(11), 500};

// Seen for 4 s from a camera that circles by 60 degrees, or flies straight.
ObservedTracklet SeenAtRange(std::int64_t id, const Vector3d& place, double range_factor, bool circling = true,
                             const Vector3d& velocity = Vector3d::Zero()) {
  Random random(static_cast<std::uint64_t>(id));
  const TangentPlane plane(kRangeOrigin);
  ObservedTracklet tracklet{.record = {.id = id, .object = id, .video = 1, .model = id}};
  for (int frame = 0; frame < 40; ++frame) {
    const double time_s = 0.1 * frame;
    const double angle_rad = time_s * 0.26;
    const Vector3d camera =
        circling ? Vector3d(75 * std::sin(angle_rad), -75 * std::cos(angle_rad), 100) : Vector3d(10 * time_s, -75, 100);
    const Vector3d line = place + time_s * velocity - camera;
    BearingObservation observation;
    observation.line = {.time_s = time_s,
                        .camera = plane.GeodeticFromEnu(camera),
                        .azimuth_rad = std::atan2(line.x(), line.y()) + 1e-4 * random.Normal(),
                        .elevation_rad = std::asin(line.z() / line.norm()) + 1e-4 * random.Normal(),
                        .range_m = line.norm() * range_factor * (1 + 0.01 * random.Normal()),
                        .sigma_rad = 1e-4,
                        .sigma_range_m = 2};
    tracklet.frames.push_back(frame);
    tracklet.scores.push_back(0.99);
    tracklet.observations.push_back(observation);
  }
  tracklet.record.frames = 40;
  tracklet.record.last_time_s = 3.9;
  return tracklet;
}

std::optional<RangeFactor> FactorOf(const std::vector<ObservedTracklet>& tracklets) {
  return EstimateRangeFactor(tracklets, CompareRanges(tracklets, {}));
}

TEST(RangeFactor, IsThatOnWhichDifferentObjectsAgree) {
  for (const double given : {1 / 1.2, 1.2}) {
    std::vector<ObservedTracklet> tracklets = {SeenAtRange(1, {0, 0, 1}, given), SeenAtRange(2, {8, 5, 1}, given),
                                               SeenAtRange(3, {-6, 7, 2}, given)};
    const auto factor = FactorOf(tracklets);
    ASSERT_TRUE(factor) << given;
    EXPECT_NEAR(factor->factor, 1 / given, 0.02);
    EXPECT_EQ(factor->objects, 3);
    for (ObservedTracklet& tracklet : tracklets) ScaleRanges(factor->factor, tracklet);
    EXPECT_FALSE(FactorOf(tracklets)) << "corrected";
    for (const ObjectRecord& object : AssociateTracklets(tracklets, {}, {})) {
      ASSERT_TRUE(object.place);
      EXPECT_FALSE(object.place->IsMoving()) << "parked objects stay parked";
    }
  }
}

TEST(RangeFactor, ExactRangesHaveNone) {
  EXPECT_FALSE(FactorOf({SeenAtRange(1, {0, 0, 1}, 1), SeenAtRange(2, {8, 5, 1}, 1)}));
}

TEST(RangeFactor, OneObjectOfAnotherSizeIsNoCommonError) {
  EXPECT_FALSE(FactorOf({SeenAtRange(1, {0, 0, 1}, 1), SeenAtRange(2, {8, 5, 1}, 1.2)}));
  EXPECT_FALSE(FactorOf({SeenAtRange(2, {8, 5, 1}, 1.2)}));
}

// Each drives at a speed of its own, and so contradicts its size by another factor.
TEST(RangeFactor, DrivingObjectsHaveNone) {
  const std::vector<ObservedTracklet> tracklets = {SeenAtRange(1, {0, 0, 1}, 1, false, {5, 0, 0}),
                                                   SeenAtRange(2, {8, 5, 1}, 1, false, {-6, 0, 0}),
                                                   SeenAtRange(3, {-6, 7, 1}, 1, false, {7, 2, 0})};
  EXPECT_FALSE(FactorOf(tracklets));
}

}  // namespace
}  // namespace victorious
