// model/, in: photos of an object, each cut out by an alpha channel or a box. Out: an ObjectModel, one view a photo.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A picture of the object, ready for features.
struct Photo {
  std::string source;  ///< the path as given
  cv::Mat grey;        ///< CV_8UC1
  cv::Mat mask;        ///< CV_8UC1, 0 outside the object; empty: all of `outline` is object
  Polygon outline;     ///< of the object, px
};

struct PhotoModelOptions {
  FeatureOptions features;
  int margin_px = 24;
  int least_features = 4;

  void ListFields(FieldList& fields);
};

/// Reads a photo. The object is what the box encloses, or what the alpha channel shows, or the whole picture.
/// Errors: those of ReadImage; kInvalidArgument for a box that is empty or not inside the photo, or a photo whose alpha
/// channel shows nothing.
Expected<Photo> LoadPhoto(const std::filesystem::path& path, const std::optional<Box>& box);

/// The same from a picture in memory.
/// @param alpha  CV_8UC1 or empty
Expected<Photo> PreparePhoto(const std::string& source, const cv::Mat& bgr, const cv::Mat& alpha,
                             const std::optional<Box>& box);

/// @param length_m  the object's longest side, if known
/// Errors: kInvalidArgument for a photo with fewer than options.least_features keypoints on the object.
Expected<ObjectModel> MakePhotoModel(const std::string& name, std::span<const Photo> photos,
                                     std::optional<double> length_m, const PhotoModelOptions& options);

}  // namespace victorious
