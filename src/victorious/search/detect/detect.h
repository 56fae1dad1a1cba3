// detect/, after pose/. In: the planar fits of every view of every model. Out: detections, one per instance, with an
// outline, a box and a score.
// Neighbouring views fire on the same instance. Non-maximum suppression over the templates of a model keeps the most
// significant one and drops those whose centre lies near it or whose outline overlaps it (thesis, section 3.3.3).
//
// Significance: the number of false alarms (NFA) of the a contrario test of Moisan and Stival (IJCV 57, 2004); compare
// Lowe (CVPR 2001, section 5). With n matches of the template in the scene, k of them agreeing with the pose, and p the
// chance that a false match agrees with a given pose in position, rotation and scale:
//   NFA = views * C(n, 2) * P(at least k - 2 of n - 2 agree),   significance = -log10 NFA,
// maximised over the radius; the number of radii tried (one per inlier) is corrected for.
//   score = 1 / (1 + exp(-(-log10 NFA - kScoreMidpoint) / kScoreScale)),
// a logistic curve fitted to the precision on three movies without sun (docs/results.md, `victorious experiment
// figure-calibration`).
// A fit with its own -log10 NFA (search/pose/vote_poses.h) keeps it, minus log10 of the number of views searched.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/detection.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

/// The score's logistic curve, decades: the -log10 NFA at which the precision is one half, and the increase that raises
/// the odds by a factor of e. Fitted by `victorious experiment figure-calibration` to three movies without sun.
inline constexpr double kScoreMidpoint = 2.1;
inline constexpr double kScoreScale = 1.4;
/// A detection is suppressed if its outline and that of a better one of the same model overlap by more than this
/// fraction of the smaller area: neighbouring views localise a long object differently. Chosen.
inline constexpr double kSuppressionOverlap = 0.4;

struct DetectOptions {
  double min_score = 0.795;
  double min_side_px = 8;

  // Not user parameters from here on: the tests vary them.
  /// A detection is suppressed if its centre is nearer to that of a better one of the same model than this fraction of
  /// the smaller one's size (square root of its area).
  double suppression_fraction = 0.5;
  /// Minimum fraction of the outline's area inside the frame: a photo's corner at the frame's edge shows mostly
  /// background.
  double min_in_view = 0.5;
  /// Minimum fraction of the outline that the inliers' convex hull covers: inliers in one corner only lie mostly on
  /// background that the photo shows, too.
  double min_extent = 0.06;

  void ListFields(FieldList& fields);
};

/// A planar fit before thresholds and non-maximum suppression.
struct Candidate {
  std::size_t model_index = 0;  ///< index into the models that were searched
  std::size_t view = 0;         ///< index into that model's views
  std::size_t matches = 0;      ///< n: number of matches of this view: those of the ratio test, or the ranked ones
  std::size_t views = 1;        ///< number of views searched of the model: the number of tests in the NFA
  Polygon outline;              ///< of the object in the template, px
  PlanarFit fit;
};

struct SceneSize {
  double width_px = 0;
  double height_px = 0;
  std::optional<double> searched_px2 = {};  ///< area of the searched region; nullopt: the whole image
};

/// Models are independent: the detections of one do not depend on which others are searched.
/// @return by falling score; only scores of at least options.min_score
std::vector<Detection> Detect(std::span<const Candidate> candidates, const SceneSize& scene,
                              const DetectOptions& options);

/// The score, 0 to 1, of a -log10 NFA in decades (formula above).
double ComputeScore(double neg_log10_nfa);

/// The inverse of ComputeScore. @param score  in (0, 1)
double NegLog10NfaOf(double score);

/// -log10 NFA of `agreeing` = k of `matches` = n matches that agree with a pose (formula above), decades. Values of 0
/// or less: chance explains the pose. 0 for k < 3, k > n or chance >= 1, and if k - 2 does not exceed its expectation.
/// @param chance  p
double ComputeNegLog10Nfa(std::size_t matches, std::size_t agreeing, double chance, std::size_t views);

}  // namespace victorious
