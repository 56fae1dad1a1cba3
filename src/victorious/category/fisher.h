// Fisher vectors: what a picture's descriptors are like, and where in the picture which kind of them lies, beyond how
// many there are of each kind. Features in, one dense vector of fixed length out.
// Method: descriptors (their roots) are projected onto their principal axes, the keypoint's place in the picture is
// appended, and a mixture of Gaussians with diagonal covariances is fitted to all of them. For each Gaussian k with
// share w_k, mean m_k and deviations s_k, and each feature x of posterior p_k,
//
//   first  = sum p_k (x - m_k) / s_k / sqrt(w_k),   second = sum p_k ((x - m_k)^2 / s_k^2 - 1) / sqrt(2 w_k),
//
// of which the signed square roots are taken, at unit length.
// Source: F. Perronnin, J. Sanchez, T. Mensink, "Improving the Fisher kernel for large-scale image classification",
// ECCV 2010; places: J. Sanchez, F. Perronnin, T. de Campos, "Modeling the spatial layout of images beyond spatial
// pyramids", PRL 33, 2012.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"

namespace victorious {

struct FisherOptions {
  int components = 128;
  int dimensions = 48;
  bool places = true;
  int samples = 40000;
  int iterations = 15;
  double weight = 4.0;

  void ListFields(FieldList& fields);
};

/// A projection and a mixture of Gaussians; without components it encodes nothing.
struct FisherEncoder {
  Eigen::VectorXf mean;        ///< of the descriptors' roots, 128
  Eigen::MatrixXf projection;  ///< dimensions x 128, of unit rows
  bool places = false;         ///< whether x / width and y / height follow the projected descriptor
  Eigen::VectorXf share;       ///< one a component, above 0; they sum to 1
  Eigen::MatrixXf centre;      ///< values of a feature x components
  Eigen::MatrixXf deviation;   ///< the same, above 0

  /// Fits to `options.samples` features, drawn by seed. Fewer features than components give fewer components.
  static FisherEncoder Learn(std::span<const FeatureSet* const> sets, const FisherOptions& options, std::uint64_t seed);

  /// Length of what Encode returns.
  [[nodiscard]] std::size_t size() const { return 2 * static_cast<std::size_t>(centre.size()); }

  /// Of unit length; zeros of a picture without features. Cost: some 5 ms for 2000 features at the default.
  [[nodiscard]] Eigen::VectorXf Encode(const FeatureSet& features) const;
};

}  // namespace victorious
