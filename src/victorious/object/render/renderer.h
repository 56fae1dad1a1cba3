// Offscreen renderer: meshes, a camera and a light give an image, a depth map, a coverage mask and an instance map.
// Headless EGL with OpenGL 3.3; on a GPU if there is one, else in software.
//
// Shading: Lambert's law under a hemisphere light (sky dome) and a directional sun. With n the normal, u up and s the
// direction to the sun, all in the world frame, and v the visible fraction of the sun at the point:
//   colour = albedo * (ground + (sky - ground) (1 + n.u) / 2 + sun max(0, n.s) v)     linear; clamped at 1, then sRGB
// Without Light::shadows v = 1. With shadows v comes from a shadow map (percentage-closer filtering): the fraction of
// nine points that are not occluded from the sun. The points form a grid about the surface point, in its tangent plane,
// with spacing w / 3 as the sun sees it (w: Light::shadow_softness_m). The shadow map is the depth in the sun's
// parallel projection over the region that the camera sees; a texel is w / 3, or larger if the map would exceed 4096
// texels a side. Shadow casters: every opaque triangle, from either side; masked triangles where alpha >= the cut-off;
// blended triangles where alpha >= 0.5. Bias: an occluder nearer to the surface, along the ray, than about
// 0.2 + 1.4 tan(angle between ray and normal) texels casts no shadow on it.
// Textures use mipmaps and anisotropic filtering. The image is the mean of several samples a pixel in linear light.
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
#include "victorious/types/mesh.h"

namespace victorious {

/// Intensities are the linear value of a white surface: 1 is the brightest displayable value. Up is the world's z axis.
struct Light {
  double sky = 0.75;                                                    ///< on a surface that faces up
  double ground = 0.4;                                                  ///< on a surface that faces down
  double sun = 0.3;                                                     ///< on a surface that faces the sun
  Eigen::Vector3d to_sun_in_world = Eigen::Vector3d(-0.3, 0.4, 0.866);  ///< direction; any length above 0
  bool shadows = false;                                                 ///< whether objects cast shadows
  double shadow_softness_m = 0.1;                                       ///< width of a shadow's edge

  void ListFields(FieldList& fields);
};

struct RenderOptions {
  int background = 128;   ///< grey level, 0 to 255
  int supersampling = 2;  ///< samples along each side of a pixel: its square is the samples a pixel

  void ListFields(FieldList& fields);
};

/// All images have the size of the camera image. Depth and instance of a pixel are those of the ray through its centre;
/// a blended surface counts where its alpha is 0.5 or more.
struct RenderedView {
  cv::Mat bgr;        ///< CV_8UC3, sRGB
  cv::Mat depth_m;    ///< CV_32FC1, depth along the optical axis; NaN for background
  cv::Mat mask;       ///< CV_8UC1, coverage of the pixel: 0 to 255
  cv::Mat instances;  ///< CV_32SC1, index of the visible instance; -1 for background
};

/// Handle of a mesh uploaded to a renderer.
enum class MeshId : int {};

struct MeshInstance {
  MeshId mesh = {};
  Rigid3 world_from_mesh;
};

struct RendererOptions {
  bool software = false;  ///< never use a GPU: results do not depend on the GPU of the machine
};

/// Owns an OpenGL context. Not thread-safe, and bound to the thread that created it: use one renderer per thread. The
/// same input gives the same pixels on the same device.
class Renderer {
 public:
  /// Error: kInternal, no device supports OpenGL 3.3.
  [[nodiscard]] static Expected<Renderer> Create(const RendererOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// The name of the device, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] const std::string& device() const;

  /// Copies a mesh to the device, where it stays until Remove() or the end of the renderer. Error: kInternal, e.g. the
  /// device is out of memory.
  [[nodiscard]] Expected<MeshId> Upload(const Mesh& mesh);
  void Remove(MeshId mesh);

  /// Draws the instances. Cost in software: about 10 ms for 320 x 320 pixels on two cores.
  /// Errors: kInvalidArgument (camera, light or options out of range, unknown mesh); kInternal.
  [[nodiscard]] Expected<RenderedView> Render(std::span<const MeshInstance> instances, const PosedCamera& camera,
                                              const Light& light = {}, const RenderOptions& options = {});

 private:
  class Device;
  explicit Renderer(std::unique_ptr<Device> device);

  std::unique_ptr<Device> device_;
};

}  // namespace victorious
