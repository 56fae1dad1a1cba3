// Sliding-window classification, for objects that are small in the image or occur several times: square windows of many
// sizes over the whole image. Input: a grey image and a category model. Output: the windows of the highest scores.
// Method: the image is resampled once per window size to `side_px` pixels per window side. Features and words are
// computed once per resampled image; a window contains those whose patches lie entirely inside, so that its score
// equals that of its crop. Words and shapes (shape.h) rank all windows; the best `max_rescored` windows are rescored
// with phrases and Fisher vectors.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/category/common/dense_features.h"
#include "victorious/geometry/box.h"

namespace victorious {

struct WindowOptions {
  bool enabled = false;
  int side_px = 96;
  int min_window_px = 64;
  double size_factor = 1.3;
  int step_px = 24;
  double context_factor = 1.25;
  int max_rescored = 60;
  double overlap = 0.2;
  int max_side_px = 1280;
  std::string background_category = {};
  double calibration_windows = 0;

  void ListFields(FieldList& fields);
};

/// Returns the window sides for an image, px, increasing: from min_window_px (or the image's shorter side if that is
/// smaller) to the image's shorter side.
std::vector<double> WindowSides(const cv::Size& picture, const WindowOptions& options);

/// Returns the number of windows in an image, over all sizes.
std::size_t WindowCount(const cv::Size& picture, const WindowOptions& options);

/// A window with its classification.
struct ScoredWindow {
  Box box;                 ///< px of the input image
  CategoryResult result;   ///< by CategoryMethod::kPhrases; probabilities are corrected for the number of windows
  QuantisedImage picture;  ///< words of the crop, in an image of side_px x side_px
};

/// Classifies all windows of an image.
/// @param model   with scoring "linear"
/// @param grey    CV_8UC1
/// @param wanted  node indices; windows are ranked by the most probable of these
/// @return        the rescored windows by decreasing probability; windows without features are omitted
/// Cost: features and words of about 2.5 images of the given size, and 2 ms per rescored window.
std::vector<ScoredWindow> ClassifyWindows(const CategoryModel& model, const cv::Mat& grey, const DenseOptions& dense,
                                          const WindowOptions& options, std::span<const std::size_t> wanted);

/// Returns true if two windows show the same object: their intersection over union exceeds `overlap`, or more than 60 %
/// of the smaller lies in the larger. For non-maximum suppression.
bool IsSameObject(const Box& a, const Box& b, double overlap);

}  // namespace victorious
