// Meshes and a camera in; what the camera sees out: image, depth, mask. Without a window or a screen, on the GPU where
// there is one, else in software (EGL and OpenGL 3.3).
//
// Light is soft: a dome of sky, brighter from above than from below, and a weak sun. With n the normal, u up and s the
// direction to the sun, all in the world, and v the share of the sun that reaches the point:
//   colour = albedo * (ground + (sky - ground) (1 + n.u) / 2 + sun max(0, n.s) v)     linear; shown as sRGB, cut at 1
// (Lambert's law under a hemisphere light). Without Light::shadows v is 1. With them v is the share of nine points
// about the point, w / 3 apart in its surface's plane as the sun sees it (w: Light::shadow_softness_m), that nothing
// hides from the sun. What hides them is read from the depth that the sun sees in parallel projection, over all that
// the camera sees; a texel is w / 3 too, or larger where more than 4096 a side would be needed. Every opaque triangle
// casts a shadow, from either side; of the others what the cut-off leaves, and of the blended ones what has an alpha of
// 0.5 or more. What is nearer to a surface, along a ray, than some 0.2 + 1.4 tan(ray, normal) texels does not shade it.
// Textures are filtered along both axes (mipmaps, anisotropic); the image is the mean of several samples a pixel, taken
// in linear light.
#pragma once

#include <memory>
#include <span>
#include <string>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/rigid3.h"
#include "victorious/render/mesh.h"

namespace victorious {

/// Intensities are what a white surface reflects: 1 is the brightest that can be shown. The world's up is its z axis.
struct Light {
  double sky = 0.75;                                                    ///< from straight above
  double ground = 0.4;                                                  ///< from straight below
  double sun = 0.3;                                                     ///< where it falls at a right angle
  Eigen::Vector3d to_sun_in_world = Eigen::Vector3d(-0.3, 0.4, 0.866);  ///< any length above 0
  bool shadows = false;                                                 ///< whether things in the sun's way shade
  double shadow_softness_m = 0.1;                                       ///< width of a shadow's edge

  void ListFields(FieldList& fields);
};

struct RenderOptions {
  int background = 128;   ///< grey level, 0 to 255
  int supersampling = 2;  ///< samples along each side of a pixel

  void ListFields(FieldList& fields);
};

/// All of the camera's size. A pixel's depth and instance are those of the line of sight through its centre; a surface
/// that is blended counts there where its alpha is 0.5 or more.
struct RenderedView {
  cv::Mat bgr;        ///< CV_8UC3, sRGB
  cv::Mat depth_m;    ///< CV_32FC1, along the optical axis; NaN where there is nothing
  cv::Mat mask;       ///< CV_8UC1, how much of the pixel is covered: 0 to 255
  cv::Mat instances;  ///< CV_32SC1, index of the instance seen; -1 where there is nothing
};

/// A mesh that a renderer holds.
enum class MeshId : int {};

struct MeshInstance {
  MeshId mesh = {};
  Rigid3 world_from_mesh;
};

struct RendererOptions {
  bool software = false;  ///< not on a GPU even if there is one: the same pixels on every machine
};

/// An OpenGL context of its own. Not thread-safe, and bound to the thread that made it: one a thread. The same input
/// gives the same pixels on the same device.
class Renderer {
 public:
  /// Error: kInternal, no device offers OpenGL 3.3.
  static Expected<Renderer> Create(const RendererOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// What it draws on, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] const std::string& device() const;

  /// Copies a mesh to the device, until Remove() or the renderer's end. Error: kInternal, the device's memory is full.
  Expected<MeshId> Upload(const Mesh& mesh);
  void Remove(MeshId mesh);

  /// Draws the instances. Cost in software: some 10 ms for 320 x 320 pixels on two cores.
  /// Errors: kInvalidArgument (camera, light or options out of range); kInternal.
  Expected<RenderedView> Render(std::span<const MeshInstance> instances, const PosedCamera& camera,
                                const Light& light = {}, const RenderOptions& options = {});

 private:
  class Device;
  explicit Renderer(std::unique_ptr<Device> device);

  std::unique_ptr<Device> device_;
};

}  // namespace victorious
