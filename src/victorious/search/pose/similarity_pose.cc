#include "victorious/search/pose/similarity_pose.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"
#include "victorious/search/pose/match_pairs.h"
#include "victorious/search/pose/plane_refinement.h"

namespace victorious {

void PoseOptions::ListFields(FieldList& fields) {
  fields.Add("min_inliers", min_inliers,
             {.min = 2,
              .max = 1000,
              .reason = "minimum number of distinct template keypoints among the inliers of a pose; two determine it"});
  fields.Add("max_instances", max_instances,
             {.min = 1, .max = 1000, .reason = "maximum number of instances of one template in one image"});
}

namespace {

// For each template keypoint the smallest residual, px, of its inliers that also agree in rotation and scale;
// ascending.
std::vector<double> AgreeingResidualsPx(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                        const MatchSet& inliers, const Similarity2& map) {
  std::map<std::uint32_t, double> nearest_px;
  for (const Match& match : inliers) {
    const Keypoint& s = scene[match.scene_keypoint];
    const Keypoint& m = model[match.template_keypoint];
    if (std::abs(std::log(s.scale_px / (m.scale_px * map.scale))) > std::log(kAgreementScale)) continue;
    if (std::abs(WrapAngle(s.orientation_rad - m.orientation_rad - map.rotation_rad)) > kAgreementRotationRad) continue;
    const double off_px = (map.Apply(Eigen::Vector2d(m.x, m.y)) - Eigen::Vector2d(s.x, s.y)).norm();
    const auto [known, first] = nearest_px.try_emplace(match.template_keypoint, off_px);
    if (!first) known->second = std::min(known->second, off_px);
  }
  std::vector<double> ascending;
  for (const auto& [keypoint, off_px] : nearest_px) ascending.push_back(off_px);
  std::ranges::sort(ascending);
  return ascending;
}

}  // namespace

std::vector<PlanarFit> EstimatePoses(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                     const MatchSet& matches, const Polygon& outline, double scene_area_px2,
                                     const PoseOptions& options, std::span<const Point3> points_in_model) {
  const double size_px = std::sqrt(std::abs(SignedArea(outline)));
  const SimilarityEstimator::Noise noise{.noise_px = kKeypointNoise_px, .shape_px = kShapeFraction * size_px};
  const MlesacOptions settings{.outlier_area_px2 = std::max(1.0, scene_area_px2),
                               .confidence = kPoseConfidence,
                               .max_hypotheses = kMaxPoseHypotheses,
                               .seed = options.seed};
  std::vector<PlanarFit> fits;
  MatchSet rest = matches;
  while (rest.size() >= static_cast<std::size_t>(options.min_inliers) &&
         fits.size() < static_cast<std::size_t>(options.max_instances)) {
    const std::vector<PointPair> pairs = MakePointPairs(scene, model, rest);
    const SimilarityEstimator estimator(pairs, noise);
    const auto result = Mlesac(estimator, settings);
    if (!result) break;
    PlanarFit fit;
    fit.scene_from_template = result->model;
    fit.sigma_px = estimator.SigmaPx(result->model);
    MatchSet inliers;
    MatchSet outliers;
    std::vector<PointPair> inlier_pairs;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const bool inlier = result->probabilities[i] > 0.5;
      (inlier ? inliers : outliers).push_back(rest[i]);
      if (inlier) inlier_pairs.push_back(pairs[i]);
    }
    fit.distinct_inliers = CountTemplateKeypoints(inliers);
    rest = std::move(outliers);
    if (inliers.size() < static_cast<std::size_t>(options.min_inliers)) break;
    // Matches of a repeated pattern to one template keypoint can outnumber a true instance: remove them, report none.
    if (fit.distinct_inliers < static_cast<std::size_t>(options.min_inliers)) continue;
    fit.agreeing_residuals_px = AgreeingResidualsPx(scene, model, inliers, fit.scene_from_template);
    fit.inliers = MakeFitInliers(model, points_in_model, inliers);
    fit.extent = Extent(inlier_pairs, outline);
    fit.scene_from_template_plane = fit.scene_from_template.Matrix();
    if (options.refine_plane) {
      const double plane_noise_px = kKeypointNoise_px * std::max(1.0, fit.scene_from_template.scale);
      fit.scene_from_template_plane =
          RefinePlane(inlier_pairs, fit.scene_from_template, fit.sigma_px, plane_noise_px, scene_area_px2, outline);
    }
    fits.push_back(std::move(fit));
  }
  std::ranges::stable_sort(fits, std::greater{}, &PlanarFit::distinct_inliers);
  return fits;
}

MatchSet SelectInliers(const MatchSet& matches, const PlanarFit& fit) {
  std::set<std::uint32_t> scene_keypoints;
  for (const FitInlier& inlier : fit.inliers) scene_keypoints.insert(inlier.scene_keypoint);
  MatchSet inliers;
  std::ranges::copy_if(matches, std::back_inserter(inliers),
                       [&](const Match& match) { return scene_keypoints.contains(match.scene_keypoint); });
  return inliers;
}

}  // namespace victorious
