// What is searched for: an object's views, each with its features, made once from photos (later from CAD) and kept in a
// file. Only the model library makes these; the stages read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "victorious/geometry/polygon.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Where the camera stood when a view was made, seen from the model (the thesis's latitude and longitude).
struct ViewAngles {
  double azimuth_rad = 0;    ///< atan2(d.left, -d.front): 0 behind the model, pi/2 on its left, pi in front
  double off_nadir_rad = 0;  ///< acos(d.up): 0 straight above
};

/// A place on the object: x to its front, y to its left, z up, metres. Stored as it stands in model files.
struct Point3 {
  float x = 0;
  float y = 0;
  float z = 0;

  bool operator==(const Point3&) const = default;
};
static_assert(sizeof(Point3) == 12);

/// One template: a picture of the object.
struct ModelView {
  std::string source;               ///< the photo's path as given
  int width = 0;                    ///< px, of the picture the features were taken from
  int height = 0;                   ///< px
  std::uint64_t first_feature = 0;  ///< into the model's features
  std::uint64_t feature_count = 0;
  Polygon outline;                        ///< of the object in the picture, px
  std::optional<ViewAngles> angles;       ///< unknown for photos
  std::vector<std::uint32_t> neighbours;  ///< views from nearby directions, by number; none for photos
  std::span<const std::byte> thumbnail;   ///< a small picture of it, JPEG, for people; empty: there is none
  std::span<const std::byte> surface;     ///< its rendering, to be lit anew (model/view_surface.h); empty: none
};

/// Immutable once made; copies share the feature storage.
struct ObjectModel {
  std::string name;
  std::string id;                  ///< checksum of what searching depends on: two models of one id find the same
  std::string kind;                ///< "photos" or "cad"
  std::string engine;              ///< the feature engine's name
  std::string options_json;        ///< the options that made it
  std::string program_version;     ///< the version that made it
  std::optional<double> length_m;  ///< the longest side (of a glTF along its front), if known
  std::optional<Eigen::AlignedBox3d> box_m;  ///< bounding box: x front, y left, z up; unknown for photos
  std::vector<ModelView> views;
  FeatureView features;                     ///< of all views, one after the other
  std::span<const Point3> points_in_model;  ///< a feature's place on the object, metres; empty for photos
  std::shared_ptr<const void> storage;      ///< what the spans here point into

  [[nodiscard]] FeatureView ViewFeatures(std::size_t view) const {
    return features.Slice(views[view].first_feature, views[view].feature_count);
  }
};

}  // namespace victorious
