// Solves target = scale * R * source + translation for 2 or more weighted point pairs, by linear least squares. With
// points as complex numbers, target = a source + b is linear: a = sum w conj(s') t' / sum w |s'|^2 over centred points
// (Umeyama 1991, the planar case without reflection).
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/geometry/similarity.h"

namespace victorious {

struct PointPair {
  Eigen::Vector2d source;  ///< px
  Eigen::Vector2d target;  ///< px
};

/// Solves for the similarity.
/// @param weights  one per pair, >= 0; empty: all 1
/// @return std::nullopt if all sources, or all targets, coincide
std::optional<Similarity2> SolveSimilarity(std::span<const PointPair> pairs, std::span<const double> weights = {});

}  // namespace victorious
