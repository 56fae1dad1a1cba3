// grammar/, the baseline of the cascade: voting by nearest neighbours, as in Video Google. A match is supported by each
// other match from one of the k nearest keypoints in the scene to one of the k nearest keypoints in the template. A
// match with fewer than m supporting matches is dropped. Scales, orientations and distances are not compared.
// Source: J. Sivic and A. Zisserman, "Video Google: a text retrieval approach to object matching in videos", ICCV 2003
// (k = 15, m = 1); thesis, section 3.3.1 and figure 3-4.
#pragma once

#include <span>

#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

struct NeighbourVotingOptions {
  int nearest = 15;   ///< k (Video Google: 15)
  int min_votes = 1;  ///< m (Video Google: 1)
};

/// The neighbours are taken among all keypoints, matched or not, without the match's own keypoint; a second keypoint at
/// the same position with another orientation counts as a neighbour.
/// @param scene, template_keypoints  the keypoints of the scene and of the template that the matches index
/// @return the matches with enough support, in the input order
/// Cost: matched keypoints x all keypoints of their image.
MatchSet FilterByNeighbours(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                            const MatchSet& matches, const NeighbourVotingOptions& options);

}  // namespace victorious
