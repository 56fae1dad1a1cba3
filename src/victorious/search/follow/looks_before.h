// Track before detect: what the frames before say of a match by shape that one frame alone does not decide.
//
// A vehicle in one colour, small or in noise, is often weak in every frame; a corner of a roof that looks like one is
// strong in some frame and no longer once the view has changed. Each match is followed back through the frames before,
// as the objects that start a track are (backward_follower.h), and searched for where it is tracked to. Only frames
// between which the image has moved are looked at: what did not move looks the same again, whatever it is.
#pragma once

#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/similarity.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/follow/backward_follower.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// The motion of the image between two looks at least (FractionMoved), and how many there are at most.
inline constexpr double kMotionBetweenLooks = 0.04;
inline constexpr int kMaxLooksBefore = 8;
/// With fewer looks, one frame decides: over some hundredths of the diagonal, parts of buildings stay what they look
/// like (docs/adr/0050).
inline constexpr int kMinLooksBefore = 4;
/// The -log10 NFA of a look at a place that shows nothing of the model, decades; found again, it has at least
/// kMinDecadesInOnePlace.
inline constexpr double kDecadesWhereMissed = 1;

struct FrameBefore {
  const FollowedFrame* seen = nullptr;
  Similarity2 then_from_now;  ///< motion of the image that is searched, px
};

/// The looks at one match in the frames before, and in the frame itself.
struct LooksBefore {
  int looks = 0;              ///< before, with all of its outline in the frame
  double sum = 0;             ///< of their -log10 NFA, decades, each of one place (ShapeSearch::FindAgain)
  bool is_explained = false;  ///< not looked for: the last frame shows it, or another model there with more evidence

  /// -log10 NFA of the match by all looks, as one of them: their mean, together with the frame itself.
  /// @param neg_log10_nfa  of the match in the whole frame, decades
  [[nodiscard]] double NegLog10Nfa(double neg_log10_nfa) const {
    return (neg_log10_nfa + kDecadesOfOnePlace + sum) / (1 + looks);
  }
};

/// Looks for detections by shape of `now` in the frames before, unless the last one explains them. Deterministic.
/// @param features    of the full-frame search of `now`
/// @param before      the frames before `now`, the nearest first, without gaps
/// @return one for each detection
/// Errors: those of feature extraction and of ShapeSearch::FindAgain.
[[nodiscard]] Expected<std::vector<LooksBefore>> LookBefore(
    const Recognizer& recognizer, const FeatureExtractor& extractor, const FollowOptions& options,
    const FollowedFrame& now, const FeatureSet& features, std::span<const Detection> detections,
    std::span<const FrameBefore> before, const ShapeSearch& shapes);

/// Follows matches by shape of an earlier frame to the last of `since`, and searches for them there: what a search of
/// the whole frame may miss. Deterministic.
/// @param earlier   without descriptors
/// @param since     all frames after `then`, in order
/// @return what is found, with the -log10 NFA of a match in a whole frame
/// Errors: as of LookBefore.
[[nodiscard]] Expected<std::vector<ShapeMatch>> FindFurtherOn(const Recognizer& recognizer,
                                                              const FeatureExtractor& extractor, FollowOptions options,
                                                              const FollowedFrame& then, const FullFrameResult& earlier,
                                                              std::span<const FollowedFrame* const> since,
                                                              const ShapeSearch& shapes);

}  // namespace victorious
