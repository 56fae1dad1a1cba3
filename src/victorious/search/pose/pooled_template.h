// pose/, for VotePoses: pools a view with its neighbours. An object seen from between two views matches keypoints of
// both, too few of either. The neighbours' keypoints are transferred into the view's image through their surface points
// and an affine camera (x = A X + b, linear least squares on the view's keypoints), so that all matches vote together.
#pragma once

#include <span>
#include <vector>

#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A template with its matches in a scene. Non-owning.
struct ComparedTemplate {
  std::span<const Keypoint> keypoints;
  std::span<const Point3> points_in_model;  ///< surface point of each keypoint, model frame, m
  std::span<const RankedMatch> matches;     ///< in the order of the template keypoints
};

struct PooledTemplate {
  std::vector<Keypoint> keypoints;  ///< the view's own first, in their order, then the neighbours'; in the view's px
  std::vector<Point3> points_in_model;
  std::vector<RankedMatch>
      matches;  ///< by template keypoint; ranks of a keypoint that n views share are multiplied by n (n trials)
};

/// Returns the view's own keypoints and matches if the affine camera is not determined: fewer than eight keypoints, or
/// nearly coplanar surface points.
PooledTemplate PoolTemplates(const ComparedTemplate& view, std::span<const ComparedTemplate> neighbours);

}  // namespace victorious
