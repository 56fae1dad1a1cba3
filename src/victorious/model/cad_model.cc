#include "victorious/model/cad_model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/version.h"
#include "victorious/geometry/angles.h"
#include "victorious/model/model_builder.h"

namespace victorious {

void CadModelOptions::ListFields(FieldList& fields) {
  fields.AddGroup("features", features);
  fields.AddGroup("sphere", sphere);
  fields.AddGroup("light", light);
  fields.AddGroup("render", render);
  fields.Add("object_size_px", object_size_px,
             {.min = 32,
              .max = 2048,
              .unit = "px",
              .reason = "diameter of the object's bounding sphere in the templates: about as large as it appears in "
                        "the video, or larger"});
  fields.Add("distance_radii", distance_radii,
             {.min = 1.5,
              .max = 1e6,
              .reason = "from the camera to the object's centre, in radii of its bounding sphere: far, so that "
                        "perspective is weak"});
  fields.Add("least_mask_share", least_mask_share,
             {.min = 0,
              .max = 1,
              .reason = "the share of a keypoint's surroundings that must be object: near the outline a descriptor "
                        "carries background"});
  fields.Add("least_features", least_features,
             {.min = 1, .max = 100000, .reason = "a view with fewer keypoints on the object finds nothing"});
}

namespace {

// What is left of a rendering once features are to be found: the picture, and where its pixels lie.
struct RenderedTemplate {
  ObjectPicture picture;
  cv::Mat depth_m;
  PosedCamera camera;
  ViewSphere::View view;
};

Expected<RenderedTemplate> RenderTemplate(Renderer& renderer, MeshId mesh, const Sphere& sphere,
                                          const ViewSphere::View& view, const std::string& source,
                                          const CadModelOptions& options) {
  constexpr int kRoomPx = 16;  // around the sphere's outline
  const int side = options.object_size_px + 2 * kRoomPx;
  VICTORIOUS_ASSIGN_OR_RETURN(PosedCamera camera,
                              CameraForView(view.direction, sphere,
                                            {.distance_m = options.distance_radii * sphere.radius,
                                             .diameter_px = static_cast<double>(options.object_size_px),
                                             .width_px = side,
                                             .height_px = side}));
  const MeshInstance instance{.mesh = mesh, .world_from_mesh = {}};
  VICTORIOUS_ASSIGN_OR_RETURN(RenderedView rendered,
                              renderer.Render(std::span(&instance, 1), camera, options.light, options.render));
  RenderedTemplate result{.picture = {.source = fmt::format("{} from azimuth {:.0f}, off-nadir {:.0f} degrees", source,
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
  const Box whole{0, 0, static_cast<double>(side), static_cast<double>(side)};  // so that all are of one scale
  result.picture.thumbnail = ThumbnailOf(rendered.bgr, whole, kThumbnailPx);
  cv::cvtColor(rendered.bgr, result.picture.grey, cv::COLOR_BGR2GRAY);
  result.picture.outline = OutlineOfMask(result.picture.mask);
  return result;
}

// A keypoint's place on the object; nothing where the rendering has no depth.
std::optional<Point3> PlaceOf(const Keypoint& keypoint, const RenderedTemplate& rendered,
                              const Rigid3& model_from_camera) {
  const int column = std::clamp(static_cast<int>(keypoint.x), 0, rendered.depth_m.cols - 1);
  const int row = std::clamp(static_cast<int>(keypoint.y), 0, rendered.depth_m.rows - 1);
  const double depth = rendered.depth_m.at<float>(row, column);
  if (!std::isfinite(depth)) return std::nullopt;
  const Eigen::Vector3d place =
      model_from_camera.Apply(depth * rendered.camera.pinhole.RayOf({keypoint.x, keypoint.y}));
  return Point3{static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(place.z())};
}

struct TemplateFeatures {
  FeatureSet features;
  std::vector<Point3> points;
};

// The features that have a place on the object.
Expected<TemplateFeatures> FeaturesOf(const RenderedTemplate& rendered, const FeatureExtractor& extractor,
                                      const CadModelOptions& options) {
  TemplateFeatures result;
  if (rendered.picture.outline.size() < 3) return result;
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet all, FeaturesOnObject(rendered.picture, extractor,
                                                                     {.least_mask_share = options.least_mask_share}));
  const Rigid3 model_from_camera = rendered.camera.camera_from_world.Inverse();
  result.features.image_width = all.image_width;
  result.features.image_height = all.image_height;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::optional<Point3> place = PlaceOf(all.keypoints[i], rendered, model_from_camera);
    if (!place) continue;
    AppendFeature(all.keypoints[i], all, i, result.features);
    result.points.push_back(*place);
  }
  if (result.features.size() < static_cast<std::size_t>(options.least_features)) result = {};
  return result;
}

}  // namespace

Expected<ObjectModel> MakeCadModel(const std::string& name, const Mesh& mesh, const std::string& source,
                                   const CadModelOptions& options, const std::function<void(int, int)>& progress) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const ViewSphere sphere, MakeViewSphere(options.sphere));
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create());
  VICTORIOUS_ASSIGN_OR_RETURN(const MeshId uploaded, renderer.Upload(mesh));
  const Sphere bounds = BoundingSphere(mesh);
  const int count = static_cast<int>(sphere.views.size());

  // Rendered one after the other (the renderer belongs to one thread), a chunk at a time; then features on all cores.
  constexpr int kChunk = 32;
  ModelBuilder builder;
  std::size_t most_features = 0;
  for (int first = 0; first < count; first += kChunk) {
    const int size = std::min(kChunk, count - first);
    std::vector<RenderedTemplate> rendered;
    for (int i = first; i < first + size; ++i) {
      VICTORIOUS_ASSIGN_OR_RETURN(
          RenderedTemplate view,
          RenderTemplate(renderer, uploaded, bounds, sphere.views[static_cast<std::size_t>(i)], source, options));
      rendered.push_back(std::move(view));
    }
    std::vector<Expected<TemplateFeatures>> features(rendered.size());
    oneapi::tbb::parallel_for(std::size_t{0}, rendered.size(),
                              [&](std::size_t i) { features[i] = FeaturesOf(rendered[i], *extractor, options); });
    for (std::size_t i = 0; i < rendered.size(); ++i) {
      if (!features[i]) return std::unexpected(std::move(features[i]).error());
      const RenderedTemplate& view = rendered[i];
      ModelView model_view{.source = view.picture.source,
                           .width = view.picture.grey.cols,
                           .height = view.picture.grey.rows,
                           .outline = view.picture.outline.size() < 3 ? Polygon() : view.picture.outline,
                           .angles = ViewAngles{view.view.direction.azimuth_rad, view.view.direction.off_nadir_rad},
                           .neighbours = {view.view.neighbours.begin(), view.view.neighbours.end()},
                           .thumbnail = {}};
      most_features = std::max(most_features, features[i]->features.size());
      VICTORIOUS_RETURN_IF_ERROR(
          builder.Add(std::move(model_view), features[i]->features, features[i]->points, view.picture.thumbnail));
    }
    if (progress) progress(first + size, count);
  }
  if (most_features == 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no view has {} features or more: the model needs texture, or a larger object_size_px",
                            source, options.least_features));
  }
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  return std::move(builder).Finish({.name = name,
                                    .id = {},
                                    .kind = "cad",
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
