// recognize/, the interface of a search method: finds one model in a scene. Recognizer calls it for each model, passes
// the candidates of all models to Detect, and depends on no method.
//
// The methods:
//   GrammarSearch (grammar_search.h)  ratio test, cascade, MLESAC: the thesis's method; for models from photos
//   VoteSearch (vote_search.h)        ranked matches, Hough voting, coarse to fine; for CAD models of few views
//   ShortlistSearch (shortlist_search.h)  proposals, the best of them verified as VoteSearch does it; for CAD models
//
// To add a search method:
// 1. Implement ModelSearcher in files of its own; grammar_search.{h,cc} is the short example.
// 2. Add its options as a group to RecognizeOptions, and its name to SearchMethod (recognize_options.h).
// 3. Make it in MakeModelSearcher (model_searcher.cc).
// 4. Add it to the loop over methods in recognizer_test.cc, and to the table in README.md.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/detect/detect.h"
#include "victorious/search/recognize/prepared_scene.h"
#include "victorious/search/recognize/recognize_options.h"
#include "victorious/search/recognize/shortened_views.h"
#include "victorious/search/recognize/view_part.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Immutable and thread-safe. The candidates leave Candidate::model_index to the caller. Deterministic.
class ModelSearcher {
 public:
  virtual ~ModelSearcher() = default;

  /// Searches the views of the model.
  /// @param part  of the coarse views, or of the searches (ViewPart::ContainsWholeModels)
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] virtual Expected<std::vector<Candidate>> Search(const PreparedScene& scene,
                                                                const FrameConditions& conditions,
                                                                const ViewPart& part) const = 0;

  /// Searches these views only: the aspect is known.
  /// @param views  indices into the model's views
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] virtual Expected<std::vector<Candidate>> SearchViews(const PreparedScene& scene,
                                                                     const FrameConditions& conditions,
                                                                     std::span<const std::size_t> views) const = 0;

  /// The renderings of the model under other light, by which its detections are rescored (ncc_rescoring.h) and the sun
  /// is estimated (sun_estimate.h). Null: the method does not use any.
  [[nodiscard]] virtual const RelitTemplateSource* relit_templates() const { return nullptr; }
};

/// The method that searches a model: never kAuto.
/// @param method  of the options
[[nodiscard]] SearchMethod MethodFor(const ObjectModel& model, SearchMethod method);

/// Makes the searcher of options.method.
/// @param model            must outlive the searcher
/// @param shortened        of the model
/// @param relit_templates  of the model; null: none
[[nodiscard]] std::unique_ptr<const ModelSearcher> MakeModelSearcher(
    const ObjectModel& model, std::shared_ptr<const ShortenedViews> shortened,
    std::shared_ptr<const RelitTemplateSource> relit_templates, const RecognizeOptions& options);

}  // namespace victorious
