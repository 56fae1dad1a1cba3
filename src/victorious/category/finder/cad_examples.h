// Training examples of a category from a CAD model: renderings from random directions, composited over background
// images. Method (domain randomisation): diffuse light or a sun with self-shadowing; random gain, since objects of one
// category differ in paint; the object fills 60 to 95 % of the background image.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/finder/window_training.h"
#include "victorious/types/mesh.h"

namespace victorious {

struct CadExampleOptions {
  int views = 25;
  double min_off_nadir_deg = 60.0;
  double max_off_nadir_deg = 100.0;

  void ListFields(FieldList& fields);
};

/// Errors: kInvalidArgument if the minimum off-nadir angle exceeds the maximum.
[[nodiscard]] Status CheckRange(const CadExampleOptions& options);

/// Reduces a background image to at most 1.5 times the size of the renderings, so that both are equally sharp.
[[nodiscard]] cv::Mat ResizeBackgroundForCad(const cv::Mat& grey);

/// @param backgrounds  CV_8UC1, at least one
/// @return             labelled images of `category`, of the backgrounds' sizes, each with the object's box; views that
///                     show no pixel of the mesh are left out
/// Errors: kInvalidArgument for options out of range; kInternal if no renderer is available.
[[nodiscard]] Expected<std::vector<LabelledImage>> RenderCadExamples(const Mesh& mesh, const std::string& category,
                                                                     std::span<const cv::Mat> backgrounds,
                                                                     const CadExampleOptions& options,
                                                                     std::uint64_t seed);

}  // namespace victorious
