// Estimator of a similarity from point pairs, for MLESAC (mlesac.h).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// The maximum residual, in units of SigmaPx, of a match that agrees with a similarity.
inline constexpr double kAgreementSigmas = 2.5;

/// The maximum differences in rotation (rad) and scale (factor) between a match and the similarity; and the probability
/// that both of an outlier at that position lie within them: the rotation of an outlier is uniform, and its scale is
/// seldom within the factor.
inline constexpr double kAgreementRotationRad = 0.5;
inline constexpr double kAgreementScale = 1.7;
inline constexpr double kAgreementRotationScaleProbability = 0.1;

class SimilarityEstimator {
 public:
  using Model = Similarity2;
  static constexpr std::size_t kSampleSize = 2;

  /// The standard deviation of an inlier's residual. The localisation error of keypoints grows with magnification; and
  /// the object is not a planar image seen frontally, so that the similarity model itself is wrong by a fraction of the
  /// object's size. The two standard deviations add in quadrature.
  struct Noise {
    double noise_px = 1.5;  ///< of a keypoint's position: in the scene at scale 1 or below, in the template above
    double shape_px = 0.0;  ///< of the similarity model, in template pixels
  };

  /// The pairs (template to scene, px) must outlive the estimator.
  SimilarityEstimator(std::span<const PointPair> pairs, const Noise& noise) : pairs_(pairs), noise_(noise) {}

  [[nodiscard]] std::size_t size() const { return pairs_.size(); }

  [[nodiscard]] std::optional<Similarity2> FromSample(std::span<const std::uint32_t> sample) const {
    const PointPair& a = pairs_[sample[0]];
    const PointPair& b = pairs_[sample[1]];
    // Points closer than their own noise do not determine a rotation.
    const double min_distance2_px2 = 4 * noise_.noise_px * noise_.noise_px;
    if ((a.source - b.source).squaredNorm() < min_distance2_px2 ||
        (a.target - b.target).squaredNorm() < min_distance2_px2)
      return std::nullopt;
    const PointPair both[] = {a, b};
    return SolveSimilarity(both);
  }

  void SquaredResiduals(const Similarity2& model, std::span<double> out) const {
    const Eigen::Matrix2d linear = model.Linear();
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      out[i] = (linear * pairs_[i].source + model.translation - pairs_[i].target).squaredNorm();
    }
  }

  [[nodiscard]] double SigmaPx(const Similarity2& model) const {
    return std::hypot(noise_.noise_px * std::max(1.0, model.scale), noise_.shape_px * model.scale);
  }

  [[nodiscard]] std::optional<Similarity2> FromWeights(std::span<const double> weights) const {
    return SolveSimilarity(pairs_, weights);
  }

 private:
  std::span<const PointPair> pairs_;
  Noise noise_;
};

}  // namespace victorious
