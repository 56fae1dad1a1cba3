// Private to recognize/, for ShapeSearch: whitened templates of models, as integers, drawn when they are first used and
// kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/recognize/relit_templates.h"
#include "victorious/recognize/shape_search.h"
#include "victorious/shape/background_spectrum.h"
#include "victorious/shape/surface_template.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A template's weights as integers: response = scale * (sum of products with a window's cell codes) - offset.
struct ShapeTemplate {
  std::vector<std::int16_t> weights;  ///< side x side x 8
  float scale = 0;
  float offset = 0;
};

/// What a template is drawn for; angles are quantised.
struct ShapeTemplateKey {
  std::size_t model = 0;
  int azimuth_deg = 0;                 ///< of the camera, in the model frame
  int off_nadir_deg = 0;               ///< of the camera
  std::optional<int> sun_azimuth_deg;  ///< relative to the direction in which the camera looks; nullopt: no sun
  int sun_elevation_deg = 0;
  int eighth_octaves = 0;  ///< size_px = 96 * 2^(-eighth_octaves / 8)
  TemplatePaint paint = TemplatePaint::kPlain;

  auto operator<=>(const ShapeTemplateKey&) const = default;

  /// The diagonal of the model's bounding box in the template, px.
  [[nodiscard]] double size_px() const;
  /// Cells on each side of the template's window.
  [[nodiscard]] int window() const;
};

class ShapeSearch::Templates {
 public:
  Templates(std::span<const ObjectModel> models, std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
            std::span<const GradientCells> background);

  /// Null if the model cannot be searched for by its shape.
  [[nodiscard]] const RelitTemplateSource* surfaces(std::size_t model) const { return surfaces_[model].get(); }
  /// The diagonal of the model's bounding box, m.
  [[nodiscard]] double diagonal_m(std::size_t model) const { return diagonals_m_[model]; }
  [[nodiscard]] const std::array<float, kCellOrientations>& mean() const { return coarse_.mean(); }

  /// The view of a model from the direction nearest to this one.
  [[nodiscard]] std::size_t NearestView(std::size_t model, const ViewDirection& direction) const;

  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::shared_ptr<const ShapeTemplate>> Get(const ShapeTemplateKey& key) const;

 private:
  [[nodiscard]] Expected<ShapeTemplate> Make(const ShapeTemplateKey& key) const;

  std::span<const ObjectModel> models_;
  std::vector<std::shared_ptr<const RelitTemplateSource>> surfaces_;
  std::vector<double> diagonals_m_;
  BackgroundSpectrum coarse_;  // for windows of up to kCoarseSide cells
  BackgroundSpectrum fine_;
  mutable std::mutex mutex_;
  mutable std::map<ShapeTemplateKey, std::shared_ptr<const ShapeTemplate>> made_;
};

}  // namespace victorious
