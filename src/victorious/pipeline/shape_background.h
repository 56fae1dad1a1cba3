// pipeline/, the background of a video for the search by shape (recognize/shape_search.h): gradient cells of a few of
// its frames.
#pragma once

#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/shape/gradient_cells.h"

namespace victorious {

/// Cells of four frames, evenly spread over the video, at several scales. The same for each part of a video that is
/// searched apart. Empty if no frame can be read: the search of the same video reports why.
/// @param video             path
/// @param duration_s        of the video; frames of an unknown duration are taken from its beginning
/// @param impulse_fraction  as FeatureOptions::impulse_fraction
/// Error: kCancelled. Cost: four seeks, and what lies between a key frame and each frame; where key frames are rare,
/// the video is decoded once.
[[nodiscard]] Expected<std::vector<GradientCells>> ReadBackground(const std::string& video, double duration_s,
                                                                  double impulse_fraction, const CancelToken& cancel);

}  // namespace victorious
