#include "victorious/lab/simulate/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMaxCanvasPx = 4096;
constexpr double kMaxAngleFromAxisDeg = 80;  // maximum angle from the optical axis; perspective lenses do not exceed it

struct VisiblePixels {
  int count = 0;
  int left = std::numeric_limits<int>::max();
  int top = std::numeric_limits<int>::max();
  int right = -1;
  int bottom = -1;

  void Add(int x, int y) {
    ++count;
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  [[nodiscard]] Box BoundingBox() const {
    return {static_cast<double>(left), static_cast<double>(top), right + 1.0 - left, bottom + 1.0 - top};
  }
};

std::vector<VisiblePixels> CountPixels(const cv::Mat& instances, std::size_t objects) {
  std::vector<VisiblePixels> seen(objects);
  for (int y = 0; y < instances.rows; ++y) {
    const auto* row = instances.ptr<std::int32_t>(y);
    for (int x = 0; x < instances.cols; ++x) {
      if (row[x] >= 0 && static_cast<std::size_t>(row[x]) < objects) seen[static_cast<std::size_t>(row[x])].Add(x, y);
    }
  }
  return seen;
}

// The bounding rectangle of the object's projected box in the image plane, px, clipped to the maximum field of view.
// The whole clipped plane if the box extends behind the camera.
Eigen::AlignedBox2d ProjectedExtent(const PlacedMesh& object, const PosedCamera& camera) {
  const PinholeCamera& pinhole = camera.pinhole;
  const double widest = std::tan(RadiansFromDegrees(kMaxAngleFromAxisDeg));
  const Vector2d centre(pinhole.cx, pinhole.cy);
  const Vector2d reach(widest * pinhole.fx, widest * pinhole.fy);
  const Eigen::AlignedBox2d plane(Vector2d(centre - reach), Vector2d(centre + reach));
  const Rigid3 camera_from_mesh = camera.camera_from_world * object.town_from_mesh;
  Eigen::AlignedBox2d around;
  for (int corner = 0; corner < 8; ++corner) {
    const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
    const std::optional<Vector2d> pixel = pinhole.Project(camera_from_mesh.Apply(object.mesh.box.corner(type)));
    if (!pixel) return plane;
    around.extend(*pixel);
  }
  return around.intersection(plane);
}

// The same camera with another rectangle of its image plane as image. The offset is a whole number of pixels, so that
// the pixels have the same rays as in the frame.
PosedCamera MakeCanvas(const Eigen::AlignedBox2d& part, const PosedCamera& camera) {
  const Vector2d low = part.min().array().floor();
  const Vector2d high = part.max().array().ceil();
  PosedCamera canvas = camera;
  canvas.pinhole.cx -= low.x();
  canvas.pinhole.cy -= low.y();
  canvas.pinhole.width = std::max(1, static_cast<int>(high.x() - low.x()));
  canvas.pinhole.height = std::max(1, static_cast<int>(high.y() - low.y()));
  return canvas;
}

// The number of pixels of the object rendered alone, neither occluded nor cropped. Large images are rendered at a
// smaller scale and the count is rescaled.
Expected<double> CountUnoccludedPixels(const PlacedMesh& object, PosedCamera camera, Renderer& renderer) {
  const double largest = ProjectedExtent(object, camera).sizes().maxCoeff();
  const double shrink = std::min(1.0, (kMaxCanvasPx - 2) / largest);
  for (double* value : {&camera.pinhole.fx, &camera.pinhole.fy, &camera.pinhole.cx, &camera.pinhole.cy}) {
    *value *= shrink;
  }
  const PosedCamera canvas = MakeCanvas(ProjectedExtent(object, camera), camera);
  const MeshInstance instance{.mesh = object.mesh.id, .world_from_mesh = object.town_from_mesh};
  VICTORIOUS_ASSIGN_OR_RETURN(const RenderedView view,
                              renderer.Render(std::span(&instance, 1), canvas, {}, {.supersampling = 1}));
  return CountPixels(view.instances, 1).front().count / (shrink * shrink);
}

double WrapTo2Pi(double angle_rad) { return angle_rad < 0 ? angle_rad + 2 * kPi : angle_rad; }

double Rounded(double value, double steps) { return std::round(value * steps) / steps; }

}  // namespace

Eigen::Quaterniond EnuFromTown(double town_heading_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(-town_heading_rad, Vector3d::UnitZ()));
}

Expected<std::vector<ObjectTruth>> ComputeTruth(std::span<const PlacedMesh> objects, const cv::Mat& instances,
                                                const PosedCamera& camera, const TangentPlane& earth,
                                                double town_heading_rad, Renderer& renderer) {
  const std::vector<VisiblePixels> seen = CountPixels(instances, objects.size());
  const Eigen::Quaterniond enu_from_town = EnuFromTown(town_heading_rad);
  const Vector3d camera_in_town = camera.camera_from_world.Inverse().translation;
  std::vector<ObjectTruth> rows;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (seen[i].count == 0) continue;
    const PlacedMesh& object = objects[i];
    VICTORIOUS_ASSIGN_OR_RETURN(const double alone, CountUnoccludedPixels(object, camera, renderer));
    const Vector3d centre_in_town = object.town_from_mesh.Apply(object.mesh.box.center());
    const Vector3d centre_in_enu = enu_from_town * centre_in_town;
    const Eigen::Quaterniond mesh_from_town = object.town_from_mesh.rotation.conjugate();
    const Eigen::Quaterniond local_from_town = earth.LocalEnuFromEnu(centre_in_enu) * enu_from_town;
    const Vector3d front = local_from_town * (object.town_from_mesh.rotation * Vector3d::UnitX());
    const Vector2d velocity = object.velocity_in_town;
    const Vector3d moving = local_from_town * Vector3d(velocity.x(), velocity.y(), 0);
    constexpr double kAtRest_m_s = 1e-6;
    const bool at_rest = velocity.norm() < kAtRest_m_s;
    rows.push_back({.object = static_cast<int>(i),
                    .box = seen[i].BoundingBox(),
                    .pixels = seen[i].count,
                    .visible = std::min(1.0, seen[i].count / std::max(1.0, alone)),
                    .place = earth.GeodeticFromEnu(centre_in_enu),
                    .heading_rad = WrapTo2Pi(std::atan2(front.x(), front.y())),
                    .speed_m_s = velocity.norm(),
                    .course_rad = at_rest ? std::nullopt : std::optional(WrapTo2Pi(std::atan2(moving.x(), moving.y()))),
                    .view = DirectionFromVector(mesh_from_town * (camera_in_town - centre_in_town))});
  }
  return rows;
}

std::string FormatTruthLine(const ObjectTruth& truth, const SceneObject& object, int frame, double time_s) {
  constexpr double kMicro = 1e6;
  constexpr double kNanoDegrees = 1e9;  // 1e-9 degrees are 0.1 mm
  constexpr double kTenThousandths = 1e4;
  const auto degrees = [](double radians) { return Rounded(DegreesFromRadians(radians), kTenThousandths); };
  const nlohmann::ordered_json json = {
      {"frame", frame},
      {"time_s", Rounded(time_s, kMicro)},
      {"object", object.id},
      {"model", object.model},
      {"box", {truth.box.x, truth.box.y, truth.box.width, truth.box.height}},
      {"visible", Rounded(truth.visible, kTenThousandths)},
      {"pixels", truth.pixels},
      {"latitude_deg", Rounded(DegreesFromRadians(truth.place.latitude_rad), kNanoDegrees)},
      {"longitude_deg", Rounded(DegreesFromRadians(truth.place.longitude_rad), kNanoDegrees)},
      {"altitude_m", Rounded(truth.place.altitude_m, kTenThousandths)},
      {"heading_deg", degrees(truth.heading_rad)},
      {"speed_m_s", Rounded(truth.speed_m_s, kTenThousandths)},
      {"course_deg", truth.course_rad ? nlohmann::ordered_json(degrees(*truth.course_rad)) : nlohmann::ordered_json()},
      {"view",
       {{"azimuth_deg", degrees(truth.view.azimuth_rad)}, {"off_nadir_deg", degrees(truth.view.off_nadir_rad)}}},
  };
  return DumpJson(json) + "\n";
}

}  // namespace victorious
