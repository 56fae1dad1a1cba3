// recognize/, for VoteSearch and EstimateSun: matches templates of one model with one scene by ranked matches
// (match/ranked_matcher.h) and Hough voting (pose/vote_poses.h), and collects the poses.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/detect/detect.h"
#include "victorious/geometry/vertical.h"
#include "victorious/pose/pooled_template.h"
#include "victorious/pose/upright_prior.h"
#include "victorious/recognize/azimuth_cells.h"
#include "victorious/recognize/prepared_scene.h"
#include "victorious/recognize/relit_templates.h"
#include "victorious/recognize/template_variant.h"
#include "victorious/recognize/vote_search_options.h"
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

/// The centre of the object's box in the scene, px.
/// @param outline  of the object in the template, px
[[nodiscard]] Eigen::Vector2d ObjectCentre(const PlanarFit& fit, const Polygon& outline);

/// The azimuth cells of a scene's searched region: each is searched with templates relit by a sun of its own.
/// @param vertical  in the camera frame; nullopt: unknown
[[nodiscard]] AzimuthCells MakeAzimuthCells(const PreparedScene& scene, const VoteSearchOptions& options,
                                            const std::optional<Vertical>& vertical);

/// The prior on the rotation of a view in the scene; nullopt for a view without angles.
/// @param vertical  in the camera frame; nullopt: unknown
[[nodiscard]] std::optional<UprightPrior> MakeUprightPrior(const ModelView& view,
                                                           const std::optional<Vertical>& vertical,
                                                           const VoteSearchOptions& options);

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
  [[nodiscard]] const AzimuthCells& cells() const { return cells_; }

  /// Matches templates; returns the highest -log10 NFA of each, kNoPose without a pose.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<double>> Evaluate(std::span<const TemplateVariant> variants);

  /// The same, with the templates.
  [[nodiscard]] Expected<std::vector<ScoredVariant>> EvaluateScored(std::span<const TemplateVariant> variants);

  /// Pools each of the best templates with the matched neighbours of the same light and votes again.
  /// @param max_count  number of the best templates
  void Pool(int max_count);

  /// True if there are poses of a certain instance, but in all of them less than min_in_view of the outline is inside
  /// the frame: Detect() drops them.
  [[nodiscard]] bool HasInstancesOutOfViewOnly(double min_in_view) const;

  /// All poses so far. Candidate::model_index is not set.
  [[nodiscard]] std::vector<Candidate> TakeCandidates() { return std::move(candidates_); }

 private:
  // A matched template and its results.
  struct MatchedVariant {
    TemplateVariant variant;
    std::shared_ptr<const RelitTemplate> relit;  // null: diffuse light
    std::vector<RankedMatch> matches;
    double neg_log10_nfa = kNoPose;
  };

  [[nodiscard]] Expected<double> Evaluate(const TemplateVariant& variant);
  [[nodiscard]] std::vector<RankedMatch> Match(const FeatureView& features) const;
  double Vote(const TemplateVariant& variant, std::span<const Keypoint> keypoints, std::span<const Point3> points,
              std::span<const RankedMatch> matches);
  [[nodiscard]] bool HasSunOfItsCell(const TemplateVariant& variant, const PlanarFit& fit) const;
  [[nodiscard]] bool AreNeighbours(const TemplateVariant& one, const TemplateVariant& other) const;
  [[nodiscard]] FeatureView FeaturesOf(const MatchedVariant& matched) const;
  [[nodiscard]] std::span<const Point3> SurfacePointsOf(const MatchedVariant& matched) const;
  [[nodiscard]] ComparedTemplate TemplateOf(const MatchedVariant& matched) const;

  const ObjectModel& model_;
  const RelitTemplateSource* relit_templates_;
  const PreparedScene& scene_;
  const VoteSearchOptions& options_;
  const PoseOptions& pose_options_;
  const std::optional<Vertical>& vertical_;
  std::size_t test_count_;
  AzimuthCells cells_;
  std::vector<MatchedVariant> matched_;
  std::vector<Candidate> candidates_;
};

}  // namespace victorious
