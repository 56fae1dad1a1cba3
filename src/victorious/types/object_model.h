// An object model: views with features, made once from photos or CAD and stored in a file. Only model/ makes these; the
// other stages read them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "victorious/geometry/polygon.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/model_kind.h"

namespace victorious {

/// A surface point in the model frame: x front, y left, z up, metres. Model files store these bytes unchanged.
struct Point3 {
  float x = 0;
  float y = 0;
  float z = 0;

  bool operator==(const Point3&) const = default;
};
static_assert(sizeof(Point3) == 12);

/// One template: an image of the object.
struct ModelView {
  std::string source;               ///< the photo's path as given
  int width = 0;                    ///< px, of the image that the features were extracted from
  int height = 0;                   ///< px
  std::uint64_t first_feature = 0;  ///< index into the model's features
  std::uint64_t feature_count = 0;
  Polygon outline;                        ///< of the object in the image, px
  std::optional<ViewDirection> angles;    ///< from the model to the camera; nullopt for photos
  std::vector<std::uint32_t> neighbours;  ///< indices of the views from nearby directions; empty for photos
  std::span<const std::byte> thumbnail;   ///< small JPEG for display; empty if there is none
  std::span<const std::byte>
      surface;  ///< rendering for relighting (object/model/view_surface.h); empty if there is none
};

/// Immutable; copies share the feature storage.
struct ObjectModel {
  std::string name;
  std::string id;                       ///< checksum of all that a search depends on: models of equal id find the same
  ModelKind kind = ModelKind::kPhotos;  ///< kPhotos or kCad
  std::string engine;                   ///< the feature engine's name
  std::string options_json;             ///< the options of its construction
  std::string program_version;          ///< the program version of its construction
  std::optional<double> length_m;       ///< the longest side (of a glTF: along its front axis), if known
  std::optional<Eigen::AlignedBox3d> box_m;  ///< bounding box: x front, y left, z up; unknown for photos
  std::vector<ModelView> views;
  FeatureView features;                     ///< of all views, concatenated
  std::span<const Point3> points_in_model;  ///< the surface point of each feature, m; empty for photos
  std::shared_ptr<const void> storage;      ///< owner of the memory that the spans refer to

  [[nodiscard]] FeatureView ViewFeatures(std::size_t view) const {
    return features.Slice(views[view].first_feature, views[view].feature_count);
  }
  /// The surface points of a view's features; empty for photos.
  [[nodiscard]] std::span<const Point3> ViewPoints(std::size_t view) const {
    if (points_in_model.empty()) return {};
    return points_in_model.subspan(views[view].first_feature, views[view].feature_count);
  }
};

}  // namespace victorious
