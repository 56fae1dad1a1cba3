#include "victorious/search/shape/surface_template.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

constexpr int kSupersampling = 2;
constexpr int kBorder = 1;  // cells drawn around a template: its gradients are normalised by those around
constexpr float kPlainAlbedo = 0.6F;
constexpr float kBackground = 0.15F;  // linear: darker than most surfaces in the sun, so that outlines are edges
constexpr double kGamma = 2.2;
constexpr std::uint8_t kFullCoverage = 255;

// Grey levels of linear brightness.
class Display {
 public:
  Display() {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      levels_[i] = static_cast<float>(255 * std::pow(static_cast<double>(i) / kSteps, 1 / kGamma));
    }
  }
  float operator()(float linear) const {
    return levels_[static_cast<std::size_t>(std::clamp(linear, 0.0F, 1.0F) * kSteps + 0.5F)];
  }

 private:
  static constexpr std::size_t kSteps = 4096;
  std::array<float, kSteps + 1> levels_;
};

// Which point of the surface each pixel of an image shows, at kSupersampling times the resolution.
struct ShownPoints {
  static constexpr std::int32_t kNone = -1;
  cv::Mat index;  // CV_32S
};

ShownPoints Project(const VisibleSurface& surface, const TemplateView& view, int side_px, double centre_px) {
  const int side = kSupersampling * side_px;
  cv::Mat depth(side, side, CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()));
  ShownPoints shown{.index = cv::Mat(side, side, CV_32S, cv::Scalar(ShownPoints::kNone))};
  const auto scale = static_cast<float>(kSupersampling * view.pixels_per_m);
  const Eigen::Matrix3f camera_from_model = CameraFromModel(view.to_camera).toRotationMatrix().cast<float>();
  const auto centre = static_cast<float>(kSupersampling * centre_px);
  // A point fills the square up to its neighbours.
  const float half = std::max(0.5F, 0.6F * scale * static_cast<float>(surface.spacing_m));
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f at = camera_from_model * surface.points[i].position_m;
    const float x = scale * at.x() + centre;
    const float y = scale * at.y() + centre;
    const int left = std::max(0, static_cast<int>(std::ceil(x - half - 0.5F)));
    const int right = std::min(side - 1, static_cast<int>(std::floor(x + half - 0.5F)));
    const int top = std::max(0, static_cast<int>(std::ceil(y - half - 0.5F)));
    const int bottom = std::min(side - 1, static_cast<int>(std::floor(y + half - 0.5F)));
    for (int row = top; row <= bottom; ++row) {
      auto* const nearest = depth.ptr<float>(row);
      auto* const index = shown.index.ptr<std::int32_t>(row);
      for (int column = left; column <= right; ++column) {
        if (at.z() >= nearest[column]) continue;
        nearest[column] = at.z();
        index[column] = static_cast<std::int32_t>(i);
      }
    }
  }
  return shown;
}

// The grey level of each point in each paint.
std::array<std::vector<float>, kTemplatePaints> LightPoints(const VisibleSurface& surface,
                                                            const std::optional<ViewDirection>& to_sun) {
  static const Display kDisplay;
  const Eigen::Vector3f sun_direction =
      to_sun ? Eigen::Vector3f(DirectionToCamera(*to_sun).cast<float>()) : Eigen::Vector3f::UnitZ();
  std::array<std::vector<float>, kTemplatePaints> greys;
  for (std::vector<float>& of_paint : greys) of_paint.reserve(surface.points.size());
  for (const SurfacePoint& point : surface.points) {
    const float sky = 0.35F * (0.4F + 0.175F * (1 + point.normal.z()));
    const float light = sky + 0.65F * std::max(0.0F, point.normal.dot(sun_direction));
    greys[static_cast<std::size_t>(TemplatePaint::kPlain)].push_back(kDisplay(kPlainAlbedo * light));
    greys[static_cast<std::size_t>(TemplatePaint::kOwn)].push_back(kDisplay(point.albedo * light));
  }
  return greys;
}

// CV_8UC1, at the resolution of the template.
cv::Mat Paint(const ShownPoints& shown, const std::vector<float>& greys, float background) {
  const int side = shown.index.rows / kSupersampling;
  cv::Mat grey(side, side, CV_8U);
  for (int row = 0; row < side; ++row) {
    auto* const out = grey.ptr<std::uint8_t>(row);
    for (int column = 0; column < side; ++column) {
      float sum = 0;
      for (int y = 0; y < kSupersampling; ++y) {
        const auto* const index = shown.index.ptr<std::int32_t>(kSupersampling * row + y) + kSupersampling * column;
        for (int x = 0; x < kSupersampling; ++x) {
          sum += index[x] == ShownPoints::kNone ? background : greys[static_cast<std::size_t>(index[x])];
        }
      }
      out[column] = static_cast<std::uint8_t>(std::lround(sum / (kSupersampling * kSupersampling)));
    }
  }
  return grey;
}

// Of the cells around the pixels of their centres.
std::vector<std::uint8_t> Coverage(const ShownPoints& shown, int side) {
  std::vector<std::uint8_t> coverage;
  coverage.reserve(static_cast<std::size_t>(side) * side);
  constexpr int kWide = kSupersampling * kCellSide_px;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const int top = kWide * (row + kBorder) - kWide / 2;
      const int left = kWide * (column + kBorder) - kWide / 2;
      int covered = 0;
      for (int y = 0; y < kWide; ++y) {
        const auto* const index = shown.index.ptr<std::int32_t>(top + y) + left;
        for (int x = 0; x < kWide; ++x) covered += index[x] != ShownPoints::kNone ? 1 : 0;
      }
      coverage.push_back(static_cast<std::uint8_t>(covered * kFullCoverage / (kWide * kWide)));
    }
  }
  return coverage;
}

}  // namespace

std::array<DrawnCells, kTemplatePaints> DrawCells(const VisibleSurface& surface, const TemplateView& view, int side) {
  constexpr int kStride = kCellSide_px / kCellStep_px;
  const float background = 255 * static_cast<float>(std::pow(kBackground, 1 / kGamma));
  const double centre_px =
      kCellSide_px * (side / 2 + kBorder) + 0.5;  // the middle of the cell's pixel (gradient_cells.h)
  const ShownPoints shown = Project(surface, view, kCellSide_px * (side + 2 * kBorder), centre_px);
  const auto greys = LightPoints(surface, view.to_sun);
  const std::vector<std::uint8_t> coverage = Coverage(shown, side);
  std::array<DrawnCells, kTemplatePaints> drawn;
  for (std::size_t paint = 0; paint < kTemplatePaints; ++paint) {
    const GradientCells cells = MakeGradientCells(Paint(shown, greys[paint], background));
    drawn[paint] = {.side = side, .coverage = coverage, .codes = {}};
    std::vector<std::uint8_t>& codes = drawn[paint].codes;
    codes.reserve(coverage.size() * kCellOrientations);
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        const std::uint8_t* const cell = cells.at(kStride * (row + kBorder), kStride * (column + kBorder));
        codes.insert(codes.end(), cell, cell + kCellOrientations);
      }
    }
  }
  return drawn;
}

CellTemplate MakeTemplate(const DrawnCells& drawn, const BackgroundSpectrum& background) {
  CellTemplate made{.rows = drawn.side, .columns = drawn.side, .values = std::vector<float>(drawn.codes.size())};
  for (std::size_t i = 0; i < drawn.codes.size(); ++i) {
    const std::size_t cell = i / kCellOrientations;
    const float value = static_cast<float>(drawn.codes[i]) * (kMaxCellValue / kMaxCellCode);
    made.values[i] =
        static_cast<float>(drawn.coverage[cell]) / kFullCoverage * (value - background.mean()[i % kCellOrientations]);
  }
  return made;
}

}  // namespace victorious
