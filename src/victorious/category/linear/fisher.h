// Fisher vectors: encode the distribution of an image's descriptors and of their positions beyond word counts. Input: a
// feature set. Output: a dense vector of fixed length.
// Method: descriptors (their square roots, RootSIFT) are projected onto their principal axes, the keypoint's relative
// position in the image is appended, and a Gaussian mixture with diagonal covariances is fitted to a sample of them.
// For Gaussian k with weight w_k, mean m_k and standard deviations s_k, and features x with posterior p_k,
//
//   first  = sum p_k (x - m_k) / s_k / sqrt(w_k),   second = sum p_k ((x - m_k)^2 / s_k^2 - 1) / sqrt(2 w_k),
//
// followed by the signed square root and L2 normalisation.
// Source: F. Perronnin, J. Sanchez, T. Mensink, "Improving the Fisher kernel for large-scale image classification",
// ECCV 2010; positions: J. Sanchez, F. Perronnin, T. de Campos, "Modeling the spatial layout of images beyond spatial
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
  int dimensions = 48;          ///< number of principal axes of the descriptors. Not a user parameter
  bool append_position = true;  ///< append the relative position in the image to a descriptor. Not a user parameter
  int samples = 40000;          ///< features sampled for training, by seed. Not a user parameter
  int iterations = 15;          ///< iterations of expectation-maximisation. Not a user parameter
  double weight = 4.0;

  void ListFields(FieldList& fields);
};

/// A PCA projection and a Gaussian mixture. Without components, Encode returns an empty vector.
struct FisherEncoder {
  Eigen::VectorXf mean;            ///< mean of the descriptors' square roots, 128 values
  Eigen::MatrixXf projection;      ///< principal axes, dimensions x 128, rows of unit length
  bool append_position = false;    ///< true if x / width and y / height are appended to the projected descriptor
  Eigen::VectorXf mixture_weight;  ///< mixture weights, one per component, positive, sum 1
  Eigen::MatrixXf centre;          ///< means, values of a feature x components
  Eigen::MatrixXf deviation;       ///< standard deviations, values of a feature x components, positive

  /// Fits projection and mixture to `options.samples` features, sampled by seed. The number of components is at most
  /// the number of features.
  /// @pre options.components is 0 or the sets contain at least one feature
  static FisherEncoder Learn(std::span<const FeatureSet* const> sets, const FisherOptions& options, std::uint64_t seed);

  /// Length of the vector that Encode returns.
  [[nodiscard]] std::size_t size() const { return 2 * static_cast<std::size_t>(centre.size()); }

  /// Returns the Fisher vector with unit L2 norm, or zeros for an image without features.
  /// Cost: about 5 ms for 2000 features with the defaults.
  [[nodiscard]] Eigen::VectorXf Encode(const FeatureSet& features) const;
};

}  // namespace victorious
