#include "victorious/recognize/shape_templates.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"
#include "victorious/kernels/window_products.h"
#include "victorious/recognize/template_variant.h"

namespace victorious {
namespace {

// Sides of the spectra, cells: a template's weights reach beyond its cells, and must not meet those of its other side.
constexpr int kCoarseSide = 24;
constexpr int kFineSide = 40;
// Beside the object's cells, those whose edges follow from its edges.
constexpr int kMargin = 1;
constexpr float kMaxWeight = kernels::kMaxTemplateValue;

}  // namespace

double ShapeTemplateKey::size_px() const { return kFineSize_px * std::exp2(-eighth_octaves / 8.0); }

int ShapeTemplateKey::window() const { return static_cast<int>(std::ceil(size_px() / kCellSide_px)) + 2 * kMargin; }

ShapeSearch::Templates::Templates(std::span<const ObjectModel> models,
                                  std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
                                  std::span<const GradientCells> background)
    : models_(models), coarse_(background, kCoarseSide), fine_(background, kFineSide) {
  for (std::size_t m = 0; m < models.size(); ++m) {
    const bool can_be_drawn = m < surfaces.size() && surfaces[m] != nullptr && models[m].box_m;
    surfaces_.push_back(can_be_drawn ? surfaces[m] : nullptr);
    diagonals_m_.push_back(can_be_drawn ? models[m].box_m->diagonal().norm() : 0);
  }
}

std::size_t ShapeSearch::Templates::NearestView(std::size_t model, const ViewDirection& direction) const {
  const Eigen::Vector3d wanted = DirectionToCamera(direction);
  std::size_t nearest = 0;
  double highest = -2;
  for (std::size_t view = 0; view < models_[model].views.size(); ++view) {
    const double cosine = DirectionToCamera(*models_[model].views[view].angles).dot(wanted);
    if (cosine <= highest) continue;
    highest = cosine;
    nearest = view;
  }
  return nearest;
}

Expected<std::shared_ptr<const ShapeTemplate>> ShapeSearch::Templates::Get(const ShapeTemplateKey& key) const {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = made_.find(key); found != made_.end()) return found->second;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(ShapeTemplate made, Make(key));
  const std::scoped_lock lock(mutex_);
  return made_.try_emplace(key, std::make_shared<const ShapeTemplate>(std::move(made))).first->second;
}

Expected<ShapeTemplate> ShapeSearch::Templates::Make(const ShapeTemplateKey& key) const {
  const BackgroundSpectrum& spectrum = key.window() <= kCoarseSide - 4 ? coarse_ : fine_;
  TemplateView view{.to_camera = {RadiansFromDegrees(key.azimuth_deg), RadiansFromDegrees(key.off_nadir_deg)},
                    .to_sun = {},
                    .pixels_per_m = key.size_px() / diagonals_m_[key.model],
                    .paint = key.paint};
  if (key.sun_azimuth_deg) {
    view.to_sun = {
        .azimuth_rad = SunAzimuthInModel(view.to_camera.azimuth_rad, RadiansFromDegrees(*key.sun_azimuth_deg)),
        .off_nadir_rad = kPi / 2 - RadiansFromDegrees(key.sun_elevation_deg)};
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const RenderedSurface rendered,
                              surfaces_[key.model]->GetSurface(NearestView(key.model, view.to_camera)));
  const CellTemplate weights = spectrum.Whiten(DrawTemplate(rendered.surface, view, spectrum));
  const int window = key.window();
  const int first = spectrum.side() / 2 - window / 2;
  float largest = 0;
  double offset = 0;
  for (int row = first; row < first + window; ++row) {
    for (int column = first; column < first + window; ++column) {
      for (int k = 0; k < kCellOrientations; ++k) {
        const float weight = weights.at(row, column, k);
        largest = std::max(largest, std::abs(weight));
        offset += static_cast<double>(weight) * spectrum.mean()[static_cast<std::size_t>(k)];
      }
    }
  }
  ShapeTemplate made;
  if (largest == 0) return made;
  made.scale = largest / kMaxWeight * (kMaxCellValue / kMaxCellCode);
  made.offset = static_cast<float>(offset);
  made.weights.reserve(static_cast<std::size_t>(window) * window * kCellOrientations);
  for (int row = first; row < first + window; ++row) {
    for (int column = first; column < first + window; ++column) {
      for (int k = 0; k < kCellOrientations; ++k) {
        made.weights.push_back(
            static_cast<std::int16_t>(std::lround(weights.at(row, column, k) * kMaxWeight / largest)));
      }
    }
  }
  return made;
}

}  // namespace victorious
