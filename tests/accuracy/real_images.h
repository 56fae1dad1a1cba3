// Real images with ground truth: $VICTORIOUS_DATA/real/recognition.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious::testing {

/// Path relative to $VICTORIOUS_DATA.
inline constexpr std::string_view kRecognitionData = "real/recognition";

/// The features of a grey image by the default engine.
FeatureSet ExtractFeatures(const cv::Mat& grey);

/// A model of one photo, with the default options.
ObjectModel MakeModel(const std::string& name, const cv::Mat& bgr, const std::optional<Box>& box = std::nullopt);

Recognizer MakeRecognizer(std::vector<ObjectModel> models, const RecognizeOptions& options = {});

/// A series of images of a planar scene: img1.png, img2.png, …, and the homographies H1to2p, … from the first image.
class Series {
 public:
  /// @param name  "graf", "boat" or "wall"
  explicit Series(std::string_view name);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] cv::Mat ReadBgr(int number) const;
  /// The homography image_from_first, for the first pixel's centre at (0.5, 0.5). (The files use centres at
  /// integers.)
  [[nodiscard]] Eigen::Matrix3d HomographyFromFirst(int number) const;

 private:
  std::string name_;
  std::filesystem::path folder_;
};

/// The homography from template to scene by OpenCV's SIFT, matcher and RANSAC, as a reference.
Eigen::Matrix3d EstimateHomographyByOpenCv(const cv::Mat& template_grey, const cv::Mat& scene_grey);

Polygon Project(const Polygon& outline, const Eigen::Matrix3d& map);

/// The intersection over union of a found outline and the true one (convex): whole, and clipped to the image.
struct OutlineOverlap {
  double whole = 0;
  double in_view = 0;
};
OutlineOverlap CompareOutlines(const Polygon& found, const Polygon& truth, const cv::Size& image);

}  // namespace victorious::testing
