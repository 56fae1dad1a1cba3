// recognize/, after VoteSearch and Detect: rescores an uncertain detection by direct image comparison. Uses image
// content that yields no keypoints: low-contrast paint and large light and dark regions.
//
// The NCC score of a pose is the Fisher transform L = atanh(r) of the normalised cross-correlation r between the
// rendered brightness of the object's surface points (object/features/relit_templates.h) and the scene's brightness at
// their projections (weak perspective): invariant to contrast, but not to its sign. The pose is refined by
// coordinate-wise hill climbing over position, scale, in-plane rotation, yaw and tip, from the matched view and its
// neighbours of the same off-nadir angle; L is the maximum. The null distribution is measured in the scene: the same
// refinement from random positions and rotations has mean m and standard deviation s,
//   z = (L - m) / s,   -log10 NFA += decades_per_z_score (z - neutral_z_score).
// The two constants come from a logistic regression of true and false detections on both quantities in three movies
// (docs/adr/0014-ncc-rescoring.md), scaled so that the mapping from -log10 NFA to the score stays unchanged.
#pragma once

#include <cstddef>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/similarity.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Not user parameters: the tests vary them.
struct NccOptions {
  int max_poses = 2;                 ///< rescored poses per model and frame, best first; 0: none
  int max_poses_per_frame = 12;      ///< rescored poses per frame, over all models: bounds the time
  double min_neg_log10_nfa = -2.0;   ///< decades, at most the next one; below it hardly any pose is true
  double max_neg_log10_nfa = 6.0;    ///< decades; above it a pose is certain, also if partly occluded
  double decades_per_z_score = 2.0;  ///< increase of -log10 NFA per unit of z; fitted as said above
  double neutral_z_score = 2.3;      ///< z that leaves the -log10 NFA unchanged; fitted as said above
};

/// Prepares a scene for NCC: blurs by kAppearanceBlur_px.
/// @param grey  CV_8UC1, without impulse noise
/// @return CV_32FC1 of the same size
[[nodiscard]] cv::Mat PrepareSceneForNcc(const cv::Mat& grey);

/// The z-score of the NCC score at a pose against random poses in the same scene (formula above). Deterministic.
/// @param scene                from PrepareSceneForNcc()
/// @param appearances          surface samples of the model's views
/// @param view                 index of the matched view
/// @param scene_from_template  initial pose, from pixels of `view` to pixels of the scene
/// @return std::nullopt if less than 40 % of the surface samples are in the frame, if the view has no surface samples,
///         or if fewer than half of the random poses can be evaluated
/// Errors: those of RelitTemplateSource.
/// Cost: about 15 ms.
[[nodiscard]] Expected<std::optional<double>> ComputeNccZScore(const cv::Mat& scene, const ObjectModel& model,
                                                               const RelitTemplateSource& appearances, std::size_t view,
                                                               const Similarity2& scene_from_template);

}  // namespace victorious
