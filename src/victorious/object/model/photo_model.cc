#include "victorious/object/model/photo_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/version.h"
#include "victorious/input/image/image_file.h"

namespace victorious {

void PhotoModelOptions::ListFields(FieldList& fields) {
  fields.AddGroup("features", features);
  fields.Add("margin_px", margin_px,
             {.min = 0,
              .max = 512,
              .unit = "px",
              .reason = "margin around the object in the image that features are computed from; beyond the photo its "
                        "border is replicated, so that keypoints near the border are found"});
  fields.Add("min_features", min_features,
             {.min = 1, .max = 100000, .reason = "a photo with fewer keypoints on the object is refused"});
}

namespace {

constexpr int kOpaque = 128;       // pixels with at least this alpha are object
constexpr int kThumbnailPx = 160;  // larger than for renderings, because a model has few photos

Status CheckBox(const std::string& source, const Box& box, const cv::Size& size) {
  const bool inside = box.x >= 0 && box.y >= 0 && box.x + box.width <= size.width && box.y + box.height <= size.height;
  if (!box.IsEmpty() && inside) return {};
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: the box {:g},{:g},{:g},{:g} must lie inside the photo (x,y,w,h in pixels, within 0,0,{},{})",
                  source, box.x, box.y, box.width, box.height, size.width, size.height));
}

// Sets the background to the object's mean grey, so that its outline gives few keypoints.
cv::Mat FlattenBackground(const cv::Mat& grey, const cv::Mat& mask) {
  const double mean = cv::mean(grey, mask)[0];
  cv::Mat result(grey.size(), CV_8UC1, cv::Scalar(mean));
  grey.copyTo(result, mask);
  return result;
}

Status AddPhoto(const Photo& photo, const FeatureSet& features, ModelBuilder& builder) {
  return builder.Add({.source = photo.source,
                      .width = photo.grey.cols,
                      .height = photo.grey.rows,
                      .outline = photo.outline,
                      .angles = {},
                      .neighbours = {},
                      .thumbnail = {}},
                     features, {}, photo.thumbnail);
}

}  // namespace

Expected<Photo> LoadPhoto(const std::filesystem::path& path, const std::optional<Box>& box) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(path));
  return PreparePhoto(path.string(), image.bgr, image.alpha, box);
}

Expected<Photo> PreparePhoto(const std::string& source, const cv::Mat& bgr, const cv::Mat& alpha,
                             const std::optional<Box>& box) {
  Photo photo{.source = source, .grey = GreyFromBgr(bgr), .mask = {}, .outline = {}, .thumbnail = {}};
  const Box whole = FrameBox(bgr.cols, bgr.rows);
  if (box) VICTORIOUS_RETURN_IF_ERROR(CheckBox(source, *box, bgr.size()));
  photo.outline = BoxCorners(box.value_or(whole));
  photo.thumbnail = MakeThumbnail(bgr, box.value_or(whole), kThumbnailPx);
  if (alpha.empty() || cv::countNonZero(alpha < kOpaque) == 0) return photo;  // fully opaque, e.g. a screenshot

  photo.mask = alpha >= kOpaque;
  if (box) {
    cv::Mat inside = cv::Mat::zeros(alpha.size(), CV_8UC1);
    inside(cv::Rect(cv::Point(static_cast<int>(box->x), static_cast<int>(box->y)),
                    cv::Point(static_cast<int>(std::ceil(box->x + box->width)),
                              static_cast<int>(std::ceil(box->y + box->height))))) = 255;
    photo.mask &= inside;
  }
  if (cv::countNonZero(photo.mask) == 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no pixel of the object is opaque: the alpha channel is transparent {}", source,
                            box ? "in the box" : "everywhere"));
  }
  photo.outline = FindMaskOutline(photo.mask);
  if (std::abs(SignedArea(photo.outline)) < 1) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: the opaque part of the alpha channel has no area", source));
  }
  photo.grey = FlattenBackground(photo.grey, photo.mask);
  photo.thumbnail = MakeThumbnail(bgr, BoundingBox(photo.outline), kThumbnailPx);
  return photo;
}

ObjectModel EmptyPhotoModel(const std::string& name, std::optional<double> length_m, const PhotoModelOptions& options) {
  return {.name = name,
          .id = {},
          .kind = ModelKind::kPhotos,
          .engine = options.features.engine,
          .options_json = OptionsToJsonText(options),
          .program_version = kVersion,
          .length_m = length_m,
          .views = {},
          .features = {},
          .storage = {}};
}

Expected<PhotoModelOptions> OptionsOf(const ObjectModel& model) {
  if (model.kind != ModelKind::kPhotos) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: it is of a CAD file, which has all views: give a model of photos", model.name));
  }
  PhotoModelOptions options;
  const Status set = SetFromJsonText(model.options_json, CollectFields(options));
  if (set && options.features.engine == model.engine) return options;
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("model {}: it was made with options that this program does not know ({}): add its photos again",
                  model.name, set ? "its engine is another one" : set.error().message));
}

Expected<ObjectModel> WithView(const ObjectModel& known, const Photo& photo, const FeatureSet& features) {
  ModelBuilder builder;
  for (std::size_t view = 0; view < known.views.size(); ++view) builder.AddViewOf(known, view);
  VICTORIOUS_RETURN_IF_ERROR(AddPhoto(photo, features, builder));
  ObjectModel model = known;
  model.program_version = kVersion;
  return std::move(builder).Finish(std::move(model));
}

Expected<ObjectModel> MakePhotoModel(const std::string& name, std::span<const Photo> photos,
                                     std::optional<double> length_m, const PhotoModelOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (photos.empty())
    return Fail(ErrorCode::kInvalidArgument, fmt::format("model {}: at least one photo is needed", name));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  ModelBuilder builder;
  for (const Photo& photo : photos) {
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features,
                                ExtractObjectFeatures(photo, *extractor, {.margin_px = options.margin_px}));
    if (features.size() < static_cast<std::size_t>(options.min_features)) {
      return Fail(
          ErrorCode::kInvalidArgument,
          fmt::format("{}: {} features on the object, at least {} are needed: give a larger or sharper photo of "
                      "a textured side",
                      photo.source, features.size(), options.min_features));
    }
    VICTORIOUS_RETURN_IF_ERROR(AddPhoto(photo, features, builder));
  }
  return std::move(builder).Finish(EmptyPhotoModel(name, length_m, options));
}

}  // namespace victorious
