// recognize/, for VoteSearch, ShortlistSearch and EstimateSun: matches templates of one model with one scene
// (template_matcher.h), pools the best with their neighbours, and collects the poses.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/vertical.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/detect/detect.h"
#include "victorious/search/recognize/azimuth_cells.h"
#include "victorious/search/recognize/prepared_scene.h"
#include "victorious/search/recognize/template_matcher.h"
#include "victorious/search/recognize/template_variant.h"
#include "victorious/search/recognize/vote_search_options.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// The -log10 NFA of a template without a pose.
inline constexpr double kNoPose = -std::numeric_limits<double>::infinity();

/// Views of the highest -log10 NFA that vote once more together with the matches of their neighbours: an object seen
/// from between two views matches keypoints of both (docs/adr/0008).
inline constexpr int kMaxPooledViews = 6;

/// A matched template and the highest -log10 NFA of its poses.
struct ScoredVariant {
  TemplateVariant variant;
  double neg_log10_nfa;  ///< kNoPose without a pose
};

/// By falling -log10 NFA.
[[nodiscard]] std::vector<ScoredVariant> SortedByNfa(std::vector<ScoredVariant> scored);

/// Non-owning: all arguments of the constructor must outlive it.
class ModelMatcher {
 public:
  /// @param relit_templates  null if no variant has a sun
  /// @param vertical         in the camera frame; nullopt: unknown
  /// @param test_count       number of templates searched: the number of tests in the NFA
  ModelMatcher(const ObjectModel& model, const RelitTemplateSource* relit_templates, const PreparedScene& scene,
               const VoteSearchOptions& options, const PoseOptions& pose_options,
               const std::optional<Vertical>& vertical, std::size_t test_count);

  /// The azimuth cells of the searched region.
  [[nodiscard]] const AzimuthCells& cells() const { return matcher_.cells(); }

  /// Matches templates; returns the highest -log10 NFA of each, kNoPose without a pose.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<double>> Evaluate(std::span<const TemplateVariant> variants);

  /// The same, with the templates.
  [[nodiscard]] Expected<std::vector<ScoredVariant>> EvaluateScored(std::span<const TemplateVariant> variants);

  /// Matches templates, but votes only for the most promising ones: those whose best pose, as estimated from their
  /// matches (search/pose/pose_proposal.h), is the most significant. The others may be pooled with them. For few views
  /// at a known place, where most of the cost are the poses. Errors: those of RelitTemplateSource.
  [[nodiscard]] Status EvaluateBest(std::span<const TemplateVariant> variants, std::size_t max_count);

  /// Pools each of the best templates with the matched neighbours of the same light and votes again.
  /// @param max_count  number of the best templates
  void Pool(int max_count);

  /// True if there are poses of a certain instance, but in all of them less than min_in_view of the outline is inside
  /// the frame: Detect() drops them.
  [[nodiscard]] bool HasInstancesOutOfViewOnly(double min_in_view) const;

  /// All poses so far. Candidate::model_index is not set.
  [[nodiscard]] std::vector<Candidate> TakeCandidates() { return std::move(candidates_); }

 private:
  struct ScoredTemplate {
    MatchedTemplate matched;
    double neg_log10_nfa;  // the highest of its poses
  };

  void Prepare(std::span<const TemplateVariant> variants) const;
  double Vote(const TemplateVariant& variant, const ComparedTemplate& compared);
  [[nodiscard]] bool AreNeighbours(const TemplateVariant& one, const TemplateVariant& other) const;

  const ObjectModel& model_;
  const RelitTemplateSource* relit_templates_;
  const PreparedScene& scene_;
  const VoteSearchOptions& options_;
  const std::optional<Vertical>& vertical_;
  std::size_t test_count_;
  TemplateMatcher matcher_;
  std::vector<ScoredTemplate> matched_;
  std::vector<Candidate> candidates_;
};

}  // namespace victorious
