#include "victorious/object/model/template_features.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace victorious {
namespace {

// Back-projects a keypoint to a 3D point in the model frame; std::nullopt if its pixel has no depth.
// @param origin  of the depth map in the pixels of the keypoint
std::optional<Point3> BackprojectKeypoint(const Keypoint& keypoint, const cv::Point& origin,
                                          const PosedDepthMap& depth_map, const Rigid3& model_from_camera) {
  const int column = std::clamp(static_cast<int>(keypoint.x) - origin.x, 0, depth_map.depth_m.cols - 1);
  const int row = std::clamp(static_cast<int>(keypoint.y) - origin.y, 0, depth_map.depth_m.rows - 1);
  const double depth = depth_map.depth_m.at<float>(row, column);
  if (!std::isfinite(depth)) return std::nullopt;
  const Eigen::Vector2d pixel(static_cast<double>(keypoint.x) - origin.x, static_cast<double>(keypoint.y) - origin.y);
  const Eigen::Vector3d place = model_from_camera.Apply(depth * depth_map.camera.pinhole.Unproject(pixel));
  return Point3{static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(place.z())};
}

}  // namespace

Expected<RelitTemplate> ExtractTemplateFeatures(const ObjectImage& image, const PosedDepthMap& depth_map,
                                                const FeatureExtractor& extractor, const CadModelOptions& options) {
  RelitTemplate result;
  if (image.outline.size() < 3) return result;
  VICTORIOUS_ASSIGN_OR_RETURN(
      const FeatureSet all, ExtractObjectFeatures(image, extractor, {.min_mask_fraction = options.min_mask_fraction}));
  const Rigid3 model_from_camera = depth_map.camera.camera_from_world.Inverse();
  result.features.image_width = all.image_width;
  result.features.image_height = all.image_height;
  result.features.keypoints.reserve(all.size());
  result.features.descriptors.reserve(all.descriptors.size());
  result.points_in_model.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::optional<Point3> place =
        BackprojectKeypoint(all.keypoints[i], image.origin, depth_map, model_from_camera);
    if (!place) continue;
    AppendFeature(all.keypoints[i], all, i, result.features);
    result.points_in_model.push_back(*place);
  }
  if (result.features.size() < static_cast<std::size_t>(options.min_features)) result = {};
  return result;
}

}  // namespace victorious
