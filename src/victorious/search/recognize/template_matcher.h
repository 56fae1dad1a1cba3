// recognize/, for ModelMatcher and GatherEvidence: one template of a model in one scene. Match() gives its ranked
// matches (search/match/ranked_matcher.h), Vote() the poses by Hough voting (search/pose/vote_poses.h).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/error.h"
#include "victorious/geometry/vertical.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/pose/pooled_template.h"
#include "victorious/search/pose/upright_prior.h"
#include "victorious/search/recognize/azimuth_cells.h"
#include "victorious/search/recognize/prepared_scene.h"
#include "victorious/search/recognize/template_variant.h"
#include "victorious/search/recognize/vote_search_options.h"
#include "victorious/types/object_model.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

/// A template with its matches in a scene. The model must outlive it.
struct MatchedTemplate {
  TemplateVariant variant;
  std::shared_ptr<const RelitTemplate> relit;  ///< null: diffuse light
  FeatureView features;                        ///< of the model or of relit
  std::span<const Point3> points_in_model;     ///< surface point of each keypoint, m; empty if the model has none
  std::vector<RankedMatch> matches;

  [[nodiscard]] ComparedTemplate Compared() const { return {features.keypoints, points_in_model, matches}; }
};

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
class TemplateMatcher {
 public:
  /// @param relit_templates  null if no variant has a sun
  /// @param vertical         in the camera frame; nullopt: unknown
  TemplateMatcher(const ObjectModel& model, const RelitTemplateSource* relit_templates, const PreparedScene& scene,
                  const VoteSearchOptions& options, const PoseOptions& pose_options,
                  const std::optional<Vertical>& vertical);

  /// The azimuth cells of the searched region.
  [[nodiscard]] const AzimuthCells& cells() const { return cells_; }

  /// In the order of the variants. Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<MatchedTemplate>> Match(std::span<const TemplateVariant> variants) const;

  /// The poses that a template's matches vote for; of a relit template only those in the azimuth cell of its sun.
  /// @param compared  the template itself, or pooled with its neighbours
  [[nodiscard]] std::vector<PlanarFit> Vote(const TemplateVariant& variant, const ComparedTemplate& compared) const;

 private:
  // Without matches.
  [[nodiscard]] Expected<MatchedTemplate> MakeTemplate(const TemplateVariant& variant) const;
  [[nodiscard]] bool HasSunOfItsCell(const TemplateVariant& variant, const PlanarFit& fit) const;

  const ObjectModel& model_;
  const RelitTemplateSource* relit_templates_;
  const PreparedScene& scene_;
  const VoteSearchOptions& options_;
  const PoseOptions& pose_options_;
  const std::optional<Vertical>& vertical_;
  AzimuthCells cells_;
};

}  // namespace victorious
