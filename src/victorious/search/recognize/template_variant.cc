#include "victorious/search/recognize/template_variant.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Of the rings of views every 10 degrees that `model add` makes by default, leaves out those at 0 and 10 degrees off
// nadir: from there no view determines how the object is turned (ADR 0010).
constexpr double kMinHeadingOffNadir_rad = 0.3;

}  // namespace

double SunAzimuthInModel(double view_azimuth_rad, double relative_sun_azimuth_rad) {
  return view_azimuth_rad + kPi + relative_sun_azimuth_rad;
}

std::vector<bool> ChooseViews(const ObjectModel& model, const AzimuthCells& cells, double max_tilt_rad) {
  const auto [min_rad, max_rad] = cells.OffNadirRange();
  std::vector<bool> chosen;
  for (const ModelView& view : model.views) {
    const bool fits = !view.angles || (view.angles->off_nadir_rad >= min_rad - max_tilt_rad &&
                                       view.angles->off_nadir_rad <= max_rad + max_tilt_rad);
    chosen.push_back(fits && view.feature_count > 0);
  }
  return chosen;
}

std::vector<std::size_t> ChooseCoarseViews(const ObjectModel& model, const std::vector<bool>& chosen) {
  std::vector<std::size_t> coarse_views;
  std::vector<bool> covered(model.views.size());
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    if (covered[view] || !chosen[view]) continue;
    coarse_views.push_back(view);
    for (const std::uint32_t neighbour : model.views[view].neighbours) covered[neighbour] = true;
  }
  return coarse_views;
}

bool HasObservableHeading(const ModelView& view) {
  return view.angles && view.angles->off_nadir_rad >= kMinHeadingOffNadir_rad;
}

std::size_t NearestViewToSun(const ObjectModel& model, double azimuth_rad, double elevation_rad) {
  const double up = std::sin(elevation_rad);
  const double along = std::cos(elevation_rad);
  std::size_t nearest = 0;
  double highest = -std::numeric_limits<double>::infinity();  // cosine of the angle to the sun
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    const ViewDirection& angles = *model.views[view].angles;
    const double cosine = std::cos(angles.off_nadir_rad) * up +
                          std::sin(angles.off_nadir_rad) * along * std::cos(angles.azimuth_rad - azimuth_rad);
    if (cosine <= highest) continue;
    nearest = view;
    highest = cosine;
  }
  return nearest;
}

double RelativeSunAzimuth(double view_azimuth_rad, double sun_in_model_rad) {
  return WrapAngle(sun_in_model_rad - view_azimuth_rad - kPi);
}

TemplateVariant MakeRelitVariant(const ObjectModel& model, std::size_t view, double relative_azimuth_rad,
                                 const Sun& sun, double sun_step_rad) {
  const double azimuth_rad =
      SunAzimuthInModel(model.views[view].angles->azimuth_rad, sun.azimuth_rad - relative_azimuth_rad);
  const double quantised_rad = sun_step_rad * std::round(azimuth_rad / sun_step_rad);
  return {.view = view,
          .sun_view = NearestViewToSun(model, quantised_rad, sun.elevation_rad),
          .relative_azimuth_rad = relative_azimuth_rad};
}

}  // namespace victorious
