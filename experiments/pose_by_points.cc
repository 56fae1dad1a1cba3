#include "experiments/pose_by_points.h"

#include <limits>

#include "victorious/geometry/view_sphere.h"

namespace victorious {

std::optional<ObjectPose> PoseByPoints(std::span<const SeenPoint> points, double sigma) {
  std::optional<ObjectPose> best;
  double least = std::numeric_limits<double>::infinity();
  const Expected<ViewSphere> sphere = MakeViewSphere({.step_deg = 20, .max_off_nadir_deg = 80});
  for (const ViewSphere::View& view : sphere->views) {
    const auto pose =
        FitObjectPose(points, CameraFromModel(view.direction), {.sigma = sigma, .sigma_view_rad = 10, .hypotheses = 0});
    if (!pose) continue;
    double off2 = 0;
    for (const SeenPoint& point : points) {
      off2 += (pose->camera_from_object.Apply(point.point).hnormalized() - point.seen).squaredNorm();
    }
    if (off2 >= least) continue;
    least = off2;
    best = pose;
  }
  return best;
}

}  // namespace victorious
