#include "victorious/category/linear/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "victorious/category/linear/principal_axes.h"

namespace victorious {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXf;

constexpr int kPatches = 2;   // per side
constexpr float kPatch = 12;  // side of a patch in units of the keypoint's scale: four cells of three sigma
constexpr auto kRawSize = static_cast<Index>(kRawShapeSize);

// The keypoint scale whose patch side is nearest to 0.55 of the image's shorter side; 0 without keypoints.
float PatchScale(const FeatureSet& features) {
  constexpr float kPatchFraction = 0.55F;
  const float wanted =
      kPatchFraction * static_cast<float>(std::min(features.image_width, features.image_height)) / kPatch;
  float best = 0;
  for (const Keypoint& keypoint : features.keypoints) {
    if (best == 0 || std::abs(std::log(keypoint.scale_px / wanted)) < std::abs(std::log(best / wanted)))
      best = keypoint.scale_px;
  }
  return best;
}

VectorXf RawShape(const FeatureSet& features) {
  VectorXf raw = VectorXf::Zero(kRawSize);
  const float scale = PatchScale(features);
  if (scale == 0) return raw;
  const float reach = kPatch / 2 * scale;
  const std::array<float, kPatches> xs = {reach, static_cast<float>(features.image_width) - reach};
  const std::array<float, kPatches> ys = {reach, static_cast<float>(features.image_height) - reach};
  Index at = 0;
  for (const float y : ys) {
    for (const float x : xs) {
      float nearest2 = reach * reach / 4;  // a farther keypoint is another patch: this one was omitted for low contrast
      std::size_t nearest = features.size();
      for (std::size_t i = 0; i < features.size(); ++i) {
        const Keypoint& keypoint = features.keypoints[i];
        if (keypoint.scale_px != scale) continue;
        const float distance2 = (keypoint.x - x) * (keypoint.x - x) + (keypoint.y - y) * (keypoint.y - y);
        if (distance2 >= nearest2) continue;
        nearest2 = distance2;
        nearest = i;
      }
      if (nearest < features.size()) {
        const auto descriptor = features.View().Descriptor(nearest);
        float sum = 0;
        for (const std::uint8_t value : descriptor) sum += value;
        for (std::size_t k = 0; k < kDescriptorSize; ++k)
          raw(at + static_cast<Index>(k)) = std::sqrt(static_cast<float>(descriptor[k]) / std::max(1.0F, sum));
      }
      at += static_cast<Index>(kDescriptorSize);
    }
  }
  return raw;
}

}  // namespace

void ShapeOptions::ListFields(FieldList& fields) {
  fields.Add("weight", weight,
             {.min = 0, .max = 100, .reason = "weight of the shape kernel relative to that of words; 0: no shapes"});
}

ShapeEncoder ShapeEncoder::Learn(std::span<const FeatureSet* const> sets, const ShapeOptions& options) {
  ShapeEncoder encoder;
  if (options.weight == 0) return encoder;
  MatrixXf raw(kRawSize, static_cast<Index>(sets.size()));
  for (std::size_t i = 0; i < sets.size(); ++i) raw.col(static_cast<Index>(i)) = RawShape(*sets[i]);
  const PrincipalAxes axes = FitPrincipalAxes(raw);
  encoder.mean = axes.mean;
  const Index dimensions = std::min<Index>({options.dimensions, kRawSize, raw.cols()});
  // Regularisation: a fraction of the mean variance is added, so that axes of low variance are not amplified.
  constexpr double kVarianceFloor = 0.3;
  const Eigen::VectorXd variance = axes.variance.tail(dimensions).array().max(0.0) +
                                   kVarianceFloor * axes.variance.mean() + std::numeric_limits<float>::min();
  encoder.projection = (variance.cwiseSqrt().cwiseInverse().asDiagonal() * axes.Largest(dimensions)).cast<float>();
  return encoder;
}

VectorXf ShapeEncoder::Encode(const FeatureSet& features) const {
  if (size() == 0) return {};
  VectorXf shape = projection * (RawShape(features) - mean);
  const float length = shape.norm();
  return length > 0 ? VectorXf(shape / length) : shape;
}

MatrixXf CompareShapes(const MatrixXf& a, const MatrixXf& b) {
  const MatrixXf cosines = a.transpose() * b;
  return (static_cast<float>(kShapeSharpness) * (cosines.array() - 1)).exp();
}

}  // namespace victorious
