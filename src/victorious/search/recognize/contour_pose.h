// Private to recognize/, for ContourSearch: fits the edges of a model to the edges of an image, and says how much
// speaks for the fit.
//
// Method: of each point of the nearest view's contours, the image is searched along the normal of the projected contour
// (Harris' RAPID; Drummond and Cipolla, PAMI 2002); the distances are least squares with Tukey's weights in the six
// degrees of freedom of the pose and the logarithm of the focal length, which is unknown to about a quarter.
// Evidence: a point is a hit if an image edge of its orientation is within 2 px. With p the fraction of places around
// the object for which that is true, and 0.9 for a right pose, a point adds log10(0.9 / p) or log10(0.1 / (1 - p)).
// Edges are long: one point in 8 px counts.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "victorious/search/recognize/contour_image.h"
#include "victorious/types/surface_point.h"

namespace victorious {

struct ContourView {
  Eigen::Matrix3d camera_from_model = Eigen::Matrix3d::Identity();
  std::vector<ContourPoint> points;
};

struct ContourModel {
  double diagonal_m = 1;  ///< of the bounding box
  std::vector<ContourView> views;
};

/// The principal point is the image's centre.
struct ContourPose {
  Eigen::Matrix3d camera_from_model = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centre_in_camera_m = Eigen::Vector3d::UnitZ();  ///< of the bounding box
  double focal_px = 1;
};

/// A point of a contour in the image.
struct ProjectedContour {
  Eigen::Vector2d at_px;
  Eigen::Vector2d normal;  ///< unit vector
  Eigen::Vector3d in_camera_m;
};

/// Of the nearest view; without points behind the camera.
[[nodiscard]] std::vector<ProjectedContour> ProjectContours(const ContourModel& model, const ContourPose& pose,
                                                            const Eigen::Vector2d& principal_px,
                                                            std::size_t stride = 1);

struct ContourRefineOptions {
  int iterations = 14;
  std::size_t stride = 1;      ///< of the points of a view, one in so many
  double reach = 0.02;         ///< of the first search along normals, over the object's size
  double reach_factor = 0.85;  ///< from one iteration to the next
  bool free_focal = true;
};

[[nodiscard]] ContourPose RefineContourPose(const ContourModel& model, const ContourImage& image, ContourPose pose,
                                            const ContourRefineOptions& options);

struct ContourEvidence {
  double decades = 0;       ///< of the likelihood ratio
  double mean = 0;          ///< decades a point, before edges are counted as long
  double hit_fraction = 0;  ///< of all points, those that are seen and have an edge
  double seen = 0;          ///< fraction of the points that the image shows
  /// Difference of the grey levels on either side of the contours, over their range in between: near 1 where a body
  /// stands before something else, near 0 of lines that are painted on the ground.
  double step = 0;
  cv::Rect2d box;  ///< of the contours, px
};

/// @param is_seen  whether a point of the image, px, shows what was filmed; where it does not, a contour says nothing,
///                 and the mean is over all its points. Empty: all do.
[[nodiscard]] ContourEvidence EvidenceOf(const ContourModel& model, const ContourImage& image, const ContourPose& pose,
                                         const std::function<bool(const Eigen::Vector2d&)>& is_seen = {});

}  // namespace victorious
