// Pictures of an object in, one view each; an ObjectModel out. What photos and renderings share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A picture of the object, ready for features.
struct ObjectPicture {
  std::string source;  ///< the path as given, or which view of it
  cv::Mat grey;        ///< CV_8UC1
  cv::Mat mask;        ///< CV_8UC1, 0 outside the object; empty: all of `outline` is object
  Polygon outline;     ///< of the object, px, the first pixel's centre at 0.5
  cv::Mat thumbnail;   ///< CV_8UC3, ThumbnailOf() the picture in colour
};

struct OnObjectOptions {
  int margin_px = 24;             ///< of the object's surroundings that features are computed from, too
  double least_mask_share = 0.0;  ///< of a keypoint's surroundings that must be object, 0 to 1 (CadModelOptions)
};

/// Appends one feature to `to`: `keypoint`, with the descriptor of feature `i` of `from`.
void AppendFeature(const Keypoint& keypoint, const FeatureSet& from, std::size_t i, FeatureSet& to);

/// The picture's features that lie on the object, in pixels of the picture.
Expected<FeatureSet> FeaturesOnObject(const ObjectPicture& picture, const FeatureExtractor& extractor,
                                      const OnObjectOptions& options);

/// How many of the features are of the object itself: their surroundings are object by that share at least.
std::size_t CountOnObject(const ObjectPicture& picture, const FeatureSet& features, double least_mask_share);

/// The object's outline in its mask (not 0: object): the contour of its largest part, simplified; the hull of all parts
/// where the largest is not most of it. Clockwise on the screen; empty for an empty mask.
Polygon OutlineOfMask(const cv::Mat& mask);

/// A part of a picture, reduced so that its longest side has at most `side_px`; what lies outside the picture is left
/// out.
cv::Mat ThumbnailOf(const cv::Mat& bgr, const Box& part, int side_px);

/// Gathers views. The model's features lie one view after the other.
class ModelBuilder {
 public:
  /// @param view       without its features' range, its thumbnail and its surface, which are set here
  /// @param points     the features' places on the object, one each, or none
  /// @param thumbnail  ObjectPicture's
  /// @param surface    EncodeSurface()'s bytes, or none
  Status Add(ModelView view, const FeatureSet& features, const std::vector<Point3>& points, const cv::Mat& thumbnail,
             std::vector<std::byte> surface = {});

  /// @param model  what a model has beside views and features; completed and returned
  [[nodiscard]] ObjectModel Finish(ObjectModel model) &&;

 private:
  std::vector<ModelView> views_;
  FeatureSet features_;
  std::vector<Point3> points_;
  std::vector<std::vector<std::byte>> thumbnails_;  // JPEG, one a view
  std::vector<std::vector<std::byte>> surfaces_;    // one a view
};

}  // namespace victorious
