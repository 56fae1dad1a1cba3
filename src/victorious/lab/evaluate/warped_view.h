// Novel view synthesis for the detectability test (detectability.h): the appearance of a CAD model from a direction
// between its views, or of a photo that is turned. The test must not use the images that the model was built from, and
// it needs neither the CAD file nor the photos.
//
// Method for CAD models: depth-image-based rendering. The nearest view's stored rendering (grey image and depth) is
// relit if a sun is given, then forward-warped by 3 x 3 splats per pixel with a depth test; small gaps take the mean of
// their neighbours.
#pragma once

#include <cstddef>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct WarpedView {
  cv::Mat grey;  ///< CV_8UC1
  cv::Mat mask;  ///< CV_8UC1, 255 on the object
};

/// Renders the object from `direction` by warping its nearest view. Surfaces that the nearest view does not show stay
/// missing in the mask.
/// @param model  every view must have angles and a surface
/// @param sun    direction to the sun in the model's frame; std::nullopt: the light of the model's own renderings
/// Errors: kDataLoss for a damaged surface; kInvalidArgument for unknown options stored in the model.
[[nodiscard]] Expected<WarpedView> WarpView(const ObjectModel& model, const ViewDirection& direction,
                                            const std::optional<ViewDirection>& sun);

/// Renders a photo of the object as a plane seen from afar, turned out of the image by `turned_rad` about an axis in
/// the image at `axis_rad` from +x towards +y. The photo is the thumbnail that the model stores, of at most 160 px.
/// @param photo  index of the view
/// Error: kDataLoss for a damaged thumbnail or outline.
[[nodiscard]] Expected<WarpedView> WarpPhoto(const ObjectModel& model, std::size_t photo, double turned_rad,
                                             double axis_rad);

}  // namespace victorious
