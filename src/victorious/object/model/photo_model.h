// Makes an ObjectModel from photos of an object, one view each. An alpha channel or a box marks the object.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/box.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/model_builder.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A photo of the object; `source` is its path as given.
using Photo = ObjectImage;

struct PhotoModelOptions {
  FeatureOptions features;
  int margin_px = 24;
  int min_features = 4;

  void ListFields(FieldList& fields);
};

/// Reads a photo. The object is the opaque part inside the box; without a box, the opaque part; without transparency,
/// the box or the whole photo.
/// Errors: those of ReadImage; kInvalidArgument if the box is empty or not inside the photo, or if no pixel of the
/// object is opaque.
[[nodiscard]] Expected<Photo> LoadPhoto(const std::filesystem::path& path, const std::optional<Box>& box);

/// The same from an image in memory.
/// @param bgr    CV_8UC3
/// @param alpha  CV_8UC1 or empty
[[nodiscard]] Expected<Photo> PreparePhoto(const std::string& source, const cv::Mat& bgr, const cv::Mat& alpha,
                                           const std::optional<Box>& box);

/// The options of which a model of photos was made. Errors: kInvalidArgument for a CAD model, or for options that this
/// program does not know.
[[nodiscard]] Expected<PhotoModelOptions> OptionsOf(const ObjectModel& model);

/// `known` with one view more, the last one. @param features  ExtractObjectFeatures() of the photo, with the options of
/// `known`. Errors: those of encoding its thumbnail.
[[nodiscard]] Expected<ObjectModel> WithView(const ObjectModel& known, const Photo& photo, const FeatureSet& features);

/// A model of photos without views yet. @param length_m  the object's longest side, if known, m
[[nodiscard]] ObjectModel EmptyPhotoModel(const std::string& name, std::optional<double> length_m,
                                          const PhotoModelOptions& options);

/// @param length_m  the object's longest side, if known, m
/// Errors: kInvalidArgument for options out of range, no photos, or a photo with fewer than options.min_features
/// keypoints on the object.
[[nodiscard]] Expected<ObjectModel> MakePhotoModel(const std::string& name, std::span<const Photo> photos,
                                                   std::optional<double> length_m, const PhotoModelOptions& options);

}  // namespace victorious
