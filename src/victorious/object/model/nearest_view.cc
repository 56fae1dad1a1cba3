#include "victorious/object/model/nearest_view.h"

#include <optional>

#include <Eigen/Core>

namespace victorious {

std::size_t NearestView(const ObjectModel& model, const ViewDirection& direction) {
  const Eigen::Vector3d wanted = DirectionToCamera(direction);
  std::size_t best = 0;
  double best_cosine = -2;
  for (std::size_t v = 0; v < model.views.size(); ++v) {
    const std::optional<ViewDirection>& angles = model.views[v].angles;
    if (!angles) continue;
    const double cosine = wanted.dot(DirectionToCamera(*angles));
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best = v;
    }
  }
  return best;
}

}  // namespace victorious
