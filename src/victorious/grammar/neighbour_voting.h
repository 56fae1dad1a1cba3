// The voting that the thesis's is measured against: by nearest neighbours, as Video Google does it. A match is
// supported by each other match from one of the k keypoints nearest to its own in the scene to one of the k nearest in
// the template; with too little support it is dropped. Nothing is asked of scales, directions or distances. Source: J.
// Sivic and A. Zisserman, "Video Google: a text retrieval approach to object matching in videos", ICCV 2003 (k = 15, m
// = 1); thesis, section 3.3.1 and figure 3-4.
#pragma once

#include <span>

#include "victorious/base/options.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

struct NeighbourVotingOptions {
  int nearest = 15;     ///< k
  int least_votes = 1;  ///< m

  void ListFields(FieldList& fields);
};

/// The matches with enough support, in their order. The nearest are among all keypoints, matched or not, not counting
/// the match's own; a keypoint that another orientation doubles is a neighbour like any other.
/// @param scene, model  the keypoints that the matches index
/// Cost: the matched keypoints times all keypoints of their image.
MatchSet FilterByNeighbours(std::span<const Keypoint> scene, std::span<const Keypoint> model, const MatchSet& matches,
                            const NeighbourVotingOptions& options);

}  // namespace victorious
