// Interface between recognize/ and model/: templates of a CAD model relit by a sun, and the brightness of a view's
// surface points for NCC scores. model/ implements it by re-rendering the stored surface of a view.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/base/error.h"
#include "victorious/object/features/descriptor_cells.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"
#include "victorious/types/surface_point.h"

namespace victorious {

/// The features of a view rendered under another light, in the view's pixels.
struct RelitTemplate {
  FeatureSet features;
  std::vector<Point3> points_in_model;  ///< the surface point of each feature, model frame, m
  ShortDescriptors shortened;           ///< of the features
};

/// Key of a relit template: a view, and the sun's direction quantised to the direction of another view's camera.
struct RelitTemplateKey {
  std::size_t sun_view;          ///< index of the view whose camera lies nearest to the sun's direction
  std::size_t view;              ///< index of the rendered view
  bool half_resolution = false;  ///< rendered at half resolution: only the larger keypoints, at a quarter of the cost

  auto operator<=>(const RelitTemplateKey&) const = default;
};

/// A surface point and its rendered brightness.
struct SurfaceSample {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();  ///< relative to the centroid of the samples, model axes
  float brightness = 0;                                  ///< 0 to 255
};

/// The rendering of a view as 3D surface samples, so that it can be reprojected from nearby directions.
struct ViewAppearance {
  std::vector<SurfaceSample> points;  ///< uniform over the object without its rim; empty if the object is too small
  Eigen::Quaterniond camera_from_model = Eigen::Quaterniond::Identity();
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();  ///< projection of the samples' centroid into the view, px
  double pixels_per_m = 1;                              ///< scale of the view at the centroid
};

/// The surface that a view shows, and where the view shows it.
struct RenderedSurface {
  VisibleSurface surface;
  Eigen::Vector3d centre_in_model_m = Eigen::Vector3d::Zero();  ///< that of the object's bounding box
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();          ///< its projection into the view, px
  double pixels_per_m = 1;                                      ///< scale of the view there
};

/// Standard deviation of the Gaussian blur of rendering and scene, in scene pixels.
inline constexpr double kAppearanceBlur_px = 1.5;

/// Source of relit templates and surface samples. Thread-safe.
class RelitTemplateSource {
 public:
  virtual ~RelitTemplateSource() = default;

  /// The relit template of `wanted`. Never null; may be without features. Deterministic.
  /// Errors: kDataLoss for a damaged rendering in the model; those of the feature extractor.
  [[nodiscard]] virtual Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(
      const RelitTemplateKey& wanted) const = 0;

  /// Renders and caches templates that will be queried: threads that need the same templates share the work instead of
  /// waiting for each other template by template. Errors are left to GetTemplate.
  virtual void Prepare(std::span<const RelitTemplateKey> wanted) const = 0;

  /// The surface samples of a view under the light of its original rendering. Never null; deterministic.
  /// @param half_octaves  the object is smaller in the scene than in the view by the factor 2^(half_octaves / 2)
  /// Errors: kDataLoss for a damaged rendering in the model.
  [[nodiscard]] virtual Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t view,
                                                                                      int half_octaves) const = 0;

  /// The surface of a view, from its rendering at half resolution. Deterministic.
  /// Errors: kDataLoss for a damaged rendering in the model.
  [[nodiscard]] virtual Expected<RenderedSurface> GetSurface(std::size_t view) const = 0;

  /// The edges that a view shows, from its rendering: some hundred points, evenly spaced. Deterministic. Without any
  /// for a source without renderings.
  /// Errors: kDataLoss for a damaged rendering in the model.
  [[nodiscard]] virtual Expected<std::vector<ContourPoint>> GetContours(std::size_t /*view*/) const {
    return std::vector<ContourPoint>{};
  }

  /// Bytes that Keep() kept of this model for this build of the program, now or in an earlier search. std::nullopt if
  /// they are not there, as of a source without a folder on disk.
  /// @param name  of a file
  [[nodiscard]] virtual std::optional<std::vector<std::byte>> FindKept(const std::string& /*name*/) const {
    return std::nullopt;
  }
  /// Keeps bytes beside the relit templates on disk, if they are kept there. What cannot be written is no error.
  virtual void Keep(const std::string& /*name*/, std::span<const std::byte> /*bytes*/) const {}
};

}  // namespace victorious
