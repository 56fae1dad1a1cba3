#include "victorious/search/recognize/template_matcher.h"

#include <utility>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/polygon.h"
#include "victorious/kernels/nearest.h"
#include "victorious/search/pose/vote_poses.h"

namespace victorious {
namespace {

// Width of an azimuth cell in steps of the sun's azimuth: a cell's lines of sight lie within one step of its centre.
constexpr double kCellWidthSunSteps = 2;

}  // namespace

Eigen::Vector2d ObjectCentre(const PlanarFit& fit, const Polygon& outline) {
  const Box box = BoundingBox(ProjectPolygon(fit.scene_from_template_plane, outline));
  return {box.x + box.width / 2, box.y + box.height / 2};
}

AzimuthCells MakeAzimuthCells(const PreparedScene& scene, const VoteSearchOptions& options,
                              const std::optional<Vertical>& vertical) {
  return {vertical, scene.features().SearchedBox(), kCellWidthSunSteps * options.sun_step_rad};
}

std::optional<UprightPrior> MakeUprightPrior(const ModelView& view, const std::optional<Vertical>& vertical,
                                             const VoteSearchOptions& options) {
  if (!view.angles) return std::nullopt;
  const double off_nadir_rad = view.angles->off_nadir_rad;
  return vertical ? UprightPrior::FromVertical(*vertical, off_nadir_rad, options.max_tilt_rad)
                  : UprightPrior::AssumingUprightCamera(off_nadir_rad, options.max_hanging_rad);
}

TemplateMatcher::TemplateMatcher(const ObjectModel& model, const RelitTemplateSource* relit_templates,
                                 const PreparedScene& scene, const VoteSearchOptions& options,
                                 const PoseOptions& pose_options, const std::optional<Vertical>& vertical)
    : model_(model),
      relit_templates_(relit_templates),
      scene_(scene),
      options_(options),
      pose_options_(pose_options),
      vertical_(vertical),
      cells_(MakeAzimuthCells(scene, options, vertical)) {}

Expected<std::vector<MatchedTemplate>> TemplateMatcher::Match(std::span<const TemplateVariant> variants) const {
  std::vector<MatchedTemplate> matched;
  matched.reserve(variants.size());
  for (const TemplateVariant& variant : variants) {
    VICTORIOUS_ASSIGN_OR_RETURN(MatchedTemplate one, MakeTemplate(variant));
    matched.push_back(std::move(one));
  }
  const StageScope scope(Stage::kMatching);
  std::vector<kernels::PackedQueries> queries;
  queries.reserve(matched.size());
  for (const MatchedTemplate& one : matched) queries.push_back(kernels::PackQueries(one.features.descriptors));
  std::vector<std::vector<RankedMatch>> matches = scene_.ranked_matcher().MatchAll(queries, options_.nearest);
  for (std::size_t i = 0; i < matched.size(); ++i) matched[i].matches = std::move(matches[i]);
  return matched;
}

Expected<MatchedTemplate> TemplateMatcher::MakeTemplate(const TemplateVariant& variant) const {
  MatchedTemplate matched{.variant = variant,
                          .relit = {},
                          .features = model_.ViewFeatures(variant.view),
                          .points_in_model = model_.ViewPoints(variant.view),
                          .matches = {}};
  if (variant.sun_view) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        matched.relit, relit_templates_->GetTemplate({*variant.sun_view, variant.view, variant.half_resolution}));
    matched.features = matched.relit->features.View();
    matched.points_in_model = matched.relit->points_in_model;
  }
  return matched;
}

std::vector<PlanarFit> TemplateMatcher::Vote(const TemplateVariant& variant, const ComparedTemplate& compared) const {
  const StageScope scope(Stage::kPoses);
  const ModelView& view = model_.views[variant.view];
  std::vector<PlanarFit> fits =
      VotePoses(scene_.features(), compared.keypoints, compared.matches, view.outline, options_.votes, pose_options_,
                MakeUprightPrior(view, vertical_, options_), compared.points_in_model);
  std::erase_if(fits, [&](const PlanarFit& fit) { return !HasSunOfItsCell(variant, fit); });
  return fits;
}

// True if the pose lies in the azimuth cell that the template was relit for: each position has one sun.
bool TemplateMatcher::HasSunOfItsCell(const TemplateVariant& variant, const PlanarFit& fit) const {
  if (!variant.relative_azimuth_rad) return true;
  const double relative_azimuth_rad = vertical_->AzimuthAt(ObjectCentre(fit, model_.views[variant.view].outline));
  return cells_.CellCentre(relative_azimuth_rad) == *variant.relative_azimuth_rad;
}

}  // namespace victorious
