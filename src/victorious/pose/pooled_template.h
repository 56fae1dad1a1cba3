// A view and what its neighbours were matched with: their keypoints, where the view would show them. Seen between two
// views, an object has keypoints of both, too few of either; together they agree on one pose.
#pragma once

#include <span>
#include <vector>

#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A template that was compared with a scene; what the spans point into is the caller's.
struct ComparedTemplate {
  std::span<const Keypoint> keypoints;
  std::span<const Point3> points_in_model;  ///< a keypoint's place on the object, m; one each
  std::span<const RankedMatch> matches;     ///< by keypoint
};

struct PooledTemplate {
  std::vector<Keypoint> keypoints;  ///< the view's own first, in their order; in its pixels
  std::vector<Point3> points_in_model;
  std::vector<RankedMatch>
      matches;  ///< by keypoint; a keypoint that n views have was tried n times: ranks count n-fold
};

/// Only the view's own where its keypoints do not tell how it shows the object (fewer than eight, all in one plane).
PooledTemplate Pool(const ComparedTemplate& view, std::span<const ComparedTemplate> neighbours);

}  // namespace victorious
