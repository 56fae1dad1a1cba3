// Shape of a window: whitened gradients (orientation histograms) of four patches that cover the window, and an exemplar
// kernel between two shapes.
// Method: the square roots of the four descriptors, concatenated, are whitened (projected onto the principal axes of
// all examples and divided by the standard deviation along each) and normalised to unit length. The kernel of two
// shapes is exp(sharpness (x.y - 1)): it is local, so that a window matches the few examples of the same viewpoint
// rather than the mean of its category.
// Source: B. Hariharan, J. Malik, D. Ramanan, "Discriminative decorrelation for clustering and classification", ECCV
// 2012 (whitened gradients); M. Aubry et al., "Seeing 3D chairs", CVPR 2014 (renderings as exemplars).
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Length of the raw shape vector: four descriptors.
inline constexpr std::size_t kRawShapeSize = 4 * kDescriptorSize;

/// Of the kernel exp(sharpness (x.y - 1)); a larger one is more local.
inline constexpr double kShapeSharpness = 3.0;

struct ShapeOptions {
  double weight = 0;
  int dimensions = 128;  ///< number of principal axes of shapes. Not a user parameter

  void ListFields(FieldList& fields);
};

/// A whitening projection. Without one, Encode returns an empty vector.
struct ShapeEncoder {
  Eigen::VectorXf mean;        ///< kRawShapeSize values
  Eigen::MatrixXf projection;  ///< dimensions x length of mean

  /// Fits the whitening. The dimension is at most the number of examples. Returns an empty encoder if options.weight is
  /// 0.
  static ShapeEncoder Learn(std::span<const FeatureSet* const> sets, const ShapeOptions& options);

  /// Length of the vector that Encode returns.
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(projection.rows()); }

  /// Returns the shape vector with unit L2 norm.
  /// @param features  dense features (DenseFeatures) of a square image
  [[nodiscard]] Eigen::VectorXf Encode(const FeatureSet& features) const;
};

/// Kernel matrix exp(kShapeSharpness (a_i.b_j - 1)): rows for the columns of `a`, columns for the columns of `b`.
[[nodiscard]] Eigen::MatrixXf CompareShapes(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b);

}  // namespace victorious
