// Draws matches for the figures: the scene with the template at its right. True matches are red and false ones cyan, as
// in the thesis; near ones, which are neither (true_matches.h), are yellow.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "experiments/match_trial.h"

namespace victorious {

/// Returns the drawing, CV_8UC3, over posterised images.
/// @param scale  of the images
/// Error: kDataLoss for a damaged surface of the template's view.
[[nodiscard]] Expected<cv::Mat> DrawMatches(const MatchTrial& trial, const MatchSet& matches, double scale,
                                            const std::string& caption);

}  // namespace victorious
