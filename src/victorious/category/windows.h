// Windows: what is small in a frame, or one of several things, is looked for in squares of many sizes all over it. A
// grey picture and a category model in; its likeliest windows, each with its scores, out.
// Method: the picture is resampled once a size, so that a window of that size has `side_px` pixels a side; features and
// words are made once of each such picture, and a window has those that lie in it as a whole, so that it looks as its
// cut-out would. Words and shapes (shape.h) rank all windows; the first `examined` of them are scored with phrases and
// Fisher vectors, too.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/category/dense_features.h"
#include "victorious/geometry/box.h"

namespace victorious {

struct WindowOptions {
  bool enabled = false;
  int side_px = 96;
  int smallest_px = 64;
  double size_factor = 1.3;
  int step_px = 24;
  double room = 1.25;
  int examined = 60;
  double overlap = 0.2;
  int max_side_px = 1280;
  std::string none = {};
  double usual_windows = 0;

  void ListFields(FieldList& fields);
};

/// The sides of the windows that are looked at in a picture, px, rising: from smallest_px (or the picture's shorter
/// side, where that is less) to the picture's shorter side.
std::vector<double> WindowSides(const cv::Size& picture, const WindowOptions& options);

/// How many windows a picture has.
std::size_t WindowCount(const cv::Size& picture, const WindowOptions& options);

/// A window of a picture, and what it shows.
struct SeenWindow {
  Box box;                ///< px of the picture
  CategoryResult result;  ///< by CategoryMethod::kPhrases; probabilities are the lower the more windows there are
  WordedPicture picture;  ///< the window alone, side_px a side
};

/// @param model   of scoring "linear"
/// @param grey    CV_8UC1
/// @param wanted  nodes: windows are ranked by the likeliest of these
/// @return        the windows that were examined, likeliest first; windows without features are none
/// Cost: features and words of some 2.5 pictures of the size given, and 2 ms for each window that is examined.
std::vector<SeenWindow> LookThroughWindows(const CategoryModel& model, const cv::Mat& grey, const DenseOptions& dense,
                                           const WindowOptions& options, std::span<const std::size_t> wanted);

/// Whether two windows show one thing: they overlap by more than `overlap` (intersection over union), or the smaller
/// lies mostly in the larger.
bool ShowTheSame(const Box& a, const Box& b, double overlap);

}  // namespace victorious
