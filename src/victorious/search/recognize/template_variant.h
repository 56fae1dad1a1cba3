// recognize/, for VoteSearch and EstimateSun: which views of a model a scene may show, and each view's template under
// diffuse light or under a sun.
//
// Angles. A view's azimuth is that of its camera in the model frame (ViewDirection). The sun's azimuth is either
// relative to the viewing direction (FrameConditions::relative_sun), or in the model frame as ViewDirection: an object
// that is seen from azimuth a has the relative sun s at a + pi + s.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "victorious/geometry/sun.h"
#include "victorious/search/recognize/azimuth_cells.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A template to match: a view under diffuse light, or relit by a sun in the direction of another view's camera.
struct TemplateVariant {
  std::size_t view;
  std::optional<std::size_t> sun_view;  ///< nullopt: diffuse light
  std::optional<double> relative_azimuth_rad =
      {};                        ///< centre of the azimuth cell that this sun is valid for; nullopt: any
  bool half_resolution = false;  ///< half resolution, as in RelitTemplateKey
};

/// For each view: true if the scene may show it: it has features, and its off-nadir angle fits the lines of sight.
/// @param max_tilt_rad  VoteSearchOptions::max_tilt_rad
[[nodiscard]] std::vector<bool> ChooseViews(const ObjectModel& model, const AzimuthCells& cells, double max_tilt_rad);

/// The coarse views: a maximal independent set of the chosen views in the neighbour graph (greedy). Every chosen view
/// is a coarse view or the neighbour of one.
[[nodiscard]] std::vector<std::size_t> ChooseCoarseViews(const ObjectModel& model, const std::vector<bool>& chosen);

/// True if the view is oblique enough to determine the object's heading, and with it the sun in the model frame.
[[nodiscard]] bool HasObservableHeading(const ModelView& view);

/// The view whose camera direction is nearest to the sun's direction: quantises the sun.
/// @param azimuth_rad  of the sun in the model frame
[[nodiscard]] std::size_t NearestViewToSun(const ObjectModel& model, double azimuth_rad, double elevation_rad);

/// The sun's azimuth in the model frame, for an object seen from view_azimuth_rad: the inverse of RelativeSunAzimuth.
[[nodiscard]] double SunAzimuthInModel(double view_azimuth_rad, double relative_sun_azimuth_rad);

/// The sun's azimuth relative to the viewing direction, (-pi, pi], for an object seen from view_azimuth_rad.
/// @param sun_in_model_rad  the sun's azimuth in the model frame
[[nodiscard]] double RelativeSunAzimuth(double view_azimuth_rad, double sun_in_model_rad);

/// The relit template of a view for an azimuth cell: the sun's azimuth in the model's frame, quantised to sun_step_rad.
/// @param sun  relative to the viewing direction through the image centre
[[nodiscard]] TemplateVariant MakeRelitVariant(const ObjectModel& model, std::size_t view, double relative_azimuth_rad,
                                               const Sun& sun, double sun_step_rad);

}  // namespace victorious
