// recognize/, once a pose is guessed: does the scene look there as the view does? Paint too faint and too plain for
// keypoints, and an object's large patches of light and dark, tell it still.
//
// The likeness of a pose is atanh(r), r the correlation between how bright the view shows the object's points
// (types/lit_templates.h) and how bright the scene is where the pose puts them: contrast does not count, its sign does.
// A guess is first improved, by steps in place, scale, turn and direction of view, from the view that matched and from
// those beside it. How much its likeness L says is
// measured in the scene itself: the same is done from guesses at random places and turns, of mean m and deviation s,
//   sigmas = (L - m) / s,   evidence += decades_per_sigma (sigmas - even_sigmas).
// The two constants are those of the logistic curve of both that fits what is right and wrong in three movies
// (docs/results.md, "Tried for recall"); the scale of the evidence, and so of the score, stays what it was.
#pragma once

#include <cstddef>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "victorious/base/options.h"
#include "victorious/geometry/similarity.h"
#include "victorious/types/lit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct LikenessOptions {
  int most = 2;
  int most_in_frame = 12;
  double least_evidence = -2.0;
  double most_evidence = 6.0;
  int elsewhere = 40;
  double decades_per_sigma = 2.0;
  double even_sigmas = 2.3;
  double impulse_share = 0.015;

  void ListFields(FieldList& fields);
};

/// A scene made ready to be looked at.
/// @param grey  CV_8UC1
/// @return CV_32FC1, of the same size: without impulses, blurred by kPictureBlur_px
[[nodiscard]] cv::Mat SceneForLikeness(const cv::Mat& grey, const LikenessOptions& options);

/// By how many sigmas the scene looks more like the object at a pose than elsewhere (above). Deterministic.
/// @param scene                SceneForLikeness()
/// @param pictures             of the model
/// @param scene_from_template  the guess, of the pixels of the model's `view`
/// Nothing where that cannot be told: little of the object is in the frame or away from its rim, or there is no other
/// place for it.
/// Cost: some 15 ms.
[[nodiscard]] std::optional<double> SigmasOfLikeness(const cv::Mat& scene, const ObjectModel& model,
                                                     const LitTemplates& pictures, std::size_t view,
                                                     const Similarity2& scene_from_template,
                                                     const LikenessOptions& options);

}  // namespace victorious
