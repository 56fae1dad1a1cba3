// Solves target = scale * R * source + translation for 2 or more weighted point pairs, in the least-squares sense.
// With points as complex numbers, target = a source + b is linear: a = sum w conj(s') t' / sum w |s'|^2 over centred
// points (Umeyama 1991, the plane's case without reflection).
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

/// @param weights  one a pair, >= 0; empty: all 1
/// @return nothing if the sources, or the targets, lie at one point
std::optional<Similarity2> SolveSimilarity(std::span<const PointPair> pairs, std::span<const double> weights = {});

}  // namespace victorious
