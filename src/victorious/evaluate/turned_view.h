// What a CAD model looks like from between its views: a view's rendering, of which the model keeps picture and depth,
// lit and turned a few degrees. So that no test of a model shows it the very pictures that it was made of, and none
// needs the CAD file.
#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/render/view_sphere.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct TurnedView {
  cv::Mat grey;  ///< CV_8UC1
  cv::Mat mask;  ///< CV_8UC1, 255 where the object is
};

/// The object from `direction`, turned from its nearest view: pixel by pixel, each at its place on the object; small
/// gaps take what is around them, what the view does not show stays missing.
/// @param model  every view has angles and a surface
/// @param sun    where it stands, in the model's frame; none: the light that the model was drawn in
/// Errors: kDataLoss for a damaged surface; kInvalidArgument for options in the model that this version does not know.
Expected<TurnedView> TurnView(const ObjectModel& model, const ViewDirection& direction,
                              const std::optional<ViewDirection>& sun);

}  // namespace victorious
