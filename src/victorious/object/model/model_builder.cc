#include "victorious/object/model/model_builder.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

// Radius of a descriptor's support region in units of the keypoint's scale: it has 4 x 4 cells of 3 sigma each; the
// outer ones have low weight.
constexpr float kDescriptorReach = 4.5F;

// The fraction of a square that is object, from the integral image of the mask.
// @param origin  of the mask, px
double ObjectFraction(const cv::Mat& integral, const cv::Point& origin, float x, float y, float reach) {
  const int x0 = std::clamp(static_cast<int>(std::floor(x - reach)) - origin.x, 0, integral.cols - 1);
  const int y0 = std::clamp(static_cast<int>(std::floor(y - reach)) - origin.y, 0, integral.rows - 1);
  const int x1 = std::clamp(static_cast<int>(std::ceil(x + reach)) - origin.x, 0, integral.cols - 1);
  const int y1 = std::clamp(static_cast<int>(std::ceil(y + reach)) - origin.y, 0, integral.rows - 1);
  const int inside =
      integral.at<int>(y1, x1) - integral.at<int>(y0, x1) - integral.at<int>(y1, x0) + integral.at<int>(y0, x0);
  const double area = 4.0 * reach * reach;
  return inside / std::max(1.0, area);
}

// Predicate: the keypoint lies on the object, and enough of its descriptor's support region does.
class ObjectKeypointFilter {
 public:
  ObjectKeypointFilter(const ObjectImage& image, double min_fraction)
      : bounds_(BoundingBox(image.outline)), mask_(image.mask), origin_(image.origin), min_fraction_(min_fraction) {
    if (!mask_.empty() && min_fraction > 0) cv::integral((mask_ != 0) / 255, integral_, CV_32S);
  }

  [[nodiscard]] bool operator()(const Keypoint& keypoint) const {
    if (!bounds_.Contains(keypoint.x, keypoint.y)) return false;
    if (mask_.empty()) return true;
    const int column = std::clamp(static_cast<int>(keypoint.x) - origin_.x, 0, mask_.cols - 1);
    const int row = std::clamp(static_cast<int>(keypoint.y) - origin_.y, 0, mask_.rows - 1);
    if (mask_.at<std::uint8_t>(row, column) == 0) return false;
    return integral_.empty() || ObjectFraction(integral_, origin_, keypoint.x, keypoint.y,
                                               kDescriptorReach * keypoint.scale_px) >= min_fraction_;
  }

 private:
  Box bounds_;
  cv::Mat mask_;
  cv::Point origin_;
  double min_fraction_;
  cv::Mat integral_;
};

// A crop around the object with a margin; beyond the image the border pixels are replicated.
struct PaddedCrop {
  cv::Mat grey;
  int x = 0;  // position of the crop's left upper corner in the pixels of the outline
  int y = 0;
};

PaddedCrop CropWithMargin(const ObjectImage& image, int margin) {
  const Box bounds = BoundingBox(image.outline);
  const int x0 = static_cast<int>(std::floor(bounds.x)) - margin;
  const int y0 = static_cast<int>(std::floor(bounds.y)) - margin;
  const int x1 = static_cast<int>(std::ceil(bounds.x + bounds.width)) + margin;
  const int y1 = static_cast<int>(std::ceil(bounds.y + bounds.height)) + margin;
  const cv::Rect inside = cv::Rect(x0, y0, x1 - x0, y1 - y0) & cv::Rect(image.origin, image.grey.size());
  PaddedCrop result{.grey = {}, .x = x0, .y = y0};
  cv::copyMakeBorder(image.grey(inside - image.origin), result.grey, inside.y - y0, y1 - inside.br().y, inside.x - x0,
                     x1 - inside.br().x, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  return result;
}

}  // namespace

void AppendFeature(const Keypoint& keypoint, const FeatureSet& from, std::size_t i, FeatureSet& to) {
  to.keypoints.push_back(keypoint);
  const auto descriptor = from.View().Descriptor(i);
  to.descriptors.insert(to.descriptors.end(), descriptor.begin(), descriptor.end());
}

Expected<FeatureSet> ExtractObjectFeatures(const ObjectImage& image, const FeatureExtractor& extractor,
                                           const ObjectFeatureOptions& options) {
  const PaddedCrop crop = CropWithMargin(image, options.margin_px);
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet all, extractor.Extract(crop.grey));
  FeatureSet kept;
  kept.image_width = image.grey.cols;
  kept.image_height = image.grey.rows;
  kept.keypoints.reserve(all.size());
  kept.descriptors.reserve(all.descriptors.size());
  const ObjectKeypointFilter on_object(image, options.min_mask_fraction);
  for (std::size_t i = 0; i < all.size(); ++i) {
    Keypoint keypoint = all.keypoints[i];
    keypoint.x += static_cast<float>(crop.x);
    keypoint.y += static_cast<float>(crop.y);
    if (!on_object(keypoint)) continue;
    AppendFeature(keypoint, all, i, kept);
  }
  return kept;
}

std::size_t CountObjectFeatures(const ObjectImage& image, const FeatureSet& features, double min_mask_fraction) {
  const ObjectKeypointFilter on_object(image, min_mask_fraction);
  return static_cast<std::size_t>(std::ranges::count_if(features.keypoints, on_object));
}

Polygon FindMaskOutline(const cv::Mat& mask) {
  // Contours pass through the centres of the outermost pixels. On a mask upsampled by 2 they are within a quarter pixel
  // of the edge.
  cv::Mat doubled;
  cv::resize(mask, doubled, {}, 2, 2, cv::INTER_NEAREST);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(doubled, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  double total = 0;
  for (const auto& contour : contours) total += cv::contourArea(contour);
  const auto largest =
      std::ranges::max_element(contours, {}, [](const auto& contour) { return cv::contourArea(contour); });
  std::vector<cv::Point> corners;
  if (largest != contours.end() && cv::contourArea(*largest) > 0.8 * total && total > 0) {
    cv::approxPolyDP(*largest, corners, 0.004 * cv::arcLength(*largest, true), true);
  } else {
    std::vector<cv::Point> all;
    for (const auto& contour : contours) all.insert(all.end(), contour.begin(), contour.end());
    if (!all.empty()) cv::convexHull(all, corners);
  }
  Polygon outline;
  for (const cv::Point& corner : corners) outline.emplace_back((corner.x + 0.5) / 2, (corner.y + 0.5) / 2);
  if (SignedArea(outline) < 0) std::ranges::reverse(outline);
  return outline;
}

cv::Mat MakeThumbnail(const cv::Mat& bgr, const Box& part, int side_px) {
  const cv::Rect2d wanted(part.x, part.y, part.width, part.height);
  const cv::Mat cut = bgr(cv::Rect(wanted) & cv::Rect({0, 0}, bgr.size()));
  const double factor = static_cast<double>(side_px) / std::max(cut.cols, cut.rows);
  if (factor >= 1) return cut.clone();
  cv::Mat small;
  cv::resize(cut, small, {std::max(1, cvRound(cut.cols * factor)), std::max(1, cvRound(cut.rows * factor))}, 0, 0,
             cv::INTER_AREA);
  return small;
}

Status ModelBuilder::Add(ModelView view, const FeatureSet& features, const std::vector<Point3>& points,
                         const cv::Mat& thumbnail, std::vector<std::byte> surface) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<std::byte> jpeg, EncodeJpeg(thumbnail));
  Append(std::move(view), features.View(), points, std::move(jpeg), std::move(surface));
  return {};
}

void ModelBuilder::AddViewOf(const ObjectModel& model, std::size_t view) {
  const ModelView& of_model = model.views[view];
  Append(of_model, model.ViewFeatures(view), model.ViewPoints(view),
         {of_model.thumbnail.begin(), of_model.thumbnail.end()}, {of_model.surface.begin(), of_model.surface.end()});
}

void ModelBuilder::Append(ModelView view, const FeatureView& features, std::span<const Point3> points,
                          std::vector<std::byte> thumbnail, std::vector<std::byte> surface) {
  thumbnails_.push_back(std::move(thumbnail));
  surfaces_.push_back(std::move(surface));
  view.first_feature = features_.size();
  view.feature_count = features.size();
  views_.push_back(std::move(view));
  features_.keypoints.insert(features_.keypoints.end(), features.keypoints.begin(), features.keypoints.end());
  features_.descriptors.insert(features_.descriptors.end(), features.descriptors.begin(), features.descriptors.end());
  points_.insert(points_.end(), points.begin(), points.end());
}

ObjectModel ModelBuilder::Finish(ObjectModel model) && {
  struct Storage {
    FeatureSet features;
    std::vector<Point3> points;
    std::vector<std::vector<std::byte>> thumbnails;
    std::vector<std::vector<std::byte>> surfaces;
  };
  const auto storage = std::make_shared<const Storage>(std::move(features_), std::move(points_), std::move(thumbnails_),
                                                       std::move(surfaces_));
  model.views = std::move(views_);
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    model.views[i].thumbnail = storage->thumbnails[i];
    model.views[i].surface = storage->surfaces[i];
  }
  model.features = storage->features.View();
  model.points_in_model = storage->points;
  model.storage = storage;
  return model;
}

}  // namespace victorious
