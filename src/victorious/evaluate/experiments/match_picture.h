// Matches drawn for people: the scene and the template beside it, true matches red, false ones cyan, as in the thesis;
// those that are neither (true_matches.h) yellow.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/evaluate/experiments/match_trial.h"

namespace victorious {

/// CV_8UC3. The scene in few grey levels, so that lines stand out and the file stays small; its template at its right.
/// @param scale  of the pictures
Expected<cv::Mat> DrawMatches(const MatchTrial& trial, const MatchSet& matches, double scale,
                              const std::string& caption);

/// A grey picture as CV_8UC3, dimmed, and in few steps, so that lines stand out and PNG stores it in few bytes.
[[nodiscard]] cv::Mat Background(const cv::Mat& grey, double scale);

/// Pictures of one size side by side, `columns` a row, in reading order.
[[nodiscard]] cv::Mat Montage(const std::vector<cv::Mat>& pictures, int columns);

}  // namespace victorious
