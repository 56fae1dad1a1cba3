#include "victorious/object/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "victorious/input/image/srgb.h"
#include "victorious/object/render/egl_context.h"
#include "victorious/object/render/gl_objects.h"
#include "victorious/object/render/gl_program.h"
#include "victorious/object/render/gl_targets.h"
#include "victorious/object/render/gpu_mesh.h"
#include "victorious/object/render/shaders.h"
#include "victorious/object/render/shadow_view.h"

namespace victorious {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3d;

float LinearFromGrey(int grey) { return static_cast<float>(LinearFromSrgb(grey / 255.0)); }

// Blended surfaces with at least this alpha are drawn as opaque, with depth writes. Exporters often mark whole models
// as blended, and depth sorting alone is wrong where triangles overlap in depth.
constexpr float kOpaqueAlpha = 0.99F;
constexpr float kNoLimit = 1e9F;
// Blended surfaces with at least this alpha are in the depth map and cast shadows.
constexpr float kMinSolidAlpha = 0.5F;
constexpr int kMaxShadowTexels = 4096;  // maximum side of the shadow map
constexpr int kShadowUnit = 1;          // texture unit of the shadow map; material textures use unit 0

// OpenGL takes the byte offset into the bound element buffer as a pointer.
const void* ElementsFrom(std::size_t offset) {
  return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
}

// Near and far clipping planes, m.
struct DepthRange {
  double near_m;
  double far_m;
};

// Projection matrix to OpenGL clip space, but with y down: the first row of the framebuffer is the first image row.
Matrix4f ClipFromCamera(const PinholeCamera& camera, const DepthRange& range) {
  const double depth = range.far_m - range.near_m;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip.row(0) << 2 * camera.fx / camera.width, 0, 2 * camera.cx / camera.width - 1, 0;
  clip.row(1) << 0, 2 * camera.fy / camera.height, 2 * camera.cy / camera.height - 1, 0;
  clip.row(2) << 0, 0, (range.far_m + range.near_m) / depth, -2 * range.far_m * range.near_m / depth;
  clip.row(3) << 0, 0, 1, 0;
  return clip.cast<float>();
}

struct Programs {
  static Expected<Programs> Make() {
    const auto mesh = [](std::initializer_list<const char*> fragment) {
      return GlProgram::Make(shaders::kMeshVertex, fragment);
    };
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram colour,
                                mesh({shaders::kMeshFragmentHead, shaders::kNoShadow, shaders::kColourFragment}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram shaded,
                                mesh({shaders::kMeshFragmentHead, shaders::kShadow, shaders::kColourFragment}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram depth, mesh({shaders::kMeshFragmentHead, shaders::kDepthFragment}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram opaque_depth, mesh({shaders::kOpaqueDepthFragment}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram opaque_caster, mesh({shaders::kOpaqueCaster}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram masked_caster, mesh({shaders::kMeshFragmentHead, shaders::kMaskedCaster}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram resolve,
                                GlProgram::Make(shaders::kScreenVertex, {shaders::kResolveFragment}));
    return Programs{std::move(colour),        std::move(shaded),        std::move(depth),  std::move(opaque_depth),
                    std::move(opaque_caster), std::move(masked_caster), std::move(resolve)};
  }

  GlProgram colour;
  GlProgram shaded_colour;
  GlProgram depth;
  GlProgram opaque_depth;
  GlProgram opaque_caster;  // shadow map of opaque materials
  GlProgram masked_caster;  // shadow map of masked and blended materials
  GlProgram resolve;
};

// A blended triangle of the current image, for depth sorting.
struct Blended {
  float depth_m;
  std::uint32_t instance;
  const GpuMesh::BlendedTriangle* triangle;
};

Status CheckCamera(const PinholeCamera& camera) {
  const bool finite = std::isfinite(camera.cx) && std::isfinite(camera.cy) && std::isfinite(camera.fx + camera.fy);
  if (finite && camera.fx > 0 && camera.fy > 0 && camera.width > 0 && camera.height > 0) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("a camera of {} x {} pixels and focal lengths {}, {}: all must be above 0", camera.width,
                          camera.height, camera.fx, camera.fy));
}

}  // namespace

void Light::ListFields(FieldList& fields) {
  fields.Add("sky", sky, {.min = 0, .max = 10, .reason = "light from above; 1 renders a white roof white"});
  fields.Add("ground", ground, {.min = 0, .max = 10, .reason = "light from below, reflected by the ground"});
  fields.Add("sun", sun, {.min = 0, .max = 10, .reason = "weak, so that templates hardly depend on its direction"});
  fields.Add("shadows", shadows, {.reason = "whether objects cast shadows; off for templates"});
  fields.Add("shadow_softness_m", shadow_softness_m,
             {.min = 0.001, .max = 100, .unit = "m", .reason = "width of a shadow's edge; that of a house's shadow"});
}

void RenderOptions::ListFields(FieldList& fields) {
  fields.Add("background", background,
             {.min = 0, .max = 255, .reason = "grey level; a middle grey gives weak edges against any object"});
  fields.Add("supersampling", supersampling,
             {.min = 1, .max = 8, .reason = "samples along each side of a pixel; 4 a pixel smooth edges enough"});
}

class Renderer::Device {
 public:
  static Expected<std::unique_ptr<Device>> Create(const RendererOptions& options) {
    VICTORIOUS_ASSIGN_OR_RETURN(EglContext context, EglContext::Create(options.software));
    VICTORIOUS_ASSIGN_OR_RETURN(Programs programs, Programs::Make());
    return std::make_unique<Device>(std::move(context), std::move(programs));
  }

  Device(EglContext context, Programs programs)
      : context_(std::move(context)),
        programs_(std::move(programs)),
        name_(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) {
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &max_side_px_);
    glFrontFace(GL_CW);  // y is down
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
  }

  ~Device() { std::ignore = context_.MakeCurrent(); }  // the destructors of the members need it
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }

  Expected<MeshId> Upload(const Mesh& mesh) {
    VICTORIOUS_RETURN_IF_ERROR(context_.MakeCurrent());
    GpuMesh uploaded(mesh);
    VICTORIOUS_RETURN_IF_ERROR(CheckGl("hold a mesh"));
    const auto id = static_cast<MeshId>(next_id_++);
    meshes_.emplace(id, std::move(uploaded));
    return id;
  }

  void Remove(MeshId mesh) {
    if (context_.MakeCurrent()) meshes_.erase(mesh);
  }

  Expected<RenderedView> Render(std::span<const MeshInstance> instances, const PosedCamera& camera, const Light& light,
                                const RenderOptions& options) {
    VICTORIOUS_RETURN_IF_ERROR(CheckInput(instances, camera.pinhole, light, options));
    VICTORIOUS_RETURN_IF_ERROR(context_.MakeCurrent());
    PrepareTargets(camera.pinhole, options.supersampling);
    PrepareInstances(instances, camera);
    RenderedView view;
    GlProgram& colour = light.shadows && DrawShadowMap(camera, light) ? programs_.shaded_colour : programs_.colour;
    DrawColour(colour, camera, light, options.background);
    ReadColour(view);
    DrawDepth();
    ReadDepth(view);
    VICTORIOUS_RETURN_IF_ERROR(CheckGl("draw"));
    return view;
  }

 private:
  struct PlacedMesh {
    const GpuMesh* mesh;
    Rigid3 world_from_mesh;
    Matrix4f camera_from_mesh;
  };

  static Status CheckGl(const char* what) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return {};
    while (glGetError() != GL_NO_ERROR) {
    }
    return Fail(ErrorCode::kInternal, fmt::format("the renderer cannot {} (OpenGL error {:#x})", what, error));
  }

  Status CheckInput(std::span<const MeshInstance> instances, const PinholeCamera& camera, const Light& light,
                    const RenderOptions& options) const {
    VICTORIOUS_RETURN_IF_ERROR(CheckCamera(camera));
    VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(light));
    VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
    if (!(light.to_sun_in_world.norm() > 0)) {
      return Fail(ErrorCode::kInvalidArgument, "the sun's direction is a zero vector: its length must be above 0");
    }
    const int largest = max_side_px_ / options.supersampling;
    if (std::max(camera.width, camera.height) > largest) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} x {} pixels with supersampling {}: this device draws at most {} a side", camera.width,
                              camera.height, options.supersampling, largest));
    }
    for (const MeshInstance& instance : instances) {
      if (!meshes_.contains(instance.mesh)) {
        return Fail(ErrorCode::kInvalidArgument,
                    fmt::format("mesh {}: this renderer holds no such mesh", static_cast<int>(instance.mesh)));
      }
    }
    return {};
  }

  void PrepareTargets(const PinholeCamera& camera, int supersampling) {
    const bool fits = targets_ && targets_->width == camera.width && targets_->height == camera.height &&
                      targets_->supersampling == supersampling;
    if (!fits) {
      targets_.reset();
      targets_.emplace(camera.width, camera.height, supersampling);
    }
  }

  void PrepareInstances(std::span<const MeshInstance> instances, const PosedCamera& camera) {
    placed_.clear();
    blended_.clear();
    double nearest_m = std::numeric_limits<double>::infinity();
    double farthest_m = 0;
    for (const MeshInstance& instance : instances) {
      const GpuMesh& mesh = meshes_.at(instance.mesh);
      const Rigid3 camera_from_mesh = camera.camera_from_world * instance.world_from_mesh;
      for (int corner = 0; corner < 8 && !mesh.box().isEmpty(); ++corner) {
        const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
        const double depth = camera_from_mesh.Apply(mesh.box().corner(type)).z();
        nearest_m = std::min(nearest_m, depth);
        farthest_m = std::max(farthest_m, depth);
      }
      const Matrix4f matrix = camera_from_mesh.Matrix().cast<float>();
      const auto index = static_cast<std::uint32_t>(placed_.size());
      for (const GpuMesh::BlendedTriangle& triangle : mesh.blended()) {
        blended_.push_back({(matrix * triangle.centre.homogeneous()).z(), index, &triangle});
      }
      placed_.push_back({&mesh, instance.world_from_mesh, matrix});
    }
    std::ranges::stable_sort(blended_, std::greater(), &Blended::depth_m);
    // For a camera inside the scene the near plane is at 1e-4 of the far plane.
    constexpr double kMargin = 0.01;
    const double far_m = farthest_m > 0 ? farthest_m * (1 + kMargin) : 1.0;
    const double near_m = std::clamp(nearest_m * (1 - kMargin), far_m * 1e-4, far_m * (1 - kMargin));
    clip_from_camera_ = ClipFromCamera(camera.pinhole, {near_m, far_m});
  }

  static void SetMaterial(GlProgram& program, const GpuMesh& mesh, const Material& material,
                          const Eigen::Vector2f& alpha_range) {
    program.Set("alpha_range", alpha_range);
    program.Set("base_colour", material.base_colour);
    program.Set("double_sided", material.double_sided ? 1 : 0);
    mesh.BindTexture(material);
  }

  static void HideBacks(const Material& material) {
    if (material.double_sided) {
      glDisable(GL_CULL_FACE);
    } else {
      glEnable(GL_CULL_FACE);
    }
  }

  // Draws a part; of blended materials only fragments with an alpha of at least `min_alpha`.
  static void DrawPart(GlProgram& program, const GpuMesh& mesh, const MeshPart& part, float min_alpha) {
    const Material& material = mesh.MaterialOf(part);
    const float cutoffs[] = {0.0F, material.alpha_cutoff, min_alpha};
    SetMaterial(program, mesh, material, {cutoffs[static_cast<std::size_t>(material.alpha_mode)], kNoLimit});
    const std::size_t offset = std::size_t{part.first_triangle} * 3 * sizeof(std::uint32_t);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.triangles * 3), GL_UNSIGNED_INT, ElementsFrom(offset));
  }

  static void Begin(const Target& target, float grey) {
    target.Bind();
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    target.Clear(grey);
  }

  void Use(GlProgram& program, std::size_t placed) const {
    program.Use();
    program.Set("clip_from_camera", clip_from_camera_);
    program.Set("camera_from_mesh", placed_[placed].camera_from_mesh);
    program.Set("instance", static_cast<float>(placed));
  }

  // @param opaque  for opaque materials; may be the same as `program`
  void DrawSolid(GlProgram& opaque, GlProgram& program, float min_alpha) const {
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      const GpuMesh& mesh = *placed_[i].mesh;
      mesh.BindVertices();
      const GlProgram* used = nullptr;
      for (const MeshPart& part : mesh.parts()) {
        const Material& material = mesh.MaterialOf(part);
        GlProgram& needed = material.alpha_mode == AlphaMode::kOpaque ? opaque : program;
        if (std::exchange(used, &needed) != &needed) Use(needed, i);
        HideBacks(material);
        DrawPart(needed, mesh, part, min_alpha);
      }
    }
  }

  // Draws the blended triangles that DrawSolid() skipped, back to front, batched by material.
  void DrawBlended(GlProgram& program) {
    if (blended_.empty()) return;
    std::vector<std::array<std::uint32_t, 3>> corners(blended_.size());
    std::ranges::transform(blended_, corners.begin(), [](const Blended& blended) { return blended.triangle->corners; });
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    program.Set("blended", 1);
    bool uploaded = false;
    for (std::size_t begin = 0, end = 0; begin < blended_.size(); begin = end) {
      const Blended& first = blended_[begin];
      while (end < blended_.size() && blended_[end].instance == first.instance &&
             blended_[end].triangle->part == first.triangle->part) {
        ++end;
      }
      const PlacedMesh& placed = placed_[first.instance];
      placed.mesh->BindVertices();
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, sorted_elements_.name());
      if (!std::exchange(uploaded, true)) {
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(corners[0])),
                     corners.data(), GL_STREAM_DRAW);
      }
      program.Set("camera_from_mesh", placed.camera_from_mesh);
      const MeshPart& part = placed.mesh->parts()[static_cast<std::size_t>(first.triangle->part)];
      HideBacks(placed.mesh->MaterialOf(part));
      SetMaterial(program, *placed.mesh, placed.mesh->MaterialOf(part), {0.0F, kOpaqueAlpha});
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>((end - begin) * 3), GL_UNSIGNED_INT,
                     ElementsFrom(begin * sizeof(corners[0])));
    }
  }

  // Renders the shadow map and sets it in the program `shaded_colour`. False if the camera sees no mesh.
  bool DrawShadowMap(const PosedCamera& camera, const Light& light) {
    std::vector<PlacedBox> boxes(placed_.size());
    std::ranges::transform(placed_, boxes.begin(), [](const PlacedMesh& placed) {
      return PlacedBox{.box = placed.mesh->box(), .world_from_box = placed.world_from_mesh};
    });
    const auto view = FitShadowView(boxes, camera, light.to_sun_in_world, light.shadow_softness_m);
    if (!view) return false;
    const double step_m = light.shadow_softness_m / 3;
    const Eigen::Vector2i texels = ShadowTexels(view->box_in_sun.sizes().head<2>(), step_m);
    if (!shadow_map_) shadow_map_.emplace();
    shadow_map_->Begin(texels.x(), texels.y());
    DrawCasters(*view);
    SetShadow(*view, camera, texels, step_m);
    return true;
  }

  // Size of the shadow map, rounded up to a multiple of 256: a moving camera can reuse the texture.
  [[nodiscard]] Eigen::Vector2i ShadowTexels(const Eigen::Vector2d& size_m, double texel_m) const {
    constexpr double kStep = 256;
    const double most = std::min(kMaxShadowTexels, int{max_side_px_});
    return (kStep * (size_m / (kStep * texel_m)).array().ceil()).min(most).cast<int>();
  }

  void DrawCasters(const ShadowView& view) {
    const Vector3d scale = 2 * view.box_in_sun.sizes().cwiseInverse();
    const Eigen::Affine3d clip_from_sun = Eigen::Scaling(scale) * Eigen::Translation3d(-view.box_in_sun.center());
    for (GlProgram* program : {&programs_.opaque_caster, &programs_.masked_caster}) {
      program->Use();
      program->Set("clip_from_camera", Matrix4f(clip_from_sun.matrix().cast<float>()));
      for (std::size_t i = 0; i < placed_.size(); ++i) {
        if (!view.casts_shadow[i]) continue;
        const GpuMesh& mesh = *placed_[i].mesh;
        mesh.BindVertices();
        const Rigid3 sun_from_mesh = view.sun_from_world * placed_[i].world_from_mesh;
        program->Set("camera_from_mesh", Matrix4f(sun_from_mesh.Matrix().cast<float>()));
        for (const MeshPart& part : mesh.parts()) {
          const bool opaque = mesh.MaterialOf(part).alpha_mode == AlphaMode::kOpaque;
          if (opaque == (program == &programs_.opaque_caster)) DrawPart(*program, mesh, part, kMinSolidAlpha);
        }
      }
    }
  }

  void SetShadow(const ShadowView& view, const PosedCamera& camera, const Eigen::Vector2i& texels, double step_m) {
    GlProgram& program = programs_.shaded_colour;
    program.Use();
    program.Set("sun_depth", kShadowUnit);
    const Rigid3 sun_from_camera = view.sun_from_world * camera.camera_from_world.Inverse();
    program.Set("sun_from_camera", Matrix4f(sun_from_camera.Matrix().cast<float>()));
    program.Set("sun_low", Eigen::Vector3f(view.box_in_sun.min().cast<float>()));
    program.Set("sun_size", Eigen::Vector3f(view.box_in_sun.sizes().cast<float>()));
    const Eigen::Array2d texel_m = view.box_in_sun.sizes().head<2>().array() / texels.cast<double>().array();
    program.Set("texel_m", Eigen::Vector2f(texel_m.cast<float>()));
    program.Set("step_m", Eigen::Vector2f(texel_m.max(step_m).cast<float>()));
    glActiveTexture(GL_TEXTURE0 + kShadowUnit);
    shadow_map_->BindTexture();
    glActiveTexture(GL_TEXTURE0);
  }

  void DrawColour(GlProgram& program, const PosedCamera& camera, const Light& light, int background) {
    Begin(targets_->colour, LinearFromGrey(background));
    program.Use();
    program.Set("clip_from_camera", clip_from_camera_);
    const Eigen::Quaterniond& turn = camera.camera_from_world.rotation;
    program.Set("up_in_camera", Eigen::Vector3f((turn * Vector3d::UnitZ()).cast<float>()));
    program.Set("to_sun_in_camera", Eigen::Vector3f((turn * light.to_sun_in_world.normalized()).cast<float>()));
    program.Set("light", Eigen::Vector3f(Vector3d(light.sky, light.ground, light.sun).cast<float>()));
    program.Set("blended", 0);
    DrawSolid(program, program, kOpaqueAlpha);
    DrawBlended(program);
  }

  void ReadColour(RenderedView& view) {
    targets_->resolved.Bind();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    programs_.resolve.Use();
    programs_.resolve.Set("supersampling", targets_->supersampling);
    targets_->colour.BindTexture();
    glBindVertexArray(screen_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    const cv::Mat bgra(targets_->height, targets_->width, CV_8UC4);
    glReadPixels(0, 0, bgra.cols, bgra.rows, GL_RGBA, GL_UNSIGNED_BYTE, bgra.data);  // the shader put blue first
    view.bgr.create(bgra.size(), CV_8UC3);
    view.mask.create(bgra.size(), CV_8UC1);
    constexpr int kFromTo[] = {0, 0, 1, 1, 2, 2, 3, 3};
    cv::Mat split[] = {view.bgr, view.mask};
    cv::mixChannels(&bgra, 1, split, 2, kFromTo, 4);
  }

  void DrawDepth() {
    Begin(targets_->depth, 0);
    DrawSolid(programs_.opaque_depth, programs_.depth, kMinSolidAlpha);
  }

  void ReadDepth(RenderedView& view) const {
    cv::Mat depth_and_instance(targets_->height, targets_->width, CV_32FC2);
    glReadPixels(0, 0, depth_and_instance.cols, depth_and_instance.rows, GL_RG, GL_FLOAT, depth_and_instance.data);
    view.depth_m.create(depth_and_instance.size(), CV_32FC1);
    view.instances.create(depth_and_instance.size(), CV_32SC1);
    for (int row = 0; row < depth_and_instance.rows; ++row) {
      const auto* from = depth_and_instance.ptr<cv::Vec2f>(row);
      auto* depth = view.depth_m.ptr<float>(row);
      auto* instance = view.instances.ptr<std::int32_t>(row);
      for (int col = 0; col < depth_and_instance.cols; ++col) {
        const bool seen = from[col][0] > 0;
        depth[col] = seen ? from[col][0] : std::numeric_limits<float>::quiet_NaN();
        instance[col] = seen ? static_cast<std::int32_t>(from[col][1]) : -1;
      }
    }
  }

  EglContext context_;  // first, so that it is destroyed last
  Programs programs_;
  std::string name_;
  GLint max_side_px_ = 0;
  GlVertexArray screen_;
  GlBuffer sorted_elements_;
  std::optional<Targets> targets_;
  std::optional<ShadowMap> shadow_map_;
  std::map<MeshId, GpuMesh> meshes_;
  int next_id_ = 0;
  // State of the current image.
  std::vector<PlacedMesh> placed_;
  std::vector<Blended> blended_;
  Matrix4f clip_from_camera_ = Matrix4f::Identity();
};

Renderer::Renderer(std::unique_ptr<Device> device) : device_(std::move(device)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Expected<Renderer> Renderer::Create(const RendererOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto device, Device::Create(options));
  return Renderer(std::move(device));
}

const std::string& Renderer::device() const { return device_->name(); }

Expected<MeshId> Renderer::Upload(const Mesh& mesh) { return device_->Upload(mesh); }

void Renderer::Remove(MeshId mesh) { device_->Remove(mesh); }

Expected<RenderedView> Renderer::Render(std::span<const MeshInstance> instances, const PosedCamera& camera,
                                        const Light& light, const RenderOptions& options) {
  return device_->Render(instances, camera, light, options);
}

}  // namespace victorious
