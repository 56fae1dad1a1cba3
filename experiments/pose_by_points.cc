#include "experiments/pose_by_points.h"

#include <limits>

#include "victorious/geometry/view_direction.h"
#include "victorious/geometry/view_sphere.h"

namespace victorious {

std::optional<ObjectPoseFit> FitPoseToPoints(std::span<const PointObservation> points, double sigma) {
  std::optional<ObjectPoseFit> best;
  double min_error = std::numeric_limits<double>::infinity();
  const Expected<ViewSphere> sphere = MakeViewSphere({.step_deg = 20, .max_off_nadir_deg = 80});
  for (const ViewSphere::View& view : sphere->views) {
    const auto pose =
        FitObjectPose(points, CameraFromModel(view.direction), {.sigma = sigma, .sigma_view_rad = 10, .hypotheses = 0});
    if (!pose) continue;
    double squared_error = 0;
    for (const PointObservation& point : points) {
      squared_error += (pose->camera_from_object.Apply(point.point).hnormalized() - point.seen).squaredNorm();
    }
    if (squared_error >= min_error) continue;
    min_error = squared_error;
    best = pose;
  }
  return best;
}

}  // namespace victorious
