#include "victorious/search/recognize/common_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kSizeStep = 1.0 / 8;  // octaves
constexpr double kSizeReach = 0.2;
constexpr double kOffNadirStep_rad = RadiansFromDegrees(10);
constexpr double kOffNadirReach_rad = RadiansFromDegrees(10.5);
// A pattern that repeats itself, as houses or hedges do, agrees with itself: no model counts for more decades.
constexpr double kMaxDecadesOfModel = 15;
constexpr double kMinDecadesOfModel = 3;
constexpr double kMinDecades = 45;
constexpr double kMinRatio = 1.5;  // to the second best view
constexpr double kMaxHalfFieldOfView_rad = RadiansFromDegrees(40);
constexpr double kMinHalfFieldOfView_rad = RadiansFromDegrees(0.3);
constexpr double kMinTilt_rad = RadiansFromDegrees(10);  // of less, the slope tells nothing

double Octaves(double pixels_per_m) { return std::log2(pixels_per_m); }

bool AgreesWith(const ShapeMatch& match, double octaves, double off_nadir_rad) {
  return match.neg_log10_nfa > 0 && std::abs(Octaves(match.pixels_per_m) - octaves) <= kSizeReach &&
         std::abs(match.to_camera.off_nadir_rad - off_nadir_rad) <= kOffNadirReach_rad;
}

// The matches that agree with a view.
struct Support {
  double octaves = 0;
  double off_nadir_rad = 0;
  double decades = 0;
  int models = 0;  // with kMinDecadesOfModel or more
};

Support SupportOf(std::span<const ShapeMatch> matches, double octaves, double off_nadir_rad) {
  std::map<std::size_t, double> of_model;
  for (const ShapeMatch& match : matches) {
    if (AgreesWith(match, octaves, off_nadir_rad)) of_model[match.model_index] += match.neg_log10_nfa;
  }
  Support support{.octaves = octaves, .off_nadir_rad = off_nadir_rad};
  for (const auto& [model, decades] : of_model) {
    support.decades += std::min(decades, kMaxDecadesOfModel);
    if (decades >= kMinDecadesOfModel) ++support.models;
  }
  return support;
}

// Of a camera f px above flat ground, seen at the off-nadir angle a in the middle: below it by y, the angle is a - y /
// f and the logarithm of the size larger by y tan(a) / f. The slope is fitted to the matches that agree with it,
// weighted by their decades.
CommonView FitView(std::span<const ShapeMatch> matches, const Support& support, const cv::Size& size) {
  constexpr int kRounds = 4;
  const double middle_px = size.height / 2.0;
  const double most = std::tan(kMaxHalfFieldOfView_rad) / (size.width / 2.0);  // 1 / f, per px
  double octaves = support.octaves;
  double off_nadir_rad = support.off_nadir_rad;
  double per_focal = 0;
  for (int round = 0; round < kRounds; ++round) {
    double weights = 0;
    Eigen::Vector3d means = Eigen::Vector3d::Zero();  // of y, of the logarithm of the size, of the angle in the middle
    Eigen::Vector2d products = Eigen::Vector2d::Zero();
    for (const ShapeMatch& match : matches) {
      const double y_px = match.centre_px.y() - middle_px;
      const double slope = std::tan(off_nadir_rad) * per_focal;
      if (!AgreesWith(match, octaves + y_px * slope / std::numbers::ln2, off_nadir_rad - y_px * per_focal)) continue;
      const double size_log = std::log(match.pixels_per_m);
      weights += match.neg_log10_nfa;
      means += match.neg_log10_nfa * Eigen::Vector3d(y_px, size_log, match.to_camera.off_nadir_rad + y_px * per_focal);
      products += match.neg_log10_nfa * Eigen::Vector2d(y_px * y_px, y_px * size_log);
    }
    if (!(weights > 0)) break;
    means /= weights;
    products /= weights;
    off_nadir_rad = means[2];
    const double variance = products[0] - means[0] * means[0];
    const double slope = variance > 0 ? (products[1] - means[0] * means[1]) / variance : 0;
    per_focal = std::clamp(slope / std::tan(std::max(kMinTilt_rad, off_nadir_rad)), 0.0, most);
    octaves = (means[1] - means[0] * std::tan(off_nadir_rad) * per_focal) / std::numbers::ln2;
  }
  const double least = std::tan(kMinHalfFieldOfView_rad) / (size.width / 2.0);
  return {
      .off_nadir_rad = off_nadir_rad, .pixels_per_m = std::exp2(octaves), .focal_px = 1 / std::max(least, per_focal)};
}

}  // namespace

std::optional<CommonView> FindCommonView(std::span<const ShapeMatch> matches, const cv::Size& size) {
  if (matches.empty()) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(matches, {}, &ShapeMatch::pixels_per_m);
  std::vector<Support> views;
  for (double octaves = Octaves(least.pixels_per_m); octaves <= Octaves(most.pixels_per_m); octaves += kSizeStep) {
    for (double off_nadir_rad = 0; off_nadir_rad < kPi / 2; off_nadir_rad += kOffNadirStep_rad)
      views.push_back(SupportOf(matches, octaves, off_nadir_rad));
  }
  if (views.empty()) return std::nullopt;
  const Support& best = *std::ranges::max_element(views, {}, &Support::decades);
  if (best.decades < kMinDecades || best.models < kModelsOfCommonView) return std::nullopt;
  for (const Support& other : views) {
    const bool is_elsewhere = std::abs(other.octaves - best.octaves) > 2 * kSizeReach ||
                              std::abs(other.off_nadir_rad - best.off_nadir_rad) > 2 * kOffNadirReach_rad;
    if (is_elsewhere && kMinRatio * other.decades > best.decades) return std::nullopt;
  }
  return FitView(matches, best, size);
}

FrameConditions ConditionsOf(const CommonView& view, const cv::Size& size) {
  FrameConditions conditions;
  conditions.vertical = MakeVertical({.yaw_rad = 0, .pitch_rad = view.off_nadir_rad - kPi / 2, .roll_rad = 0},
                                     2 * std::atan(size.width / (2 * view.focal_px)), size.width, size.height);
  conditions.height_above_ground_m = conditions.vertical->pinhole.fx * std::cos(view.off_nadir_rad) / view.pixels_per_m;
  return conditions;
}

}  // namespace victorious
