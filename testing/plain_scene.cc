#include "testing/plain_scene.h"

#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "testing/small_cad_model.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/view_surface.h"
#include "victorious/object/render/relight.h"
#include "victorious/search/recognize/shape_search.h"

namespace victorious::testing {
namespace {

constexpr double kHfov_rad = 0.3;
constexpr double kShown = 0.5;   // size of the object in the scene over that in the view
constexpr double kTop_px = 120;  // of the view in the scene

// Directions between those of the model.
const ObjectModel& Shown() {
  static const ObjectModel model = MakeSmallCadModel({.step_deg = 40, .max_off_nadir_deg = kOffNadirOfScene_deg});
  return model;
}

}  // namespace

const ObjectModel& PlainModel() {
  static const ObjectModel model = MakeSmallCadModel({.step_deg = 10, .max_off_nadir_deg = 50});
  return model;
}

cv::Mat DrawFields(std::uint64_t seed, const cv::Size& size) {
  Random random(seed);
  cv::Mat grey(size, CV_8U, cv::Scalar(120));
  constexpr double kAreaOfOne_px = 5120;
  const int rectangles = static_cast<int>(size.area() / kAreaOfOne_px);
  for (int i = 0; i < rectangles; ++i) {
    const cv::Point2f centre(static_cast<float>(random.Uniform(0, size.width)),
                             static_cast<float>(random.Uniform(0, size.height)));
    const cv::Size2f sides(static_cast<float>(random.Uniform(40, 200)), static_cast<float>(random.Uniform(40, 200)));
    cv::Point2f corners[4];
    cv::RotatedRect(centre, sides, static_cast<float>(random.Uniform(0, 90))).points(corners);
    std::vector<cv::Point> polygon;
    for (const cv::Point2f& corner : corners) polygon.emplace_back(corner);
    cv::fillConvexPoly(grey, polygon, cv::Scalar(random.Uniform(40, 220)));
  }
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      std::uint8_t& pixel = grey.at<std::uint8_t>(row, column);
      pixel = cv::saturate_cast<std::uint8_t>(pixel + random.Uniform(-8, 8));
    }
  }
  cv::GaussianBlur(grey, grey, {}, 0.7);
  return grey;
}

std::vector<GradientCells> CellsOfFields() {
  std::vector<GradientCells> cells;
  for (const std::uint64_t seed : {101, 102}) {
    for (GradientCells& one : BackgroundCells(DrawFields(seed))) cells.push_back(std::move(one));
  }
  return cells;
}

PlainScene MakePlainScene(std::size_t number, cv::Mat background, double left_px) {
  const ModelView& view = Shown().views.at(number);
  const ViewSurface surface = DecodeSurface(view.surface, "slab").value();
  const cv::Mat mask = surface.depth_map.depth_m == surface.depth_map.depth_m;  // not NaN
  cv::Mat plain = cv::Mat::zeros(surface.grey.size(), CV_8U);
  const std::vector<SurfacePoint> points = ReadSurface(surface.grey, surface.depth_map, CadModelOptions().light);
  auto point = points.begin();
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      if (mask.at<std::uint8_t>(row, column) == 0) continue;
      plain.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(110 + 90 * point++->normal.z());
    }
  }
  PlainScene scene{.grey = std::move(background), .box = {}, .centre_px = {}, .conditions = {}};
  const cv::Matx23d map(kShown, 0, left_px, 0, kShown, kTop_px);
  cv::Mat object;
  cv::Mat shown;
  cv::warpAffine(plain, object, map, scene.grey.size(), cv::INTER_AREA);
  cv::warpAffine(mask, shown, map, scene.grey.size(), cv::INTER_NEAREST);
  object.copyTo(scene.grey, shown);
  const cv::Rect around = cv::boundingRect(shown);
  scene.box = {static_cast<double>(around.x), static_cast<double>(around.y), static_cast<double>(around.width),
               static_cast<double>(around.height)};
  const PosedCamera& camera = surface.depth_map.camera;
  const Eigen::Vector3d centre = camera.camera_from_world.Apply(PlainModel().box_m->center());
  const Eigen::Vector2d in_view = camera.pinhole.Project(centre).value();
  scene.centre_px = kShown * in_view + Eigen::Vector2d(left_px, kTop_px);
  scene.azimuth_rad = view.angles->azimuth_rad;
  const double focal_px = FocalLengthPx(kHfov_rad, scene.grey.cols);
  const double below_rad = std::atan((scene.centre_px.y() - scene.grey.rows / 2.0) / focal_px);
  const double pitch_rad = RadiansFromDegrees(kOffNadirOfScene_deg) - kPi / 2 + below_rad;
  scene.conditions.vertical = MakeVertical({0, pitch_rad, 0}, kHfov_rad, scene.grey.cols, scene.grey.rows);
  const Eigen::Vector3d ray = scene.conditions.vertical->pinhole.Unproject(scene.centre_px);
  const double depth_m = focal_px / (kShown * camera.pinhole.fx / centre.z());
  scene.conditions.height_above_ground_m =
      PlainModel().box_m->sizes().z() / 2 - depth_m * scene.conditions.vertical->up_in_camera.dot(ray);
  return scene;
}

}  // namespace victorious::testing
