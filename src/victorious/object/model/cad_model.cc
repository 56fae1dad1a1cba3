#include "victorious/object/model/cad_model.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/version.h"
#include "victorious/geometry/angles.h"
#include "victorious/object/model/model_builder.h"
#include "victorious/object/model/template_features.h"
#include "victorious/object/model/view_surface.h"

namespace victorious {

void CadModelOptions::ListFields(FieldList& fields) {
  fields.AddGroup("features", features);
  fields.AddGroup("sphere", sphere);
  fields.AddGroup("light", light);
  fields.AddGroup("render", render);
  fields.Add("pixels_per_m", pixels_per_m,
             {.min = 0.01,
              .max = 1e6,
              .unit = "px/m",
              .reason = "scale of the templates: about that of the object in the video, or larger"});
  fields.Add("min_mask_fraction", min_mask_fraction,
             {.min = 0,
              .max = 1,
              .reason = "minimum fraction of a descriptor's support region that is object: near the outline "
                        "descriptors include background, but on thin parts such as rotors they still help"});
  fields.Add(
      "min_features", min_features,
      {.min = 1, .max = 100000, .reason = "a view with fewer keypoints on the object is stored without features"});
}

namespace {

// A rendering, ready for feature extraction: image, depth map and camera.
struct RenderedTemplate {
  ObjectImage image;
  cv::Mat depth_m;
  PosedCamera camera;
  ViewSphere::View view;
};

Expected<RenderedTemplate> RenderTemplate(Renderer& renderer, MeshId mesh, const Sphere& sphere,
                                          const ViewSphere::View& view, const std::string& source,
                                          const CadModelOptions& options) {
  constexpr int kMarginPx = 16;  // margin around the outline of the bounding sphere
  const int size_px = ObjectSizePx(2 * sphere.radius, options);
  const int side = size_px + 2 * kMarginPx;
  VICTORIOUS_ASSIGN_OR_RETURN(PosedCamera camera, CameraForView(view.direction, sphere,
                                                                {.distance_m = kTemplateDistanceRadii * sphere.radius,
                                                                 .diameter_px = static_cast<double>(size_px),
                                                                 .width_px = side,
                                                                 .height_px = side}));
  const MeshInstance instance{.mesh = mesh, .world_from_mesh = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(RenderedView rendered,
                              renderer.Render(std::span(&instance, 1), camera, options.light, options.render));
  RenderedTemplate result{.image = {.source = fmt::format("{} from azimuth {:.0f}, off-nadir {:.0f} degrees", source,
                                                          DegreesFromRadians(view.direction.azimuth_rad),
                                                          DegreesFromRadians(view.direction.off_nadir_rad)),
                                    .grey = {},
                                    .mask = rendered.mask >= 128,
                                    .outline = {},
                                    .thumbnail = {}},
                          .depth_m = std::move(rendered.depth_m),
                          .camera = camera,
                          .view = view};
  constexpr int kThumbnailPx = 72;
  const Box whole = FrameBox(side, side);  // not cropped: all thumbnails have the same scale
  result.image.thumbnail = MakeThumbnail(rendered.bgr, whole, kThumbnailPx);
  cv::cvtColor(rendered.bgr, result.image.grey, cv::COLOR_BGR2GRAY);
  result.image.outline = FindMaskOutline(result.image.mask);
  return result;
}

// What the model stores of a rendering, and its number of textured features.
struct ProcessedView {
  RelitTemplate features;
  std::size_t textured = 0;  // features on the surface of the object, away from its outline
  std::vector<std::byte> surface;
};

Expected<ProcessedView> MakeView(const RenderedTemplate& rendered, const FeatureExtractor& extractor,
                                 const CadModelOptions& options) {
  ProcessedView made;
  const PosedDepthMap depth_map{rendered.camera, rendered.depth_m};
  VICTORIOUS_ASSIGN_OR_RETURN(made.features, ExtractTemplateFeatures(rendered.image, depth_map, extractor, options));
  constexpr double kMinSurfaceFraction = 0.7;
  made.textured = CountObjectFeatures(rendered.image, made.features.features, kMinSurfaceFraction);
  VICTORIOUS_ASSIGN_OR_RETURN(made.surface, EncodeSurface({rendered.image.grey, depth_map}));
  return made;
}

}  // namespace

int ObjectSizePx(double diameter_m, const CadModelOptions& options) {
  const double size_px = std::min(diameter_m * options.pixels_per_m, static_cast<double>(options.max_size_px));
  return std::max(static_cast<int>(std::lround(size_px)), options.min_size_px);
}

Expected<ObjectModel> MakeCadModel(const std::string& name, const Mesh& mesh, const std::string& source,
                                   const CadModelOptions& options, const std::function<void(int, int)>& progress,
                                   const CancelToken* cancel) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.min_size_px > options.max_size_px) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("min_size_px {}: must be at most max_size_px {}",
                                                         options.min_size_px, options.max_size_px));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const ViewSphere sphere, MakeViewSphere(options.sphere));
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create());
  VICTORIOUS_ASSIGN_OR_RETURN(const MeshId uploaded, renderer.Upload(mesh));
  const Sphere bounds = BoundingSphere(mesh);
  const int count = static_cast<int>(sphere.views.size());

  // Renders a chunk of views sequentially (the renderer belongs to one thread), then extracts features on all cores.
  constexpr int kChunk = 32;
  ModelBuilder builder;
  std::size_t max_textured = 0;
  for (int first = 0; first < count; first += kChunk) {
    const int size = std::min(kChunk, count - first);
    std::vector<RenderedTemplate> rendered;
    for (int i = first; i < first + size; ++i) {
      if (cancel != nullptr && cancel->IsCancelled()) return Fail(ErrorCode::kCancelled, source + ": cancelled");
      VICTORIOUS_ASSIGN_OR_RETURN(
          RenderedTemplate view,
          RenderTemplate(renderer, uploaded, bounds, sphere.views[static_cast<std::size_t>(i)], source, options));
      rendered.push_back(std::move(view));
    }
    std::vector<Expected<ProcessedView>> made(rendered.size());
    oneapi::tbb::parallel_for(std::size_t{0}, rendered.size(),
                              [&](std::size_t i) { made[i] = MakeView(rendered[i], *extractor, options); });
    for (std::size_t i = 0; i < rendered.size(); ++i) {
      if (!made[i]) return std::unexpected(std::move(made[i]).error());
      const RenderedTemplate& view = rendered[i];
      ModelView model_view{.source = view.image.source,
                           .width = view.image.grey.cols,
                           .height = view.image.grey.rows,
                           .outline = view.image.outline.size() < 3 ? Polygon() : view.image.outline,
                           .angles = view.view.direction,
                           .neighbours = {view.view.neighbours.begin(), view.view.neighbours.end()},
                           .thumbnail = {},
                           .surface = {}};
      const RelitTemplate& found = made[i]->features;
      max_textured = std::max(max_textured, made[i]->textured);
      VICTORIOUS_RETURN_IF_ERROR(builder.Add(std::move(model_view), found.features, found.points_in_model,
                                             view.image.thumbnail, std::move(made[i]->surface)));
    }
    if (progress) progress(first + size, count);
  }
  if (max_textured < static_cast<std::size_t>(options.min_features)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no view has {} features or more: the model needs texture, or a larger pixels_per_m",
                            source, options.min_features));
  }
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  return std::move(builder).Finish({.name = name,
                                    .id = {},
                                    .kind = ModelKind::kCad,
                                    .engine = options.features.engine,
                                    .options_json = OptionsToJsonText(options),
                                    .program_version = kVersion,
                                    .length_m = box.sizes().maxCoeff(),
                                    .box_m = box,
                                    .views = {},
                                    .features = {},
                                    .points_in_model = {},
                                    .storage = {}});
}

}  // namespace victorious
