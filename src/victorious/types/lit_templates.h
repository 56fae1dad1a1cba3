// What a model's views are beyond their features: as another light would show them, and how bright each place is.
#pragma once

#include <compare>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// What a view's features are under another light, in the view's pixels.
struct LitTemplate {
  FeatureSet features;
  std::vector<Point3> points_in_model;  ///< a feature's place on the object, metres
};

/// A view under the sun that stands where another view's camera does.
struct LitView {
  std::size_t sun_view;
  std::size_t view;
  bool coarse = false;  ///< of a picture of half the size: the larger keypoints alone, for a quarter of the work

  auto operator<=>(const LitView&) const = default;
};

/// A place on the object, and how bright a view's rendering shows it.
struct PicturePoint {
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  ///< m, from the picture's middle, in the model's axes
  float brightness = 0;                             ///< 0 to 255
};

/// A view's rendering as points of the object: seen from another side nearby, they lie elsewhere in the image.
struct ViewPicture {
  std::vector<PicturePoint> points;  ///< evenly over the object, its rim left out; none where the model cannot tell
  Eigen::Quaterniond camera_from_model = Eigen::Quaterniond::Identity();
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  ///< of the points: where the view shows it
  double pixels_per_m = 1;                              ///< of the view, there
};

/// A picture is blurred by so much, in pixels of the scene that it is compared with.
inline constexpr double kPictureBlur_px = 1.5;

/// Any number of threads may ask at once.
class LitTemplates {
 public:
  virtual ~LitTemplates() = default;

  /// Never null; without features where the model cannot tell. The same each time.
  [[nodiscard]] virtual std::shared_ptr<const LitTemplate> Under(const LitView& wanted) const = 0;

  /// Makes what will be asked for: threads that need the same share the work, instead of waiting for each other at one
  /// after the other.
  virtual void Prepare(std::span<const LitView> wanted) const = 0;

  /// Of a view as it was rendered. Never null; the same each time.
  /// @param half_octaves  the scene shows the object smaller than the view by 2^(half_octaves / 2)
  [[nodiscard]] virtual std::shared_ptr<const ViewPicture> Picture(std::size_t view, int half_octaves) const = 0;
};

}  // namespace victorious
