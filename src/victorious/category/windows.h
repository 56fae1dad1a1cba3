// Sliding-window classification, for objects that are small in the image or occur several times: square windows of many
// sizes over the whole image. Input: a grey image and a category model. Output: the windows of the highest scores.
// Method: the image is resampled once per window size to `side_px` pixels per window side. Features and words are
// computed once per resampled image; a window contains those whose patches lie entirely inside, so that its score
// equals that of its crop. Words and shapes (shape.h) rank all windows; the best kMaxRescoredWindows windows are
// rescored with phrases and Fisher vectors.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/category/common/dense_features.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// Ratio of successive window sizes.
inline constexpr double kWindowSizeFactor = 1.3;
/// Step between windows in steps of the grid of features, so that windows of one size share their features.
inline constexpr int kWindowStepGridPoints = 3;
/// Side of a window relative to the longer side of the object's box: a margin for its surroundings.
inline constexpr double kWindowContextFactor = 1.25;
/// Windows per image that are rescored with phrases and Fisher vectors: the best by words and shapes. Bounds the time:
/// 2 ms each.
inline constexpr int kMaxRescoredWindows = 60;
/// Non-maximum suppression: of windows with a greater intersection over union only the most probable is kept.
inline constexpr double kMaxWindowOverlap = 0.2;

struct WindowOptions {
  bool enabled = false;
  int side_px = 96;
  int min_window_px = 64;
  int max_side_px = 1280;

  void ListFields(FieldList& fields);
};

/// Returns the window sides for an image, px, increasing: from min_window_px (or the image's shorter side if that is
/// smaller) to the image's shorter side.
std::vector<double> WindowSides(const cv::Size& image, const WindowOptions& options);

/// Returns the number of windows in an image, over all sizes.
/// @param grid_step_px  DenseOptions::step_px
std::size_t WindowCount(const cv::Size& image, int grid_step_px, const WindowOptions& options);

/// A window with its classification.
struct ScoredWindow {
  Box box;                ///< px of the input image
  CategoryResult result;  ///< by CategoryMethod::kPhrases; probabilities are corrected for the number of windows
  QuantisedImage image;   ///< words of the crop, in an image of side_px x side_px
};

/// Classifies all windows of an image.
/// @param model   a linear classifier; its WindowTraining corrects the probabilities
/// @param grey    CV_8UC1
/// @param wanted  node indices; windows are ranked by the most probable of these
/// @return        the rescored windows by decreasing probability; windows without features are omitted
/// Cost: features and words of about 2.5 images of the given size, and 2 ms per rescored window.
std::vector<ScoredWindow> ClassifyWindows(const CategoryModel& model, const cv::Mat& grey, const DenseOptions& dense,
                                          const WindowOptions& options, std::span<const std::size_t> wanted);

/// Returns true if two windows show the same object: their intersection over union exceeds kMaxWindowOverlap, or more
/// than 60 % of the smaller lies in the larger. For non-maximum suppression.
bool IsSameObject(const Box& a, const Box& b);

}  // namespace victorious
