#include "victorious/place/geolocate/consensus.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "testing/drawn_lines.h"
#include "victorious/place/geolocate/locate.h"

namespace victorious {
namespace {

using testing::SimulateLinesOfSight;
using testing::SyntheticLines;

double InlierRecall(const GeoFix& fix, const SyntheticLines& drawn) {
  int right = 0;
  int kept = 0;
  for (std::size_t i = 0; i < drawn.wrong.size(); ++i) {
    right += drawn.wrong[i] ? 0 : 1;
    kept += !drawn.wrong[i] && fix.inliers[i] ? 1 : 0;
  }
  return kept / static_cast<double>(right);
}

double MahalanobisError(const GeoFix& fix, const GeodeticPoint& truth) {
  const Eigen::Vector3d off = TangentPlane(fix.place->point).EnuFromGeodetic(truth);
  return std::sqrt(off.dot(fix.place->covariance_enu_m2.ldlt().solve(off)));
}

TEST(Consensus, IsRobustToFortyPercentOutliers) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const SyntheticLines drawn = SimulateLinesOfSight(
        {.seed = seed, .count = 1000, .outlier_fraction = 0.4, .noise_position_m = 2, .noise_deg = 0.5});
    const auto fix = Locate(drawn.lines, {.method = LocateMethod::kRansac, .seed = seed});
    ASSERT_TRUE(fix && fix->place) << "seed " << seed;
    EXPECT_GE(InlierRecall(*fix, drawn), 0.95) << "seed " << seed;
    EXPECT_LE(MahalanobisError(*fix, drawn.object), 3) << "seed " << seed;
  }
}

TEST(Consensus, IsDeterministicBySeed) {
  const SyntheticLines drawn = SimulateLinesOfSight({.outlier_fraction = 0.4, .noise_position_m = 2, .noise_deg = 0.5});
  const auto inliers = [&](std::uint64_t seed) { return Locate(drawn.lines, {.seed = seed})->inliers; };
  EXPECT_EQ(inliers(3), inliers(3));
}

}  // namespace
}  // namespace victorious
