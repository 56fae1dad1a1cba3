// grammar/, between match/ and pose/. In: one template's matches. Out: the matches that satisfy the geometric grammar.
// Method: pairwise voting. A pair of matches whose scene keypoints lie within R of each other votes for both if its
// geometric measures (geometry/pair_measures.h) agree between scene and template. A match is kept if its approval
//   approval = votes / possible votes
// exceeds the stage's threshold and it has at least min_votes (two) votes. Three stages: scales and distances;
// orientations; scales and distances at a stricter approval, where only votes from distinct template keypoints count.
// Source: thesis, sections 3.3.1 to 3.3.4, algorithms 1 to 3, table 3.1.
#pragma once

#include <array>
#include <span>

#include "victorious/base/options.h"
#include "victorious/search/grammar/neighbour_voting.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// The filter of the matches before pose estimation.
enum class CascadeFilter {
  kCascade,  ///< the three stages
  kFirst,    ///< one stage alone
  kSecond,
  kThird,
  kNeighbours,  ///< voting by nearest neighbours (neighbour_voting.h)
  kNone,        ///< no filter
};
inline constexpr auto kCascadeFilterTexts =
    std::to_array<EnumText<CascadeFilter>>({{CascadeFilter::kCascade, "cascade"},
                                            {CascadeFilter::kFirst, "first"},
                                            {CascadeFilter::kSecond, "second"},
                                            {CascadeFilter::kThird, "third"},
                                            {CascadeFilter::kNeighbours, "neighbours"},
                                            {CascadeFilter::kNone, "none"}});

/// The source of R.
enum class CascadeRadius {
  kFixed,  ///< radius_px
  kScale,  ///< each match's scale change times the template's radius
};

/// The defaults are those of the thesis (table 3.1; the names in capitals are the thesis's). docs/adr/0006 defines the
/// angles.
struct CascadeOptions {
  CascadeFilter filter = CascadeFilter::kCascade;
  double radius_px = 75;                    ///< R
  double scale_distortion = 1.45;           ///< SCALE_FUDGE_FACTOR
  double distance_distortion = 1.45;        ///< DIST_SCALE_FUDGE_FACTOR
  double first_approval = 0.2;              ///< DIST_APPROVE_THRESHOLD
  double orientation_distortion_rad = 1.5;  ///< ANG_FUDGE_FACTOR
  double line_distortion_rad = 0.6;         ///< ANG_ORIENT_FUDGE_FACTOR
  double second_approval = 0.4;             ///< ANG_APPROVE_THRESHOLD
  double third_approval = 0.6;              ///< RE_DIST_APPROVE_THRESHOLD

  // Not user parameters from here on: the presets and the experiments of chapter 3 set them.
  /// Each stage requires agreement in all four measures of a pair, not in its own two: chance agreement is rarer, so
  /// that a lower first_approval suffices, and a pair costs more.
  bool all_measures = false;
  CascadeRadius radius = CascadeRadius::kFixed;
  double radius_fraction = 1;  ///< R over the projected template radius, for CascadeRadius::kScale
  int min_votes = 2;           ///< of a match in every stage; section 3.3.3: a single vote is unreliable
  int distinct_stages = 1;     ///< final stages that count distinct template keypoints only; section 3.3.4: the third
  NeighbourVotingOptions neighbours;

  void ListFields(FieldList& fields);
};

/// The matches after each stage, each a subset of the stage before, in the input order. A stage that `filter` leaves
/// out passes its input on. Neighbour voting returns its result in all three.
struct CascadeResult {
  MatchSet first;
  MatchSet second;
  MatchSet third;
};

/// Each pair counts once, a match never votes for itself, and only matched scene keypoints are possible voters. Two
/// matches at one position in the scene (one keypoint with two orientations) form no pair: no line connects them, and
/// they are not independent. Two matches at one position in the template are possible voters that never agree.
/// With CascadeRadius::kScale each match has its own R: its scale change times the template's radius, the largest
/// distance of a template keypoint from the centroid of all; a match votes for every match within whose R it lies.
/// @param scene, template_keypoints  the keypoints of the scene and of the template that the matches index
/// Cost: linear in the number of pairs within R (the largest R), by a grid of cells of side R.
CascadeResult FilterByGrammar(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                              const MatchSet& matches, const CascadeOptions& options);

/// The reference implementation: the same result by the thesis's algorithms, over all pairs of matches. Quadratic.
CascadeResult FilterByGrammarRef(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                                 const MatchSet& matches, const CascadeOptions& options);

}  // namespace victorious
