#include "victorious/shape/surface_template.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

constexpr int kSupersampling = 2;
constexpr float kPlainAlbedo = 0.6F;
constexpr float kBackground = 0.15F;  // linear: darker than most surfaces in the sun, so that outlines are edges
constexpr double kGamma = 2.2;

struct Drawing {
  cv::Mat grey;      // CV_8UC1
  cv::Mat coverage;  // CV_32FC1, 0 to 1
};

float Brightness(const SurfacePoint& point, const std::optional<Eigen::Vector3f>& to_sun, TemplatePaint paint) {
  const float albedo = paint == TemplatePaint::kPlain ? kPlainAlbedo : point.albedo;
  const float sky = 0.35F * (0.4F + 0.175F * (1 + point.normal.z()));
  const float sun = 0.65F * std::max(0.0F, point.normal.dot(to_sun.value_or(Eigen::Vector3f::UnitZ())));
  return albedo * (sky + sun);
}

// The surface in an image of side x side pixels with the object's centre at `centre_px`.
Drawing Draw(const VisibleSurface& surface, const TemplateView& view, int side_px, double centre_px) {
  const int side = kSupersampling * side_px;
  cv::Mat depth(side, side, CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()));
  cv::Mat light(side, side, CV_32F, cv::Scalar(kBackground));
  const Eigen::Matrix3f camera_from_model = CameraFromModel(view.to_camera).toRotationMatrix().cast<float>();
  std::optional<Eigen::Vector3f> to_sun;
  if (view.to_sun) to_sun = DirectionToCamera(*view.to_sun).cast<float>();
  const auto scale = static_cast<float>(kSupersampling * view.pixels_per_m);
  const auto centre = static_cast<float>(kSupersampling * centre_px);
  // A point fills the square up to its neighbours.
  const float half = std::max(0.5F, 0.6F * scale * static_cast<float>(surface.spacing_m));
  for (const SurfacePoint& point : surface.points) {
    const Eigen::Vector3f at = camera_from_model * point.position_m;
    const float x = scale * at.x() + centre;
    const float y = scale * at.y() + centre;
    const int left = std::max(0, static_cast<int>(std::ceil(x - half - 0.5F)));
    const int right = std::min(side - 1, static_cast<int>(std::floor(x + half - 0.5F)));
    const int top = std::max(0, static_cast<int>(std::ceil(y - half - 0.5F)));
    const int bottom = std::min(side - 1, static_cast<int>(std::floor(y + half - 0.5F)));
    const float brightness = Brightness(point, to_sun, view.paint);
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        float& nearest = depth.at<float>(row, column);
        if (at.z() >= nearest) continue;
        nearest = at.z();
        light.at<float>(row, column) = brightness;
      }
    }
  }
  cv::Mat covered = depth < std::numeric_limits<float>::infinity();
  cv::pow(cv::min(light, 1.0), 1 / kGamma, light);
  Drawing drawing;
  light.convertTo(light, CV_32F, 255);
  cv::resize(light, light, {side_px, side_px}, 0, 0, cv::INTER_AREA);
  light.convertTo(drawing.grey, CV_8U);
  covered.convertTo(covered, CV_32F, 1 / 255.0);
  cv::resize(covered, drawing.coverage, {side_px, side_px}, 0, 0, cv::INTER_AREA);
  return drawing;
}

}  // namespace

CellTemplate DrawTemplate(const VisibleSurface& surface, const TemplateView& view,
                          const BackgroundSpectrum& background) {
  constexpr int kStride = kCellSide_px / kCellStep_px;
  const int side = background.side();
  const double centre_px = kCellSide_px * (side / 2) + 0.5;  // the middle of the cell's pixel (gradient_cells.h)
  const Drawing drawing = Draw(surface, view, kCellSide_px * side, centre_px);
  const GradientCells cells = MakeGradientCells(drawing.grey);
  cv::Mat inside;
  cv::boxFilter(drawing.coverage, inside, CV_32F, {kCellSide_px, kCellSide_px});
  CellTemplate made{.rows = side, .columns = side, .values = {}};
  made.values.resize(static_cast<std::size_t>(side) * side * kCellOrientations);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const float weight = inside.at<float>(kCellSide_px * row, kCellSide_px * column);
      const std::uint8_t* const cell = cells.at(kStride * row, kStride * column);
      for (int k = 0; k < kCellOrientations; ++k) {
        const float value = static_cast<float>(cell[k]) * (kMaxCellValue / kMaxCellCode);
        made.at(row, column, k) = weight * (value - background.mean()[static_cast<std::size_t>(k)]);
      }
    }
  }
  return made;
}

}  // namespace victorious
