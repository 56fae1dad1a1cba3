#include <cstdint>
#include <string>

#include "bench/benchmarks.h"
#include "testing/drawn_lines.h"
#include "victorious/place/geolocate/consensus.h"
#include "victorious/place/geolocate/locate.h"

namespace victorious::bench {
namespace {

testing::SyntheticLines NoisyLines(std::uint64_t seed, const Eigen::Vector3d& velocity_enu) {
  return testing::SimulateLinesOfSight({.seed = seed,
                                        .count = 1000,
                                        .velocity_enu = velocity_enu,
                                        .outlier_fraction = 0.4,
                                        .noise_position_m = 2,
                                        .noise_deg = 0.5});
}

// Counts over many seeds how often the place is within 3 sigma and how often 95 % of the inliers are kept.
std::vector<std::pair<std::string, double>> ReliabilityFigures(const LocateOptions& settings,
                                                               const Eigen::Vector3d& velocity_enu, int seeds) {
  int near = 0;
  int kept = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const testing::SyntheticLines drawn = NoisyLines(static_cast<std::uint64_t>(seed), velocity_enu);
    LocateOptions options = settings;
    options.seed = static_cast<std::uint64_t>(seed);
    const auto fix = Locate(drawn.lines, options);
    if (!fix || !fix->place) continue;
    const Eigen::Vector3d off = TangentPlane(fix->place->point).EnuFromGeodetic(drawn.object);
    near += off.dot(fix->place->covariance_enu_m2.inverse() * off) <= 9 ? 1 : 0;
    int right = 0;
    int right_kept = 0;
    for (std::size_t i = 0; i < drawn.wrong.size(); ++i) {
      right += drawn.wrong[i] ? 0 : 1;
      right_kept += !drawn.wrong[i] && fix->inliers[i] ? 1 : 0;
    }
    kept += right_kept >= 0.95 * right ? 1 : 0;
  }
  return {{"seeds", seeds}, {"within_3_sigma", near}, {"kept_95_percent", kept}};
}

Result Time(const std::string& name, const LocateOptions& options, const Eigen::Vector3d& velocity_enu,
            const Settings& settings) {
  const testing::SyntheticLines drawn = NoisyLines(1, velocity_enu);
  const Implementation ours = {"victorious", [&] { return Locate(drawn.lines, options)->place->ce90_m; }};
  Result result = Compare(name, ours, {}, settings.effort());
  result.figures = ReliabilityFigures(options, velocity_enu, settings.quick ? 2 : 1000);
  return result;
}

Result TimeConsensus(const Settings& settings) {
  const testing::SyntheticLines drawn = NoisyLines(1, {0, 0, 0});
  const LocateOptions options{.method = LocateMethod::kRansac};
  const std::vector<Ray> rays = MakeRays(drawn.lines, TangentPlane(drawn.lines.front().camera), options);
  const Implementation ours = {"victorious", [&] { return FindConsensus(rays, options)->motion.place.x(); }};
  Result result = Compare("locate_consensus", ours, {}, settings.effort());
  result.figures = {{"lines", 1000}, {"hypotheses", FindConsensus(rays, options)->hypotheses}};
  return result;
}

}  // namespace

std::vector<Result> BenchLocate(const Settings& settings) {
  const Eigen::Vector3d still(0, 0, 0);
  const Eigen::Vector3d driving(4, -3, 0);
  return {TimeConsensus(settings), Time("locate_ransac", {.method = LocateMethod::kRansac}, still, settings),
          Time("locate_ransac_velocity", {.motion = MotionModel::kVelocity, .method = LocateMethod::kRansac}, driving,
               settings),
          Time("locate_ml", {}, still, settings)};
}

}  // namespace victorious::bench
