// recognize/, before the search: the sun's direction from the shading of an object in the scene.
//
// Method (ADR 0010). An upright object that is seen from a view's azimuth has a heading, and with it a sun in the model
// frame. The oblique coarse views of all models are proposed under diffuse light; the best are matched in full, and the
// best of these are proposed again at half resolution, relit from a coarse grid of sun directions. The best of them are
// matched at full resolution. The best direction is refined on a fine grid around it as the mean of the directions,
// weighted by 1 / NFA. Proposals: template_proposals.h.
#pragma once

#include <optional>
#include <span>

#include "victorious/base/error.h"
#include "victorious/geometry/sun.h"
#include "victorious/geometry/vertical.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/pose/similarity_pose.h"
#include "victorious/search/recognize/prepared_scene.h"
#include "victorious/search/recognize/shortened_views.h"
#include "victorious/search/recognize/vote_search_options.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// A model that can be relit. Non-owning.
struct RelightableModel {
  const ObjectModel* model;
  const RelitTemplateSource* relit_templates;
  const ShortenedViews* shortened;
};

/// An estimate of the sun's direction.
struct SunEstimate {
  Sun relative_sun;     ///< relative to the viewing direction, as FrameConditions::relative_sun
  double gain_decades;  ///< -log10 NFA of the pose that determines it, over that of the model under diffuse light
};

/// Returns std::nullopt in most scenes: if the best -log10 NFA is below six decades or less than one decade above
/// that of diffuse light.
/// @param scene  with the same vertical
/// Errors: those of RelitTemplateSource.
[[nodiscard]] Expected<std::optional<SunEstimate>> EstimateSun(std::span<const RelightableModel> models,
                                                               const PreparedScene& scene, const Vertical& vertical,
                                                               const VoteSearchOptions& options,
                                                               const PoseOptions& pose_options);

}  // namespace victorious
