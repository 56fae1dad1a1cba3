// grammar/, in: one template's matches. Out: those that obey the geometric grammar.
// Matches vote for each other: a pair of matches whose scene keypoints lie within R of each other casts a vote for both
// if its geometric measures (geometry/pair_measures.h) agree between scene and template. A match stays whose approval,
// votes over possible votes, is high enough, and who got two votes or more. Three stages: scales and distances, then
// orientations, then scales and distances again at a stricter approval, where only votes from distinct template
// keypoints count. Source: thesis, sections 3.3.1 to 3.3.4, algorithms 1 to 3, table 3.1.
#pragma once

#include <span>
#include <string>

#include "victorious/base/options.h"
#include "victorious/grammar/neighbour_voting.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// The defaults are the thesis's (table 3.1; the names in capitals are its own). docs/adr/0006 tells how angles are
/// meant.
struct CascadeOptions {
  std::string filter = "cascade";
  std::string radius = "fixed";
  double radius_px = 75;                    ///< R
  double radius_share = 1;                  ///< of the template's radius, where R comes from scale
  double scale_distortion = 1.45;           ///< SCALE_FUDGE_FACTOR
  double distance_distortion = 1.45;        ///< DIST_SCALE_FUDGE_FACTOR
  double first_approval = 0.2;              ///< DIST_APPROVE_THRESHOLD
  double orientation_distortion_rad = 1.5;  ///< ANG_FUDGE_FACTOR
  double line_distortion_rad = 0.6;         ///< ANG_ORIENT_FUDGE_FACTOR
  double second_approval = 0.4;             ///< ANG_APPROVE_THRESHOLD
  double third_approval = 0.6;              ///< RE_DIST_APPROVE_THRESHOLD
  int least_votes = 2;                      ///< section 3.3.3
  int distinct_stages = 1;                  ///< section 3.3.4
  bool all_measures = false;
  NeighbourVotingOptions neighbours;

  void ListFields(FieldList& fields);
};

/// What is left after each stage, each a subset of the one before, in the matches' order. A stage that `filter` leaves
/// out changes nothing; neighbour voting takes the first one's place.
struct CascadeResult {
  MatchSet first;
  MatchSet second;
  MatchSet third;
};

/// Each pair counts once, a match never votes for itself, and only matched scene keypoints are possible voters. Two
/// matches at one place in the scene (one keypoint with two orientations) form no pair: they have no line between them,
/// and are not independent evidence. Two that match one place in the template are possible voters that never agree.
/// Where R comes from scale, each match has its own: its scale change times the template's radius, which is the largest
/// distance of a template keypoint from the middle of them all; a match then votes for all in whose R it lies.
/// @param scene, model  the keypoints that the matches index
/// Cost: linear in the number of pairs within R (the largest R), by a grid of cells of R.
CascadeResult FilterByGrammar(std::span<const Keypoint> scene, std::span<const Keypoint> model, const MatchSet& matches,
                              const CascadeOptions& options);

/// The definition: the same, written as the thesis's algorithms are, every pair of matches compared. Quadratic.
CascadeResult FilterByGrammarRef(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                 const MatchSet& matches, const CascadeOptions& options);

}  // namespace victorious
