#include "experiments/painted_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "victorious/object/render/renderer.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using Corners = std::array<Vector3f, 3>;

// The projection of an image onto the mesh, with visibility.
class Painter {
 public:
  Painter(const cv::Mat& bgr, const PosedCamera& camera, const cv::Mat& depth_m, double size_m)
      : size_(bgr.size()), camera_(camera), depth_m_(depth_m), tolerance_m_(0.02 * size_m) {}

  // The projection of a point, px.
  [[nodiscard]] std::optional<Vector2d> Project(const Vector3f& point) const {
    return camera_.pinhole.Project(camera_.camera_from_world.Apply(point.cast<double>()));
  }

  // Whether the triangle's centre is not occluded and the triangle is not seen edge-on.
  [[nodiscard]] bool IsVisible(const Corners& corners, const Vector3f& normal) const {
    constexpr float kMinCosine = 0.1F;
    const Vector3f middle = (corners[0] + corners[1] + corners[2]) / 3;
    const Vector3f camera = camera_.camera_from_world.Inverse().translation.cast<float>();
    if (normal.dot((camera - middle).normalized()) < kMinCosine) return false;
    const auto at = Project(middle);
    if (!at || at->x() < 0 || at->y() < 0 || at->x() >= size_.width || at->y() >= size_.height) return false;
    const double depth_m = camera_.camera_from_world.Apply(middle.cast<double>()).z();
    const float seen_m = depth_m_.at<float>(static_cast<int>(at->y()), static_cast<int>(at->x()));
    return std::isfinite(seen_m) && depth_m < seen_m + tolerance_m_;
  }

  [[nodiscard]] Eigen::Vector2f TextureAt(const Vector3f& point) const {
    const Vector2d at = Project(point).value_or(Vector2d::Zero());
    return {static_cast<float>(at.x() / size_.width), static_cast<float>(at.y() / size_.height)};
  }

  // The index of the longest projected side if it is longer than 8 px; std::nullopt: no subdivision.
  [[nodiscard]] std::optional<int> SideToCut(const Corners& corners) const {
    constexpr double kMaxPx = 8;
    std::optional<int> longest;
    double most = kMaxPx;
    for (int i = 0; i < 3; ++i) {
      const auto a = Project(corners[i]);
      const auto b = Project(corners[(i + 1) % 3]);
      if (!a || !b || (*a - *b).norm() <= most) continue;
      most = (*a - *b).norm();
      longest = i;
    }
    return longest;
  }

 private:
  cv::Size size_;
  PosedCamera camera_;
  cv::Mat depth_m_;
  double tolerance_m_;
};

// The subdivided triangles, each with three vertices of its own.
class Subdivision {
 public:
  explicit Subdivision(const Painter& painter) : painter_(painter) {}

  void Add(const Corners& corners, const Vector3f& normal) {
    const std::optional<int> side = painter_.SideToCut(corners);
    if (side && std::min(painted_.size(), plain_.size()) < kMaxTriangles) {
      const int a = *side;
      const int b = (a + 1) % 3;
      const int c = (a + 2) % 3;
      const Vector3f middle = (corners[a] + corners[b]) / 2;
      Add({corners[a], middle, corners[c]}, normal);
      Add({middle, corners[b], corners[c]}, normal);
      return;
    }
    (painter_.IsVisible(corners, normal) ? painted_ : plain_).push_back({corners, normal});
  }

  [[nodiscard]] Mesh ToMesh(const cv::Mat& bgr) const {
    Mesh mesh;
    mesh.materials = {{.name = "painted",
                       .texture = 0,
                       .wrap_u = TextureWrap::kClamp,
                       .wrap_v = TextureWrap::kClamp,
                       .double_sided = true},
                      {.name = "plain", .base_colour = {0.2F, 0.2F, 0.2F, 1}, .double_sided = true}};
    cv::cvtColor(bgr, mesh.textures.emplace_back(), cv::COLOR_BGR2BGRA);
    for (const int material : {0, 1}) {
      const auto first = static_cast<std::uint32_t>(mesh.triangles.size());
      for (const Piece& piece : material == 0 ? painted_ : plain_) {
        const auto vertex = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Vector3f& corner : piece.corners) {
          mesh.positions.push_back(corner);
          mesh.normals.push_back(piece.normal);
          mesh.uvs.push_back(painter_.TextureAt(corner));
        }
        mesh.triangles.push_back({vertex, vertex + 1, vertex + 2});
      }
      mesh.parts.push_back({material, first, static_cast<std::uint32_t>(mesh.triangles.size()) - first});
    }
    return mesh;
  }

 private:
  struct Piece {
    Corners corners;
    Vector3f normal;
  };
  static constexpr std::size_t kMaxTriangles = 1'000'000;

  const Painter& painter_;
  std::vector<Piece> painted_;
  std::vector<Piece> plain_;
};

}  // namespace

Expected<Mesh> ProjectTexture(const Mesh& mesh, const cv::Mat& bgr, const PosedCamera& camera) {
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create());
  VICTORIOUS_ASSIGN_OR_RETURN(const MeshId id, renderer.Upload(mesh));
  const MeshInstance instance{.mesh = id, .world_from_mesh = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(const RenderedView seen, renderer.Render(std::span(&instance, 1), camera));
  const Painter painter(bgr, camera, seen.depth_m, BoundingBox(mesh).diagonal().norm());
  Subdivision subdivision(painter);
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    const Corners corners = {mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]};
    const Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (normal.norm() > 0) subdivision.Add(corners, normal.normalized());
  }
  return subdivision.ToMesh(bgr);
}

}  // namespace victorious
