// detect/, in: the poses of every view of every model. Out: detections: an outline, a box, a score; one an instance.
// Neighbouring views see the same instance too: the best supported is kept, and every other of the model whose centre
// falls near it is dropped (non-maximum suppression over templates; thesis, section 3.3.3), as is every other that
// covers much of it.
//
// The score comes from the expected number of poses as good as this one by chance (the a-contrario test of Moisan and
// Stival, IJCV 57, 2004; the same question as Lowe's, CVPR 2001, section 5). With n matches of the template in the
// scene, k of them agreeing, p the chance that a wrong match agrees with a given pose in place, turn and scale:
//   expected = views * C(n, 2) * P(at least k - 2 of n - 2 agree),   evidence = -log10(expected),
// at the radius, of as many as there are inliers, at which that is least.
// score = 1 / (1 + exp(-(evidence - even) / scale)), with a curve fitted to the share that is right on three
// movies without a sun (docs/results.md, `victorious experiment figure-calibration`).
// A pose that carries its own evidence (pose/vote_poses.h) keeps it, less the number of views searched.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/detection.h"
#include "victorious/types/pose.h"

namespace victorious {

struct DetectOptions {
  double suppression_fraction = 0.5;
  double suppression_overlap = 0.4;
  double even_evidence = 2.1;
  double evidence_scale = 1.4;
  double least_score = 0.795;
  double least_side_px = 8;
  double least_in_view = 0.5;
  double least_extent = 0.06;

  void ListFields(FieldList& fields);
};

/// A pose that may be a detection.
struct Candidate {
  std::size_t model = 0;
  std::size_t view = 0;
  std::size_t matches = 0;  ///< n: of this view, after the ratio test
  std::size_t views = 1;    ///< of its model: more views, more chances to be fooled
  Polygon outline;          ///< of the object in the template, px
  Pose pose;
};

struct SceneSize {
  double width_px = 0;
  double height_px = 0;
  std::optional<double> searched_px2 = {};  ///< over which a wrong match may lie; nothing: all of it
};

/// What is found of a model does not depend on which others are searched for.
/// @return best first; only those of a score of at least options.least_score
std::vector<Detection> Detect(std::span<const Candidate> candidates, const SceneSize& scene,
                              const DetectOptions& options);

/// A detection's score, 0 to 1 (above).
double ScoreOf(double evidence, const DetectOptions& options);

/// The evidence of k of n matches agreeing on a pose (above). 0 or less: chance explains it.
double Evidence(std::size_t matches, std::size_t agreeing, double chance, std::size_t views);

}  // namespace victorious
