// The shape of a window: where in it gradients run in which direction, as four patches tell that share it out. Two
// windows are alike in shape where, of what tells windows apart, the same is strong and weak in both.
// Method: the roots of the four descriptors, one below the other, are whitened (projected onto the principal axes of
// all examples' and divided by the deviation along each) and taken at unit length. Two pictures compare as
// exp(sharpness (x.y - 1)): a picture is like the few examples that are seen from the same side as it is, whatever it
// has in common with the rest of its category.
// Source: B. Hariharan, J. Malik, D. Ramanan, "Discriminative decorrelation for clustering and classification", ECCV
// 2012 (whitened gradients); M. Aubry et al., "Seeing 3D chairs", CVPR 2014 (renderings as exemplars).
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Values of four descriptors.
inline constexpr std::size_t kRawShapeSize = 4 * kDescriptorSize;

struct ShapeOptions {
  double weight = 0;
  int dimensions = 128;
  double sharpness = 3.0;

  void ListFields(FieldList& fields);
};

/// A projection that whitens; without one it encodes nothing.
struct ShapeEncoder {
  Eigen::VectorXf mean;
  Eigen::MatrixXf projection;  ///< dimensions x length of mean

  /// Fewer examples than dimensions give fewer dimensions. Nothing where options.weight is 0.
  static ShapeEncoder Learn(std::span<const FeatureSet* const> sets, const ShapeOptions& options);

  /// Length of what Encode returns.
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(projection.rows()); }

  /// Of unit length, of square pictures' features on a grid (DenseFeatures).
  [[nodiscard]] Eigen::VectorXf Encode(const FeatureSet& features) const;
};

/// How alike shapes are: a row a column of `a`, a column a column of `b`.
[[nodiscard]] Eigen::MatrixXf CompareShapes(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b, double sharpness);

}  // namespace victorious
