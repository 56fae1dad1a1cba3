#include "victorious/render/renderer.h"

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

#include "victorious/render/egl_context.h"
#include "victorious/render/gl_objects.h"
#include "victorious/render/gl_program.h"
#include "victorious/render/gpu_mesh.h"
#include "victorious/render/shaders.h"

namespace victorious {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3d;

float LinearFromGrey(int grey) {
  const double value = grey / 255.0;
  return static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

// Blended surfaces hide what lies behind them from this alpha on. Exporters like to call whole models blended, and
// sorting alone draws those wrong wherever triangles reach past each other.
constexpr float kAsGoodAsOpaque = 0.99F;
constexpr float kNoLimit = 1e9F;

// OpenGL takes an offset into the bound elements as a pointer.
const void* ElementsFrom(std::size_t offset) {
  return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
}

// The range of depths that the picture needs, m.
struct DepthRange {
  double near_m;
  double far_m;
};

// Clip space as OpenGL has it, but with y down: its first row is then the picture's first.
Matrix4f ClipFromCamera(const PinholeCamera& camera, const DepthRange& range) {
  const double depth = range.far_m - range.near_m;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip.row(0) << 2 * camera.fx / camera.width, 0, 2 * camera.cx / camera.width - 1, 0;
  clip.row(1) << 0, 2 * camera.fy / camera.height, 2 * camera.cy / camera.height - 1, 0;
  clip.row(2) << 0, 0, (range.far_m + range.near_m) / depth, -2 * range.far_m * range.near_m / depth;
  clip.row(3) << 0, 0, 1, 0;
  return clip.cast<float>();
}

// A colour and a depth target of one size.
class Target {
 public:
  Target(int width, int height, GLenum format) : width_(width), height_(height) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glBindTexture(GL_TEXTURE_2D, colour_.name());
    Allocate(format);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_.name(), 0);
    glBindRenderbuffer(GL_RENDERBUFFER, depth_.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  }

  void Bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, width_, height_);
  }
  void Clear(float grey) const {
    glClearColor(grey, grey, grey, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  void BindTexture() const { glBindTexture(GL_TEXTURE_2D, colour_.name()); }

 private:
  void Allocate(GLenum format) const {
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width_, height_, 0, GL_RGBA, GL_FLOAT, nullptr);
  }

  int width_;
  int height_;
  GlFramebuffer framebuffer_;
  GlTexture colour_;
  GlRenderbuffer depth_;
};

// What the three passes draw into.
struct Targets {
  Targets(int width_px, int height_px, int samples)
      : width(width_px),
        height(height_px),
        supersampling(samples),
        colour(width_px * samples, height_px * samples, GL_RGBA16F),
        resolved(width_px, height_px, GL_RGBA8),
        depth(width_px, height_px, GL_RG32F) {}

  int width;
  int height;
  int supersampling;
  Target colour;
  Target resolved;
  Target depth;
};

// A blended triangle of the picture that is being drawn.
struct Blended {
  float depth_m;
  std::uint32_t instance;
  const GpuMesh::BlendedTriangle* triangle;
};

Status CheckCamera(const PinholeCamera& camera) {
  const bool finite = std::isfinite(camera.cx) && std::isfinite(camera.cy) && std::isfinite(camera.fx + camera.fy);
  if (finite && camera.fx > 0 && camera.fy > 0 && camera.width > 0 && camera.height > 0) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("a camera of {} x {} pixels and focal lengths {}, {}: all above 0 is right", camera.width,
                          camera.height, camera.fx, camera.fy));
}

}  // namespace

void Light::ListFields(FieldList& fields) {
  fields.Add("sky", sky, {.min = 0, .max = 10, .reason = "light from above; 1 makes a white roof white"});
  fields.Add("ground", ground, {.min = 0, .max = 10, .reason = "light from below: what the ground throws back"});
  fields.Add("sun", sun, {.min = 0, .max = 10, .reason = "weak, so that templates do not depend on its place"});
}

void RenderOptions::ListFields(FieldList& fields) {
  fields.Add("background", background, {.min = 0, .max = 255, .reason = "a middle grey: few edges against any object"});
  fields.Add("supersampling", supersampling, {.min = 1, .max = 8, .reason = "4 samples a pixel smooth edges enough"});
}

class Renderer::Device {
 public:
  static Expected<std::unique_ptr<Device>> Create(const RendererOptions& options) {
    VICTORIOUS_ASSIGN_OR_RETURN(EglContext context, EglContext::Create(options.software));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram colour, GlProgram::Make(shaders::kMeshVertex, {shaders::kMeshFragmentHead,
                                                                                         shaders::kColourFragment}));
    VICTORIOUS_ASSIGN_OR_RETURN(
        GlProgram depth, GlProgram::Make(shaders::kMeshVertex, {shaders::kMeshFragmentHead, shaders::kDepthFragment}));
    VICTORIOUS_ASSIGN_OR_RETURN(GlProgram resolve,
                                GlProgram::Make(shaders::kScreenVertex, {shaders::kResolveFragment}));
    return std::make_unique<Device>(std::move(context), std::move(colour), std::move(depth), std::move(resolve));
  }

  Device(EglContext context, GlProgram colour, GlProgram depth, GlProgram resolve)
      : context_(std::move(context)),
        colour_(std::move(colour)),
        depth_(std::move(depth)),
        resolve_(std::move(resolve)),
        name_(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) {
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest_side_px_);
    glFrontFace(GL_CW);  // y is down
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
  }

  ~Device() { std::ignore = context_.MakeCurrent(); }  // the members free themselves in it
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
    DrawColour(camera, light, options.background);
    ReadColour(view);
    DrawDepth();
    ReadDepth(view);
    VICTORIOUS_RETURN_IF_ERROR(CheckGl("draw"));
    return view;
  }

 private:
  struct Placed {
    const GpuMesh* mesh;
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
      return Fail(ErrorCode::kInvalidArgument, "the sun's direction has no length: above 0 is right");
    }
    const int largest = largest_side_px_ / options.supersampling;
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
      placed_.push_back({&mesh, matrix});
    }
    std::ranges::stable_sort(blended_, std::greater(), &Blended::depth_m);
    // A camera amid the scene sees from a ten-thousandth of its depth on.
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
    if (material.double_sided) {
      glDisable(GL_CULL_FACE);
    } else {
      glEnable(GL_CULL_FACE);
    }
    mesh.BindTexture(material);
  }

  void Begin(GlProgram& program, const Target& target, float grey) const {
    target.Bind();
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    target.Clear(grey);
    program.Use();
    program.Set("clip_from_camera", clip_from_camera_);
  }

  // Everything, of blended materials only what has an alpha of `solid_from` or more.
  void DrawSolid(GlProgram& program, float solid_from) const {
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      const GpuMesh& mesh = *placed_[i].mesh;
      mesh.BindVertices();
      program.Set("camera_from_mesh", placed_[i].camera_from_mesh);
      program.Set("instance", static_cast<float>(i));
      for (const MeshPart& part : mesh.parts()) {
        const Material& material = mesh.MaterialOf(part);
        const float cutoffs[] = {0.0F, material.alpha_cutoff, solid_from};
        SetMaterial(program, mesh, material, {cutoffs[static_cast<std::size_t>(material.alpha_mode)], kNoLimit});
        const std::size_t offset = std::size_t{part.first_triangle} * 3 * sizeof(std::uint32_t);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.triangles * 3), GL_UNSIGNED_INT, ElementsFrom(offset));
      }
    }
  }

  // What DrawSolid() left, back to front, in runs of one material.
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
      const Placed& placed = placed_[first.instance];
      placed.mesh->BindVertices();
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, sorted_elements_.name());
      if (!std::exchange(uploaded, true)) {
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(corners[0])),
                     corners.data(), GL_STREAM_DRAW);
      }
      program.Set("camera_from_mesh", placed.camera_from_mesh);
      const MeshPart& part = placed.mesh->parts()[static_cast<std::size_t>(first.triangle->part)];
      SetMaterial(program, *placed.mesh, placed.mesh->MaterialOf(part), {0.0F, kAsGoodAsOpaque});
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>((end - begin) * 3), GL_UNSIGNED_INT,
                     ElementsFrom(begin * sizeof(corners[0])));
    }
  }

  void DrawColour(const PosedCamera& camera, const Light& light, int background) {
    Begin(colour_, targets_->colour, LinearFromGrey(background));
    const Eigen::Quaterniond& turn = camera.camera_from_world.rotation;
    colour_.Set("up_in_camera", Eigen::Vector3f((turn * Vector3d::UnitZ()).cast<float>()));
    colour_.Set("to_sun_in_camera", Eigen::Vector3f((turn * light.to_sun_in_world.normalized()).cast<float>()));
    colour_.Set("light", Eigen::Vector3f(Vector3d(light.sky, light.ground, light.sun).cast<float>()));
    colour_.Set("blended", 0);
    DrawSolid(colour_, kAsGoodAsOpaque);
    DrawBlended(colour_);
  }

  void ReadColour(RenderedView& view) {
    targets_->resolved.Bind();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    resolve_.Use();
    resolve_.Set("supersampling", targets_->supersampling);
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
    constexpr float kSolidFrom = 0.5F;
    Begin(depth_, targets_->depth, 0);
    DrawSolid(depth_, kSolidFrom);
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

  EglContext context_;  // first, so that it ends last
  GlProgram colour_;
  GlProgram depth_;
  GlProgram resolve_;
  std::string name_;
  GLint largest_side_px_ = 0;
  GlVertexArray screen_;
  GlBuffer sorted_elements_;
  std::optional<Targets> targets_;
  std::map<MeshId, GpuMesh> meshes_;
  int next_id_ = 0;
  // Of the picture that is being drawn.
  std::vector<Placed> placed_;
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
