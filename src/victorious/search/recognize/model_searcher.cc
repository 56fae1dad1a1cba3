#include "victorious/search/recognize/model_searcher.h"

#include <cstddef>
#include <utility>

#include "victorious/search/recognize/grammar_search.h"
#include "victorious/search/recognize/shortlist_search.h"
#include "victorious/search/recognize/vote_search.h"

namespace victorious {
namespace {

// Fewer views are all matched in full: proposals would save little time. `model add` makes 253 by default.
constexpr std::size_t kMinShortlistViews = 60;

}  // namespace

// ADR 0008: the matches of a photo pass the ratio test, those of a rendering mostly do not.
SearchMethod MethodFor(const ObjectModel& model, SearchMethod method) {
  if (method != SearchMethod::kAuto) return method;
  if (model.kind != ModelKind::kCad) return SearchMethod::kGrammar;
  return model.views.size() >= kMinShortlistViews ? SearchMethod::kShortlist : SearchMethod::kVotes;
}

std::unique_ptr<const ModelSearcher> MakeModelSearcher(const ObjectModel& model,
                                                       std::shared_ptr<const ShortenedViews> shortened,
                                                       std::shared_ptr<const RelitTemplateSource> relit_templates,
                                                       const RecognizeOptions& options) {
  switch (MethodFor(model, options.method)) {
    case SearchMethod::kVotes:
      return std::make_unique<VoteSearch>(model, std::move(relit_templates), options.search, options.pose);
    case SearchMethod::kShortlist:
      return std::make_unique<ShortlistSearch>(model, std::move(shortened), std::move(relit_templates), options.search,
                                               options.shortlist, options.pose);
    case SearchMethod::kAuto:
    case SearchMethod::kGrammar:
      break;
  }
  return std::make_unique<GrammarSearch>(
      model, GrammarSearchOptions{.match = options.match, .cascade = options.cascade, .pose = options.pose});
}

}  // namespace victorious
