// Builds an ObjectModel from images of an object, one view each. Shared by photo_model.h and cad_model.h.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// An image of the object, ready for feature extraction.
struct ObjectImage {
  std::string source;  ///< the path as given; for a rendering also its direction
  cv::Mat grey;        ///< CV_8UC1
  cv::Mat mask;        ///< CV_8UC1, 0 outside the object; empty: the whole of `outline` is object
  Polygon outline;     ///< of the object, px; the centre of the first pixel is at 0.5
  cv::Mat thumbnail;   ///< CV_8UC3, MakeThumbnail() of the colour image
  cv::Point origin;    ///< of `grey` and `mask` in the pixels of `outline`, if they are a part of a larger image
};

struct ObjectFeatureOptions {
  int margin_px = 24;              ///< margin around the object in the image that features are computed from
  double min_mask_fraction = 0.0;  ///< minimum fraction of a descriptor's support region that is object, 0 to 1
};

/// Appends one feature to `to`: `keypoint` with the descriptor of feature `i` of `from`.
void AppendFeature(const Keypoint& keypoint, const FeatureSet& from, std::size_t i, FeatureSet& to);

/// Extracts the features that lie on the object. Keypoints are in the pixels of the outline. Errors: those of the
/// extractor.
[[nodiscard]] Expected<FeatureSet> ExtractObjectFeatures(const ObjectImage& image, const FeatureExtractor& extractor,
                                                         const ObjectFeatureOptions& options);

/// The number of features whose descriptor support region is object by at least the given fraction.
std::size_t CountObjectFeatures(const ObjectImage& image, const FeatureSet& features, double min_mask_fraction);

/// The object's outline in a mask (not 0: object): the simplified contour of the largest connected component, or the
/// convex hull of all components if the largest has 80 % of the area or less. Clockwise on the screen; empty for an
/// empty mask.
Polygon FindMaskOutline(const cv::Mat& mask);

/// Crops `part` (clipped to the image) and downscales it so that its longest side has at most `side_px` pixels. Never
/// enlarges.
cv::Mat MakeThumbnail(const cv::Mat& bgr, const Box& part, int side_px);

/// Collects views. The model's features are stored view by view, in the order of the calls.
class ModelBuilder {
 public:
  /// @param view       its feature range, thumbnail and surface are set by the builder
  /// @param points     3D points of the features in the model frame, one per feature; or empty
  /// @param thumbnail  of ObjectImage
  /// @param surface    the bytes of EncodeSurface(), or empty
  [[nodiscard]] Status Add(ModelView view, const FeatureSet& features, const std::vector<Point3>& points,
                           const cv::Mat& thumbnail, std::vector<std::byte> surface = {});

  /// A view without a thumbnail and a surface: matching needs neither.
  void AddWithoutThumbnail(ModelView view, const FeatureView& features) {
    Append(std::move(view), features, {}, {}, {});
  }

  /// A view of another model, as it is.
  void AddViewOf(const ObjectModel& model, std::size_t view);

  /// @param model  the other fields of the model
  /// @return `model` with the views, features and their storage
  [[nodiscard]] ObjectModel Finish(ObjectModel model) &&;

 private:
  void Append(ModelView view, const FeatureView& features, std::span<const Point3> points,
              std::vector<std::byte> thumbnail, std::vector<std::byte> surface);

  std::vector<ModelView> views_;
  FeatureSet features_;
  std::vector<Point3> points_;
  std::vector<std::vector<std::byte>> thumbnails_;  // JPEG, one a view
  std::vector<std::vector<std::byte>> surfaces_;    // one a view
};

}  // namespace victorious
