#include "victorious/place/associate/same_space.h"

#include <cmath>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kAcross_rad = kPi / 2;  // heading of what is seen from the side: cameras look north

// A body in a box, east, north and up of the camera.
struct SpaceReport {
  BearingObservation observation;
  Box box;
};

SpaceReport ReportOf(const Eigen::Vector3d& from_camera_m, double heading_rad = kAcross_rad, double box_x_px = 0) {
  SpaceReport report;
  report.observation.line.azimuth_rad = std::atan2(from_camera_m.x(), from_camera_m.y());
  report.observation.line.elevation_rad = std::asin(from_camera_m.z() / from_camera_m.norm());
  report.observation.line.range_m = from_camera_m.norm();
  report.observation.line.sigma_range_m = 2;
  report.observation.heading_rad = heading_rad;
  report.box = {box_x_px, 0, 100, 40};
  return report;
}

// The two share a camera: the result may not depend on which is first.
bool AreTogether(const SpaceReport& a, const SpaceReport& b) {
  const bool result = AreInSameSpace(a.observation, a.box, b.observation, b.box);
  EXPECT_EQ(result, AreInSameSpace(b.observation, b.box, a.observation, a.box));
  return result;
}

const Eigen::Vector3d kPlace(0, 70, -100);

TEST(AreInSameSpace, AShiftedReportIsInIt) {
  const SpaceReport lorry = ReportOf(kPlace);
  const Eigen::Vector3d shifted = kPlace + Eigen::Vector3d(6, 0.3, 0);
  EXPECT_TRUE(AreTogether(lorry, ReportOf(shifted, kAcross_rad, 60)));
  EXPECT_TRUE(AreTogether(lorry, ReportOf(shifted, kAcross_rad + kPi, 60)));
  EXPECT_TRUE(AreTogether(lorry, ReportOf(shifted, kAcross_rad + 0.4, 60))) << "headings have errors";
  EXPECT_TRUE(AreTogether(lorry, ReportOf(1.02 * shifted, kAcross_rad, 60))) << "so have ranges";
}

TEST(AreInSameSpace, ReportsBesideOrBehindOrAtAnAngleAreNot) {
  const SpaceReport lorry = ReportOf(kPlace);
  EXPECT_FALSE(AreTogether(lorry, ReportOf(kPlace + Eigen::Vector3d(6, 2.5, 0), kAcross_rad, 60))) << "beside it";
  EXPECT_FALSE(AreTogether(lorry, ReportOf(kPlace + Eigen::Vector3d(11, 0, 0), kAcross_rad, 90))) << "behind it";
  EXPECT_FALSE(AreTogether(lorry, ReportOf(kPlace + Eigen::Vector3d(6, 0, 0), kAcross_rad + 1, 60))) << "at an angle";
}

TEST(AreInSameSpace, EqualCentresAreForAnyHeadings) {
  EXPECT_TRUE(AreTogether(ReportOf(kPlace, 0), ReportOf(kPlace + Eigen::Vector3d(0.5, 1, 0), 1, 300)));
}

TEST(AreInSameSpace, NothingIsConcludedFromIncompleteOrAmbiguousReports) {
  const Eigen::Vector3d shifted = kPlace + Eigen::Vector3d(0, 6, 0);
  EXPECT_FALSE(AreTogether(ReportOf(kPlace, 0), ReportOf(shifted, 0))) << "seen along their length";
  const Eigen::Vector3d far(0, 300, -100);
  EXPECT_FALSE(AreTogether(ReportOf(far), ReportOf(far + Eigen::Vector3d(6, 0, 0)))) << "seen from low down";
  const Eigen::Vector3d aside = kPlace + Eigen::Vector3d(6, 0, 0);
  EXPECT_FALSE(AreTogether(ReportOf(kPlace), ReportOf(0.9 * aside))) << "one is above the other";
  SpaceReport unsized = ReportOf(aside);
  unsized.observation.line.range_m.reset();
  EXPECT_FALSE(AreTogether(ReportOf(kPlace), unsized));
  SpaceReport unturned = ReportOf(aside);
  unturned.observation.heading_rad.reset();
  EXPECT_FALSE(AreTogether(ReportOf(kPlace), unturned));
}

}  // namespace
}  // namespace victorious
