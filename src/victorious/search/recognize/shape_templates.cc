#include "victorious/search/recognize/shape_templates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/packed_bytes.h"
#include "victorious/geometry/angles.h"
#include "victorious/kernels/window_products.h"
#include "victorious/search/recognize/template_variant.h"

namespace victorious {
namespace {

// Sides of the spectra, cells: a template's weights reach beyond its cells, and must not meet those of its other side.
constexpr int kSmallSide = 16;
constexpr int kCoarseSide = 24;
constexpr int kFineSide = 40;
constexpr int kFinestSide = 64;
constexpr int kReach = 4;
// Beside the object's cells, those whose edges follow from its edges.
constexpr int kMargin = 1;
constexpr float kMaxWeight = kernels::kMaxTemplateValue;
constexpr std::size_t kBankHeadings = 360 / kShapeHeadingStep_deg;

// The budget of templates in memory. Those of all headings of a model at one off-nadir angle take 0.25 MB, and are made
// again of what is on disk in 10 ms.
std::size_t MaxBytes(std::size_t models) {
  constexpr std::size_t kOfModel = 1'000'000;
  return std::clamp<std::size_t>(models * kOfModel, 16'000'000, 256'000'000);
}

constexpr std::size_t kMaxContourBytes = 16'000'000;
constexpr std::size_t kMaxSurfaceBytes = 16'000'000;  // some hundred

std::size_t Bytes(const ShapeBank& bank) {
  return sizeof(bank) + bank.templates.capacity() * sizeof(ShapeTemplate) +
         bank.weights.capacity() * sizeof(std::int16_t);
}

// Of a drawing in each paint, what lies between both.
DrawnCells Mean(const std::array<DrawnCells, kTemplatePaints>& drawn) {
  DrawnCells mean = drawn[0];
  for (std::size_t i = 0; i < mean.codes.size(); ++i) {
    mean.codes[i] = static_cast<std::uint8_t>((drawn[0].codes[i] + drawn[1].codes[i] + 1) / 2);
  }
  return mean;
}

// As integers.
void AddTemplate(const CellTemplate& weights, const std::array<float, kCellOrientations>& mean, ShapeTemplate one,
                 ShapeBank& bank) {
  float largest = 0;
  double offset = 0;
  for (std::size_t i = 0; i < weights.values.size(); ++i) {
    largest = std::max(largest, std::abs(weights.values[i]));
    offset += static_cast<double>(weights.values[i]) * mean[i % kCellOrientations];
  }
  if (largest == 0) return;
  one.scale = largest / kMaxWeight * (kMaxCellValue / kMaxCellCode);
  one.offset = static_cast<float>(offset);
  std::vector<std::int16_t> rounded;
  rounded.reserve(weights.values.size());
  for (const float weight : weights.values) {
    rounded.push_back(static_cast<std::int16_t>(std::lround(weight * kMaxWeight / largest)));
  }
  bank.Add(one, rounded);
}

std::string NameOf(const ShapeBankKey& key) {
  std::string name = fmt::format("shape-{}-{}", key.eighth_octaves, key.off_nadir_deg);
  if (key.azimuth_deg) name += fmt::format("-{}", *key.azimuth_deg);
  if (key.sun_azimuth_deg) name += fmt::format("-sun{}-{}", *key.sun_azimuth_deg, key.sun_elevation_deg);
  return name;
}

}  // namespace

double ShapeBankKey::size_px() const { return kFineSize_px * std::exp2(-eighth_octaves / 8.0); }

int ShapeBankKey::window() const { return static_cast<int>(std::ceil(size_px() / kCellSide_px)) + 2 * kMargin; }

void ShapeBank::Add(const ShapeTemplate& one, std::span<const std::int16_t> of_one) {
  templates.push_back(one);
  weights.insert(weights.end(), of_one.begin(), of_one.end());
}

std::vector<std::byte> PackDrawnCells(std::span<const DrawnCells> drawn) {
  ByteWriter writer;
  for (const DrawnCells& one : drawn) {
    writer.PutItems(std::span(one.coverage));
    writer.PutItems(std::span(one.codes));
  }
  return writer.Take();
}

std::vector<DrawnCells> UnpackDrawnCells(std::span<const std::byte> bytes, std::size_t count, int side) {
  ByteReader reader(bytes);
  std::vector<DrawnCells> drawn;
  const auto cells = static_cast<std::size_t>(side) * side;
  for (std::size_t i = 0; i < count && !reader.HasFailed(); ++i) {
    DrawnCells one{.side = side, .coverage = reader.GetItems<std::uint8_t>(), .codes = {}};
    one.codes = reader.GetItems<std::uint8_t>();
    if (one.coverage.size() != cells || one.codes.size() != cells * kCellOrientations) return {};
    drawn.push_back(std::move(one));
  }
  if (!reader.IsAtEnd()) return {};
  return drawn;
}

ShapeSearch::Templates::Templates(std::span<const ObjectModel> models,
                                  std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
                                  std::span<const GradientCells> background)
    : models_(models),
      small_(background, kSmallSide),
      coarse_(background, kCoarseSide),
      fine_(background, kFineSide),
      finest_(background, kFinestSide),
      made_(MaxBytes(models.size())),
      contours_(kMaxContourBytes),
      drawn_surfaces_(kMaxSurfaceBytes) {
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

Expected<std::shared_ptr<const ShapeBank>> ShapeSearch::Templates::Get(const ShapeBankKey& key) const {
  if (std::shared_ptr<const ShapeBank> found = made_.Find(key)) return found;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<DrawnCells> drawn, FindOrDraw(key));
  ShapeBank bank{.window = key.window(), .templates = {}, .weights = {}};
  const BackgroundSpectrum& spectrum = SpectrumFor(bank.window);
  bank.templates.reserve(drawn.size());
  bank.weights.reserve(drawn.size() * bank.template_values());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const ShapeTemplate one =
        key.azimuth_deg ? ShapeTemplate{.azimuth_deg = *key.azimuth_deg, .paint = static_cast<TemplatePaint>(i)}
                        : ShapeTemplate{.azimuth_deg = kShapeHeadingStep_deg * static_cast<int>(i)};
    AddTemplate(spectrum.Whiten(MakeTemplate(drawn[i], spectrum)), spectrum.mean(), one, bank);
  }
  const std::size_t bytes = Bytes(bank);
  return made_.Put(key, std::move(bank), bytes);
}

const BackgroundSpectrum& ShapeSearch::Templates::SpectrumFor(int window) const {
  if (window <= kSmallSide - kReach) return small_;
  if (window <= kCoarseSide - kReach) return coarse_;
  return window <= kFineSide - kReach ? fine_ : finest_;
}

Expected<std::shared_ptr<const ContourModel>> ShapeSearch::Templates::GetContours(
    std::size_t model, const ViewDirection& direction) const {
  const std::size_t view = NearestView(model, direction);
  if (std::shared_ptr<const ContourModel> found = contours_.Find({model, view})) return found;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ContourPoint> points, surfaces_[model]->GetContours(view));
  const std::size_t bytes = sizeof(ContourModel) + points.capacity() * sizeof(ContourPoint);
  ContourModel contours{.diagonal_m = diagonals_m_[model], .views = {}};
  contours.views.push_back({CameraFromModel(*models_[model].views[view].angles).toRotationMatrix(), std::move(points)});
  return contours_.Put({model, view}, std::move(contours), bytes);
}

Expected<std::shared_ptr<const RenderedSurface>> ShapeSearch::Templates::GetSurface(std::size_t model,
                                                                                    std::size_t view) const {
  if (std::shared_ptr<const RenderedSurface> found = drawn_surfaces_.Find({model, view})) return found;
  VICTORIOUS_ASSIGN_OR_RETURN(RenderedSurface rendered, surfaces_[model]->GetSurface(view));
  const std::size_t bytes = sizeof(rendered) + rendered.surface.points.capacity() * sizeof(SurfacePoint);
  return drawn_surfaces_.Put({model, view}, std::move(rendered), bytes);
}

Expected<std::vector<DrawnCells>> ShapeSearch::Templates::FindOrDraw(const ShapeBankKey& key) const {
  const RelitTemplateSource& source = *surfaces_[key.model];
  const std::string name = NameOf(key);
  if (const std::optional<std::vector<std::byte>> bytes = source.FindKept(name)) {
    std::vector<DrawnCells> found =
        UnpackDrawnCells(*bytes, key.azimuth_deg ? kTemplatePaints : kBankHeadings, key.window());
    if (!found.empty()) return found;
  }
  Expected<std::vector<DrawnCells>> drawn = Draw(key);
  if (drawn) source.Keep(name, PackDrawnCells(*drawn));
  return drawn;
}

Expected<std::vector<DrawnCells>> ShapeSearch::Templates::Draw(const ShapeBankKey& key) const {
  std::vector<DrawnCells> drawn;
  for (std::size_t i = 0; i < (key.azimuth_deg ? 1 : kBankHeadings); ++i) {
    const int azimuth_deg = key.azimuth_deg.value_or(kShapeHeadingStep_deg * static_cast<int>(i));
    TemplateView view{.to_camera = {RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(key.off_nadir_deg)},
                      .to_sun = {},
                      .pixels_per_m = key.size_px() / diagonals_m_[key.model]};
    if (key.sun_azimuth_deg) {
      view.to_sun = {
          .azimuth_rad = SunAzimuthInModel(view.to_camera.azimuth_rad, RadiansFromDegrees(*key.sun_azimuth_deg)),
          .off_nadir_rad = kPi / 2 - RadiansFromDegrees(key.sun_elevation_deg)};
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const RenderedSurface> rendered,
                                GetSurface(key.model, NearestView(key.model, view.to_camera)));
    std::array<DrawnCells, kTemplatePaints> of_paints = DrawCells(rendered->surface, view, key.window());
    if (key.azimuth_deg) {
      std::ranges::move(of_paints, std::back_inserter(drawn));
    } else {
      drawn.push_back(Mean(of_paints));
    }
  }
  return drawn;
}

}  // namespace victorious
