#include "victorious/lab/evaluate/warped_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/polygon.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/nearest_view.h"
#include "victorious/object/model/view_surface.h"

namespace victorious {
namespace {

// Each pixel is warped as 3 x 3 splats, so that the rotation opens no gaps in a surface.
constexpr int kSubpixels = 3;

struct Splat {
  int row;
  int column;
  double depth_m;
  double grey;
};

// Projects each splat after the rotation of the object about `middle` (both in the camera frame).
std::vector<Splat> ForwardWarp(const ViewSurface& surface, const cv::Mat& grey, const Eigen::Quaterniond& turn,
                               const Eigen::Vector3d& middle) {
  const PinholeCamera& pinhole = surface.depth_map.camera.pinhole;
  std::vector<Splat> splats;
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      const double depth_m = surface.depth_map.depth_m.at<float>(row, column);
      if (!std::isfinite(depth_m)) continue;
      for (int part = 0; part < kSubpixels * kSubpixels; ++part) {
        const Eigen::Vector2d from(column + (part % kSubpixels + 0.5) / kSubpixels,
                                   row + (part / kSubpixels + 0.5) / kSubpixels);
        const Eigen::Vector3d place = turn * (depth_m * pinhole.Unproject(from) - middle) + middle;
        const std::optional<Eigen::Vector2d> to = pinhole.Project(place);
        if (!to || to->x() < 0 || to->y() < 0 || to->x() >= grey.cols || to->y() >= grey.rows) continue;
        splats.push_back({static_cast<int>(to->y()), static_cast<int>(to->x()), place.z(),
                          static_cast<double>(grey.at<std::uint8_t>(row, column))});
      }
    }
  }
  return splats;
}

// Averages the nearest splats of each pixel; splats behind these by more than `thickness_m` are occluded.
WarpedView RenderSplats(const std::vector<Splat>& splats, const cv::Size& size, double thickness_m) {
  cv::Mat nearest_m(size, CV_64F, cv::Scalar(std::numeric_limits<double>::infinity()));
  for (const Splat& splat : splats) {
    double& nearest = nearest_m.at<double>(splat.row, splat.column);
    nearest = std::min(nearest, splat.depth_m);
  }
  cv::Mat sum(size, CV_64F, cv::Scalar(0));
  cv::Mat count(size, CV_64F, cv::Scalar(0));
  for (const Splat& splat : splats) {
    if (splat.depth_m > nearest_m.at<double>(splat.row, splat.column) + thickness_m) continue;
    sum.at<double>(splat.row, splat.column) += splat.grey;
    count.at<double>(splat.row, splat.column) += 1;
  }
  WarpedView view{.grey = {}, .mask = count > 0};
  cv::Mat mean;
  cv::divide(sum, cv::max(count, 1.0), mean);
  mean.convertTo(view.grey, CV_8U);
  return view;
}

// A pixel without a splat takes the mean of its 8 neighbours if at least 5 of them have one.
void FillGaps(WarpedView& view) {
  constexpr int kMinNeighbours = 5;
  const WarpedView before{view.grey.clone(), view.mask.clone()};
  for (int row = 1; row + 1 < view.grey.rows; ++row) {
    for (int column = 1; column + 1 < view.grey.cols; ++column) {
      if (before.mask.at<std::uint8_t>(row, column) != 0) continue;
      const cv::Rect around(column - 1, row - 1, 3, 3);
      if (cv::countNonZero(before.mask(around)) < kMinNeighbours) continue;
      view.grey.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(cv::mean(before.grey(around), before.mask(around))[0]);
      view.mask.at<std::uint8_t>(row, column) = 255;
    }
  }
}

}  // namespace

Expected<WarpedView> WarpView(const ObjectModel& model, const ViewDirection& direction,
                              const std::optional<ViewDirection>& sun) {
  const ModelView& nearest = model.views[NearestView(model, direction)];
  VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface, DecodeSurface(nearest.surface, model.name));
  cv::Mat grey = surface.grey;
  if (sun) {
    CadModelOptions options;
    if (Status status = SetFromJsonText(model.options_json, CollectFields(options)); !status) {
      return std::unexpected(std::move(status).error().WithContext(fmt::format("model {}", model.name)));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface from_sun,
                                DecodeSurface(model.views[NearestView(model, *sun)].surface, model.name));
    grey = Relight(surface.grey, surface.depth_map, options.light, ClearDayLight(*sun), from_sun.depth_map);
  }
  const PosedCamera& camera = surface.depth_map.camera;
  const Eigen::Vector3d middle =
      camera.camera_from_world.Apply(model.box_m ? model.box_m->center().eval() : Eigen::Vector3d::Zero().eval());
  const Eigen::Quaterniond turn = CameraFromModel(direction) * CameraFromModel(*nearest.angles).conjugate();
  const double pixel_m = middle.z() / camera.pinhole.fx;
  WarpedView view = RenderSplats(ForwardWarp(surface, grey, turn, middle), grey.size(), 3 * pixel_m);
  FillGaps(view);
  FillGaps(view);
  return view;
}

Expected<WarpedView> WarpPhoto(const ObjectModel& model, std::size_t photo, double turned_rad, double axis_rad) {
  const ModelView& view = model.views[photo];
  Expected<Image> thumbnail = DecodeImage(view.thumbnail, model.name);
  if (!thumbnail) return std::unexpected(std::move(thumbnail).error());
  const cv::Mat grey = GreyFromBgr(thumbnail->bgr);
  const Box box = BoundingBox(view.outline);
  if (box.IsEmpty()) return Fail(ErrorCode::kDataLoss, fmt::format("model {}: a view without an outline", model.name));
  const Eigen::Matrix2d axis = Eigen::Rotation2Dd(axis_rad).toRotationMatrix();
  const Eigen::Matrix2d turned = axis * Eigen::Vector2d(1, std::cos(turned_rad)).asDiagonal() * axis.transpose();
  const Eigen::Vector2d scale(grey.cols / box.width, grey.rows / box.height);
  // The corners of the thumbnail, and those of the object, turned about the thumbnail's centre.
  const Eigen::Vector2d middle(grey.cols / 2.0, grey.rows / 2.0);
  const auto turn = [&](const Eigen::Vector2d& point) -> Eigen::Vector2d { return turned * (point - middle); };
  Polygon corners;
  for (const Eigen::Vector2d& corner : BoxCorners(FrameBox(grey.cols, grey.rows))) corners.push_back(turn(corner));
  constexpr double kMargin_px = 2;
  const Box bounds = BoundingBox(corners);
  const Eigen::Vector2d shift(kMargin_px - bounds.x, kMargin_px - bounds.y);
  const cv::Size size(static_cast<int>(std::ceil(bounds.width + 2 * kMargin_px)),
                      static_cast<int>(std::ceil(bounds.height + 2 * kMargin_px)));
  std::vector<cv::Point> outline;
  for (const Eigen::Vector2d& corner : view.outline) {
    const Eigen::Vector2d in_thumbnail = (corner - Eigen::Vector2d(box.x, box.y)).cwiseProduct(scale);
    const Eigen::Vector2d to = turn(in_thumbnail) + shift;
    outline.emplace_back(cv::Point2d(to.x(), to.y()));
  }
  // Pixel centres lie at 0.5, in OpenCV's matrices at 0.
  const Eigen::Vector2d half(0.5, 0.5);
  const Eigen::Vector2d offset = turned * (half - middle) + shift - half;
  WarpedView warped;
  cv::warpAffine(grey, warped.grey,
                 cv::Matx23d(turned(0, 0), turned(0, 1), offset.x(), turned(1, 0), turned(1, 1), offset.y()), size,
                 cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  warped.mask = cv::Mat::zeros(size, CV_8UC1);
  cv::fillPoly(warped.mask, std::vector{outline}, cv::Scalar(255));
  return warped;
}

}  // namespace victorious
