// recognize/, the options of a search: the method and the options of each stage.
#pragma once

#include <array>

#include "victorious/base/enum_text.h"
#include "victorious/base/options.h"
#include "victorious/search/detect/detect.h"
#include "victorious/search/grammar/cascade.h"
#include "victorious/search/match/matcher.h"
#include "victorious/search/pose/similarity_pose.h"
#include "victorious/search/recognize/ncc_rescoring.h"
#include "victorious/search/recognize/shortlist_options.h"
#include "victorious/search/recognize/vote_search_options.h"

namespace victorious {

/// The method that searches a model (model_searcher.h).
enum class SearchMethod {
  kAuto,       ///< kShortlist or, of few views, kVotes for CAD models; kGrammar for photos
  kGrammar,    ///< grammar_search.h
  kVotes,      ///< vote_search.h
  kShortlist,  ///< shortlist_search.h
};
inline constexpr auto kSearchMethodTexts =
    std::to_array<EnumText<SearchMethod>>({{SearchMethod::kAuto, "auto"},
                                           {SearchMethod::kGrammar, "grammar"},
                                           {SearchMethod::kVotes, "votes"},
                                           {SearchMethod::kShortlist, "shortlist"}});

struct RecognizeOptions {
  SearchMethod method = SearchMethod::kAuto;
  VoteSearchOptions search;
  ShortlistOptions shortlist;  ///< Not a user parameter
  MatchOptions match;
  CascadeOptions cascade;
  PoseOptions pose;
  DetectOptions detect;
  NccOptions ncc;  ///< Not a user parameter

  void ListFields(FieldList& fields);
};

}  // namespace victorious
