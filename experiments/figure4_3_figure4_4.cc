// Figures 4.3 and 4.4: the conic frustum of one sighting, and the intersection of the frusta of many sightings.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "experiments/indexed_movie.h"
#include "experiments/system_experiments.h"
#include "experiments/video_frames.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/polygon.h"
#include "victorious/place/geolocate/locate.h"
#include "victorious/place/geolocate/ray.h"

namespace victorious {
namespace {

constexpr const char* kKind = "jeep";

// The observations of one static true object with the default setting: lines of sight by time, and the true place.
struct ObjectBearings {
  std::string name;
  GeodeticPoint place;
  std::vector<LineOfSight> lines;
};

// The true place of a static object; std::nullopt for a moving one.
std::optional<GeodeticPoint> StaticPlace(const MovieWithTruth& movie, const std::string& object) {
  std::optional<GeodeticPoint> place;
  for (const TruthRow& row : movie.truth) {
    if (row.object != object || !row.place) continue;
    if (!place) place = row.place;
    if (TangentPlane(*place).EnuFromGeodetic(*row.place).norm() > 0.01) return std::nullopt;
  }
  return place;
}

Expected<std::vector<ObjectBearings>> CollectObservations(const MovieWithTruth& movie,
                                                          const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, IndexMovie(movie, TrackingIndexOptions(), settings));
  std::map<std::string, ObjectBearings> observed;
  for (const ObjectModel& model : movie.models) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SightingRecord> sightings,
                                store->Sightings({.model_name = model.name}));
    for (const SightingRecord& sighting : sightings) {
      if (!sighting.observation) continue;
      for (const TruthRow& row : movie.truth) {
        constexpr double kOverlap = 0.5;
        if (row.frame != sighting.frame || row.model != model.name) continue;
        if (IntersectionOverUnion(row.box, sighting.box) < kOverlap) continue;
        const std::optional<GeodeticPoint> place = StaticPlace(movie, row.object);
        if (!place) continue;
        ObjectBearings& one = observed[row.object];
        one.name = row.object;
        one.place = *place;
        one.lines.push_back(sighting.observation->line);
        break;
      }
    }
  }
  std::vector<ObjectBearings> all;
  for (auto& [name, one] : observed) {
    std::ranges::sort(one.lines, {}, &LineOfSight::time_s);
    all.push_back(std::move(one));
  }
  if (all.empty()) return Fail(ErrorCode::kNotFound, fmt::format("{}: no static object was detected", movie.name));
  return all;
}

double RadiusAt(const Ray& ray, double along_m) {
  return std::sqrt(ray.frustum.base_m2 + along_m * along_m * ray.frustum.slope);
}

double FrustumVolume(const Ray& ray) {
  const Frustum& f = ray.frustum;
  const auto integral = [&](double a) { return f.base_m2 * a + f.slope * a * a * a / 3; };
  return kPi * (integral(f.farthest_m) - integral(f.nearest_m));
}

// Selects evenly spaced lines.
std::vector<LineOfSight> SelectEvenly(const std::vector<LineOfSight>& lines, int count) {
  std::vector<LineOfSight> some;
  for (const std::int64_t at : EvenlySpaced(static_cast<std::int64_t>(lines.size()), count)) {
    some.push_back(lines[static_cast<std::size_t>(at)]);
  }
  return some;
}

// The intersection of the frusta of some rays, by Monte Carlo sampling of the first frustum.
struct FrustumOverlap {
  double volume_m3 = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector2d> plan;  ///< east and north of some points inside
};

FrustumOverlap SampleIntersection(const std::vector<Ray>& rays) {
  constexpr int kDraws = 400'000;
  constexpr std::size_t kKept = 4000;
  Random random(1);
  const Ray& first = rays.front();
  const double widest_m = RadiusAt(first, first.frustum.farthest_m);
  const double cylinder_m3 = kPi * widest_m * widest_m * (first.frustum.farthest_m - first.frustum.nearest_m);
  FrustumOverlap common;
  int inside = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double along_m = random.Uniform(first.frustum.nearest_m, first.frustum.farthest_m);
    const double off_m = widest_m * std::sqrt(random.Uniform());
    const double turn_rad = random.Uniform(0, 2 * kPi);
    const Eigen::Vector3d point = first.camera + along_m * first.forward +
                                  off_m * (std::cos(turn_rad) * first.side + std::sin(turn_rad) * first.rise);
    if (!std::ranges::all_of(rays, [&](const Ray& ray) { return InFrustum(ray, Motion{.place = point}); })) continue;
    ++inside;
    common.middle += point;
    if (common.plan.size() < kKept) common.plan.emplace_back(point.head<2>());
  }
  if (inside > 0) common.middle /= inside;
  common.volume_m3 = cylinder_m3 * inside / kDraws;
  return common;
}

const ObjectBearings& SelectPlotted(const std::vector<ObjectBearings>& observed) {
  const auto found =
      std::ranges::find_if(observed, [](const ObjectBearings& one) { return one.name.starts_with(kKind); });
  return found != observed.end() ? *found : observed.front();
}

PlotLine Closed(const std::string& name, std::vector<Eigen::Vector2d> corners) {
  PlotLine line{.name = name, .points = {}, .marked = false};
  if (!corners.empty()) corners.push_back(corners.front());
  for (const Eigen::Vector2d& corner : corners) line.points.push_back({corner.x(), corner.y()});
  return line;
}

PlotLine Dot(const std::string& name, double x, double y) {
  return {.name = name, .points = {{x, y}}, .connected = false};
}

constexpr const char* kFrustumNote =
    "The frustum's radius is identity_radius_m, widened with the distance by the line's own error. It extends from the "
    "estimated range divided by distance_prior_allowance to the range times it: parameters objects.locate.*, for which "
    "the thesis gives no values.";

}  // namespace

Expected<Report> RunFigure43(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MovieWithTruth> movies, SimulateScenes({"circle"}, settings));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectBearings> observed,
                              CollectObservations(movies.front(), settings));
  const LocateOptions options = TrackingIndexOptions().objects.locate;
  Report report{
      .title = "The conic frustum of one sighting",
      .columns = {"object", "time, s", "true distance, m", "range from size, m", "range sigma, m", "nearest, m",
                  "farthest, m", "radius there, m", "truth to line, m", "truth inside", "volume, m3"}};
  for (const ObjectBearings& one : observed) {
    const std::vector<LineOfSight> lines = SelectEvenly(one.lines, 1);
    const TangentPlane plane(lines.front().camera);
    const Ray ray = MakeRays(lines, plane, options).front();
    const Eigen::Vector3d truth = plane.EnuFromGeodetic(one.place) - ray.camera;
    const double along_m = truth.dot(ray.forward);
    const double off_m = (truth - along_m * ray.forward).norm();
    const bool inside = InFrustum(ray, Motion{.place = truth + ray.camera});
    report.rows.push_back({one.name, lines.front().time_s, truth.norm(), ray.range_m, ray.sigma_range_m,
                           ray.frustum.nearest_m, ray.frustum.farthest_m, RadiusAt(ray, along_m), off_m,
                           inside ? "yes" : "no", FrustumVolume(ray)});
    if (&one != &SelectPlotted(observed)) continue;
    std::vector<Eigen::Vector2d> outline;
    for (const double side : {1.0, -1.0}) {
      for (const double share : {0.0, 1.0}) {
        const double at = side > 0 ? share : 1 - share;
        const double a = ray.frustum.nearest_m + at * (ray.frustum.farthest_m - ray.frustum.nearest_m);
        outline.emplace_back(a, side * RadiusAt(ray, a));
      }
    }
    report.plot = {
        .title = fmt::format("Conic frustum of one sighting of the {}", one.name),
        .x = {.label = "along the line of sight from the camera, m", .low = 0, .high = 1.15 * ray.frustum.farthest_m},
        .y = {.label = "across it, m", .low = -10, .high = 10},
        .lines = {{.name = "line of sight", .points = {{0, 0}, {ray.frustum.farthest_m, 0}}, .marked = false},
                  Closed("conic frustum", outline),
                  Dot("by apparent size", ray.range_m, 0),
                  Dot("truth", along_m, truth.dot(ray.side))}};
  }
  report.notes = {"The middle sighting of each object in " + DescribeMovies(movies) + ", with exact telemetry.",
                  kFrustumNote};
  return report;
}

Expected<Report> RunFigure44(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MovieWithTruth> movies, SimulateScenes({"circle"}, settings));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectBearings> observed,
                              CollectObservations(movies.front(), settings));
  const LocateOptions options = TrackingIndexOptions().objects.locate;
  Report report{.title = "Intersection of the conic frusta of many sightings",
                .columns = {"object", "lines of sight", "common volume, m3", "fraction of one frustum", "truth inside",
                            "centroid error, m", "locate error, m", "CE90, m"}};
  for (const ObjectBearings& one : observed) {
    double of_one_m3 = 0;
    for (const int count : {1, 2, 3, 5, 10, 30}) {
      if (static_cast<std::size_t>(count) > one.lines.size()) break;
      const std::vector<LineOfSight> lines = SelectEvenly(one.lines, count);
      const TangentPlane plane(lines.front().camera);
      const std::vector<Ray> rays = MakeRays(lines, plane, options);
      const Eigen::Vector3d truth = plane.EnuFromGeodetic(one.place);
      const FrustumOverlap common = SampleIntersection(rays);
      if (count == 1) of_one_m3 = common.volume_m3;
      const bool inside =
          std::ranges::all_of(rays, [&](const Ray& ray) { return InFrustum(ray, Motion{.place = truth}); });
      VICTORIOUS_ASSIGN_OR_RETURN(const GeoFix fix, Locate(lines, options));
      std::vector<Cell> row = {one.name,
                               static_cast<double>(count),
                               common.volume_m3,
                               common.volume_m3 / of_one_m3,
                               inside ? "yes" : "no",
                               (common.middle - truth).norm(),
                               "-",
                               "-"};
      if (fix.place) {
        row[6] = (plane.EnuFromGeodetic(fix.place->point) - truth).norm();
        row[7] = fix.place->ce90_m;
      }
      report.rows.push_back(std::move(row));
      if (&one != &SelectPlotted(observed) || count != 3) continue;
      // Plan view around the truth, with equal scales.
      const Eigen::Vector2d middle = truth.head<2>();
      report.plot = {.title = fmt::format("Three sightings of the {}, in plan", one.name),
                     .x = {.label = "east of the truth, m", .low = -18.6, .high = 18.6},
                     .y = {.label = "north of the truth, m", .low = -11, .high = 11},
                     .lines = {}};
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i];
        const double along_m = (truth - ray.camera).dot(ray.forward);
        const Eigen::Vector2d foot = (ray.camera + along_m * ray.forward).head<2>() - middle;
        const Eigen::Vector2d ahead = ray.forward.head<2>().normalized();
        const Eigen::Vector2d across = RadiusAt(ray, along_m) * Eigen::Vector2d(-ahead.y(), ahead.x());
        constexpr double kShownM = 8.0;  // the frusta are far longer
        report.plot.lines.push_back(Closed(fmt::format("frustum at {:.1f} s", lines[i].time_s),
                                           {foot - kShownM * ahead + across, foot + kShownM * ahead + across,
                                            foot + kShownM * ahead - across, foot - kShownM * ahead - across}));
      }
      std::vector<Eigen::Vector2d> plan = common.plan;
      for (Eigen::Vector2d& point : plan) point -= middle;
      report.plot.lines.push_back(Closed("intersection", ConvexHull(std::move(plan))));
      report.plot.lines.push_back(Dot("truth", 0, 0));
    }
  }
  report.notes = {
      "Lines spread over an object's sightings in " + DescribeMovies(movies) +
          ", with exact telemetry. The common volume is estimated from 400,000 random points in the first frustum; "
          "`locate` is the maximum-likelihood place from the same lines (method ml). The plot cuts each frustum 8 m "
          "before and behind the truth.",
      kFrustumNote};
  return report;
}

}  // namespace victorious
