#include "tests/accuracy/real_images.h"

#include <fstream>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

#include "testing/data.h"
#include "victorious/base/check.h"
#include "victorious/geometry/homography.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/photo_model.h"

namespace victorious::testing {

FeatureSet ExtractFeatures(const cv::Mat& grey) { return MakeFeatureExtractor({}).value()->Extract(grey).value(); }

ObjectModel MakeModel(const std::string& name, const cv::Mat& bgr, const std::optional<Box>& box) {
  const Photo photo = PreparePhoto(name, bgr, cv::Mat(), box).value();
  return MakePhotoModel(name, std::span(&photo, 1), std::nullopt, {}).value();
}

Recognizer MakeRecognizer(std::vector<ObjectModel> models, const RecognizeOptions& options) {
  return Recognizer::Create(std::move(models), FeatureOptions().engine, options).value();
}

Series::Series(std::string_view name)
    : name_(name), folder_(DataPath(kRecognitionData) / "oxford_affine" / std::string(name)) {}

cv::Mat Series::ReadBgr(int number) const { return ReadImage(folder_ / fmt::format("img{}.png", number)).value().bgr; }

Eigen::Matrix3d Series::HomographyFromFirst(int number) const {
  std::ifstream file(folder_ / fmt::format("H1to{}p", number));
  Eigen::Matrix3d map;
  for (int i = 0; i < 9; ++i) file >> map(i / 3, i % 3);
  VICTORIOUS_CHECK(static_cast<bool>(file));
  Eigen::Matrix3d half = Eigen::Matrix3d::Identity();
  half(0, 2) = half(1, 2) = 0.5;
  return half * map * half.inverse();
}

Eigen::Matrix3d EstimateHomographyByOpenCv(const cv::Mat& template_grey, const cv::Mat& scene_grey) {
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create();
  std::vector<cv::KeyPoint> template_points;
  std::vector<cv::KeyPoint> scene_points;
  cv::Mat template_descriptors;
  cv::Mat scene_descriptors;
  sift->detectAndCompute(template_grey, cv::noArray(), template_points, template_descriptors);
  sift->detectAndCompute(scene_grey, cv::noArray(), scene_points, scene_descriptors);
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher().knnMatch(template_descriptors, scene_descriptors, nearest, 2);
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const auto& two : nearest) {
    if (two.size() < 2 || two[0].distance >= 0.75F * two[1].distance) continue;
    from.push_back(template_points[static_cast<std::size_t>(two[0].queryIdx)].pt);
    to.push_back(scene_points[static_cast<std::size_t>(two[0].trainIdx)].pt);
  }
  const cv::Mat map = cv::findHomography(from, to, cv::RANSAC, 3.0);
  VICTORIOUS_CHECK(map.type() == CV_64F && map.rows == 3);
  Eigen::Matrix3d result;
  for (int i = 0; i < 9; ++i) result(i / 3, i % 3) = map.at<double>(i / 3, i % 3);
  return result;
}

Polygon Project(const Polygon& outline, const Eigen::Matrix3d& map) {
  Polygon projected;
  for (const Eigen::Vector2d& corner : outline) projected.push_back(ApplyHomography(map, corner));
  return projected;
}

OutlineOverlap CompareOutlines(const Polygon& found, const Polygon& truth, const cv::Size& image) {
  const Box frame{0, 0, static_cast<double>(image.width), static_cast<double>(image.height)};
  return {IntersectionOverUnion(found, truth), IntersectionOverUnion(ClipToBox(found, frame), ClipToBox(truth, frame))};
}

}  // namespace victorious::testing
