// Private to recognize/, for ShapeSearch: whitened templates of models, as integers. They are made when they are first
// used and kept in memory within a budget; what they are drawn of does not depend on the video, and is kept on disk
// (RelitTemplateSource::Keep).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/recognize/contour_pose.h"
#include "victorious/search/recognize/recent_items.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/search/shape/background_spectrum.h"
#include "victorious/search/shape/surface_template.h"
#include "victorious/types/object_model.h"

namespace victorious {

inline constexpr int kShapeHeadingStep_deg = 10;  ///< between the templates of all headings

/// What the templates of a bank are drawn for; angles are quantised.
struct ShapeBankKey {
  std::size_t model = 0;
  /// Of the camera, in the model frame: two templates, one in each paint. std::nullopt: one each
  /// kShapeHeadingStep_deg, the mean of both paints.
  std::optional<int> azimuth_deg;
  int off_nadir_deg = 0;               ///< of the camera
  std::optional<int> sun_azimuth_deg;  ///< relative to the direction in which the camera looks; nullopt: no sun
  int sun_elevation_deg = 0;
  int eighth_octaves = 0;  ///< size_px = 96 * 2^(-eighth_octaves / 8)

  auto operator<=>(const ShapeBankKey&) const = default;

  /// The diagonal of the model's bounding box in the template, px.
  [[nodiscard]] double size_px() const;
  /// Cells on each side of the template's window.
  [[nodiscard]] int window() const;
};

/// A template's response to a window is scale * (sum of products of weights and the window's cell codes) - offset.
struct ShapeTemplate {
  int azimuth_deg = 0;  ///< of the camera, in the model frame
  TemplatePaint paint = TemplatePaint::kPlain;
  float scale = 0;
  float offset = 0;
};

/// Templates of one size.
struct ShapeBank {
  int window = 0;
  std::vector<ShapeTemplate> templates;
  std::vector<std::int16_t> weights;  ///< templates x window x window x 8

  [[nodiscard]] std::size_t template_values() const {
    return static_cast<std::size_t>(window) * window * kCellOrientations;
  }
  /// The weights of one template.
  [[nodiscard]] std::span<const std::int16_t> WeightsOf(std::size_t number) const {
    return std::span(weights).subspan(number * template_values(), template_values());
  }
  void Add(const ShapeTemplate& one, std::span<const std::int16_t> of_one);
};

/// Drawn cells as bytes.
[[nodiscard]] std::vector<std::byte> PackDrawnCells(std::span<const DrawnCells> drawn);
/// Safe for any bytes. Empty for what PackDrawnCells did not write of `count` drawings of `side` cells.
[[nodiscard]] std::vector<DrawnCells> UnpackDrawnCells(std::span<const std::byte> bytes, std::size_t count, int side);

class ShapeSearch::Templates {
 public:
  Templates(std::span<const ObjectModel> models, std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
            std::span<const GradientCells> background);

  /// Null if the model cannot be searched for by its shape.
  [[nodiscard]] const RelitTemplateSource* surfaces(std::size_t model) const { return surfaces_[model].get(); }
  /// The diagonal of the model's bounding box, m.
  [[nodiscard]] double diagonal_m(std::size_t model) const { return diagonals_m_[model]; }
  [[nodiscard]] const std::array<float, kCellOrientations>& mean() const { return small_.mean(); }
  /// Of the templates in memory.
  [[nodiscard]] std::size_t size_bytes() const { return made_.size_bytes(); }

  /// The view of a model from the direction nearest to this one.
  [[nodiscard]] std::size_t NearestView(std::size_t model, const ViewDirection& direction) const;

  /// The surface of a view of a model that can be searched for. Never null.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::shared_ptr<const RenderedSurface>> GetSurface(std::size_t model, std::size_t view) const;

  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::shared_ptr<const ShapeBank>> Get(const ShapeBankKey& key) const;

  /// The contours of the view from the direction nearest to this one, alone. Never null.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::shared_ptr<const ContourModel>> GetContours(std::size_t model,
                                                                          const ViewDirection& direction) const;

 private:
  using ModelAndView = std::pair<std::size_t, std::size_t>;

  [[nodiscard]] const BackgroundSpectrum& SpectrumFor(int window) const;
  [[nodiscard]] Expected<std::vector<DrawnCells>> FindOrDraw(const ShapeBankKey& key) const;
  [[nodiscard]] Expected<std::vector<DrawnCells>> Draw(const ShapeBankKey& key) const;

  std::span<const ObjectModel> models_;
  std::vector<std::shared_ptr<const RelitTemplateSource>> surfaces_;
  std::vector<double> diagonals_m_;
  BackgroundSpectrum small_;  // for windows of up to kSmallSide - kReach cells
  BackgroundSpectrum coarse_;
  BackgroundSpectrum fine_;
  BackgroundSpectrum finest_;
  mutable RecentItems<ShapeBankKey, ShapeBank> made_;
  mutable RecentItems<ModelAndView, ContourModel> contours_;
  mutable RecentItems<ModelAndView, RenderedSurface> drawn_surfaces_;
};

}  // namespace victorious
