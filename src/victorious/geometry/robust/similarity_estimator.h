// MLESAC's estimator for the plane's similarity from point pairs (robust/mlesac.h).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "victorious/geometry/solvers/similarity.h"

namespace victorious {

/// How far, in the deviations that SigmaPx gives, a match that agrees with a similarity may lie from its place.
inline constexpr double kAgreementSigmas = 2.5;

/// How far a match's turn and scale may differ from the similarity's; and how often those of a wrong match that lies
/// there differ by no more: turns are anything, and scales seldom within a factor.
inline constexpr double kAgreementTurn_rad = 0.5;
inline constexpr double kAgreementScale = 1.7;
inline constexpr double kAgreementTurnAndScaleChance = 0.1;

class SimilarityEstimator {
 public:
  using Model = Similarity2;
  static constexpr std::size_t kSampleSize = 2;

  /// How far a true match may lie from where the similarity puts it. Keypoints are placed with an error that grows with
  /// magnification; and the object is no flat picture seen at right angles, so that the similarity itself is wrong by a
  /// share of the object's size. Both deviations add in quadrature.
  struct Noise {
    double noise_px = 1.5;  ///< of a keypoint's place, in the scene at scale 1 or below, in the template above
    double shape_px = 0.0;  ///< of the similarity, in template pixels
  };

  /// The pairs (template to scene, px) must outlive the estimator.
  SimilarityEstimator(std::span<const PointPair> pairs, const Noise& noise) : pairs_(pairs), noise_(noise) {}

  [[nodiscard]] std::size_t size() const { return pairs_.size(); }

  [[nodiscard]] std::optional<Similarity2> FromSample(std::span<const std::uint32_t> sample) const {
    const PointPair& a = pairs_[sample[0]];
    const PointPair& b = pairs_[sample[1]];
    // Points nearer than their own noise fix no direction.
    const double least2 = 4 * noise_.noise_px * noise_.noise_px;
    if ((a.source - b.source).squaredNorm() < least2 || (a.target - b.target).squaredNorm() < least2)
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
