#include "victorious/category/finder/cad_examples.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/render/paste.h"
#include "victorious/object/render/relight.h"
#include "victorious/object/render/renderer.h"

namespace victorious {
namespace {

constexpr int kSize_px = 320;  // rendered diameter of the object's bounding sphere

ViewDirection SampleDirection(double min_off_nadir_deg, double max_off_nadir_deg, Random& random) {
  const double azimuth_rad = random.Uniform(0, 2 * kPi);
  return {azimuth_rad, RadiansFromDegrees(random.Uniform(min_off_nadir_deg, max_off_nadir_deg))};
}

Light SampleLight(Random& random) {
  constexpr double kSunlitFraction = 0.5;  // of the renderings; the others have diffuse light
  constexpr double kLowestSun_deg = 65;    // from the zenith
  const ViewDirection sun = SampleDirection(0, kLowestSun_deg, random);
  if (random.Uniform() >= kSunlitFraction) return {};
  Light light = ClearDayLight(sun);
  light.shadows = true;
  return light;
}

// A random position in a background of this size, at a scale that fills a random fraction of it.
Similarity2 SamplePlacement(const cv::Rect& object, const cv::Size& image, Random& random) {
  constexpr double kMinFilledFraction = 0.6;
  constexpr double kMaxFilledFraction = 0.95;
  const double fraction = random.Uniform(kMinFilledFraction, kMaxFilledFraction);
  Similarity2 place;
  place.scale = fraction * std::min(static_cast<double>(image.width) / object.width,
                                    static_cast<double>(image.height) / object.height);
  const auto shift = [&](double from, double length, double room) {
    return random.Uniform() * (room - place.scale * length) - place.scale * from;
  };
  place.translation.x() = shift(object.x, object.width, image.width);
  place.translation.y() = shift(object.y, object.height, image.height);
  return place;
}

}  // namespace

void CadExampleOptions::ListFields(FieldList& fields) {
  fields.Add("views", views, {.min = 1, .max = 1000, .reason = "renderings per CAD file, from random azimuths"});
  fields.Add("min_off_nadir_deg", min_off_nadir_deg,
             {.min = 0,
              .max = 180,
              .unit = "deg",
              .reason = "minimum off-nadir angle of the renderings: lower for aerial images"});
  fields.Add("max_off_nadir_deg", max_off_nadir_deg,
             {.min = 0,
              .max = 180,
              .unit = "deg",
              .reason = "maximum off-nadir angle of the renderings; above 90 seen from below"});
}

Status CheckRange(const CadExampleOptions& options) {
  if (options.min_off_nadir_deg <= options.max_off_nadir_deg) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("cad.min_off_nadir_deg {:g}: must not exceed cad.max_off_nadir_deg {:g}",
                          options.min_off_nadir_deg, options.max_off_nadir_deg));
}

cv::Mat ResizeBackgroundForCad(const cv::Mat& grey) {
  constexpr double kLongest_px = 1.5 * kSize_px;
  const double scale = kLongest_px / std::max(grey.cols, grey.rows);
  if (scale >= 1) return grey;
  cv::Mat shrunk;
  cv::resize(grey, shrunk, {std::max(1, cvRound(scale * grey.cols)), std::max(1, cvRound(scale * grey.rows))}, 0, 0,
             cv::INTER_AREA);
  return shrunk;
}

Expected<std::vector<LabelledImage>> RenderCadExamples(const Mesh& mesh, const std::string& category,
                                                       std::span<const cv::Mat> backgrounds,
                                                       const CadExampleOptions& options, std::uint64_t seed) {
  VICTORIOUS_CHECK(!backgrounds.empty());
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_RETURN_IF_ERROR(CheckRange(options));
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create());
  VICTORIOUS_ASSIGN_OR_RETURN(const MeshId uploaded, renderer.Upload(mesh));
  const MeshInstance instance{.mesh = uploaded, .world_from_mesh = {}};
  const Sphere sphere = BoundingSphere(mesh);
  constexpr double kDistanceRadii = 12;
  Random random(seed);
  std::vector<LabelledImage> images;
  for (int i = 0; i < options.views; ++i) {
    const ViewDirection from = SampleDirection(options.min_off_nadir_deg, options.max_off_nadir_deg, random);
    VICTORIOUS_ASSIGN_OR_RETURN(const PosedCamera camera, CameraForView(from, sphere,
                                                                        {.distance_m = kDistanceRadii * sphere.radius,
                                                                         .diameter_px = kSize_px,
                                                                         .width_px = kSize_px,
                                                                         .height_px = kSize_px}));
    VICTORIOUS_ASSIGN_OR_RETURN(const RenderedView rendered,
                                renderer.Render(std::span(&instance, 1), camera, SampleLight(random)));
    const cv::Rect seen = cv::boundingRect(rendered.mask);
    if (seen.empty()) continue;  // a flat mesh seen edge-on
    cv::Mat object;
    cv::cvtColor(rendered.bgr, object, cv::COLOR_BGR2GRAY);
    constexpr double kDarkest = 0.6;
    constexpr double kBrightest = 1.5;
    object.convertTo(object, CV_8U, random.Uniform(kDarkest, kBrightest));
    cv::Mat image = backgrounds[random.Below(static_cast<std::uint32_t>(backgrounds.size()))].clone();
    const Similarity2 place = SamplePlacement(seen, image.size(), random);
    Paste(object, rendered.mask, place, image);
    const Eigen::Vector2d corner = place.Apply({seen.x, seen.y});
    images.push_back({.category = category,
                      .grey = std::move(image),
                      .box = Box{corner.x(), corner.y(), place.scale * seen.width, place.scale * seen.height}});
  }
  return images;
}

}  // namespace victorious
