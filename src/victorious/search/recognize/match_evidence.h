// recognize/, after a search, for a person who asks why a sighting was reported: matches the sighting's frame with its
// view again and keeps the matches stage by stage. In: the frame's features, the model, the view and the place in the
// frame. Out: every match of descriptors, how many stages it passed, and the pose.
//
// The stages are those of the method that searches the model (model_searcher.h), each a subset of the one before:
//   grammar  ratio test; scales and distances; orientations; strict scales and distances; inliers of the similarity
//   votes    ranked matches; votes for the object's position, rotation and scale; inliers of the similarity
// Votes are made as the search makes them (template_matcher.h): with the templates for diffuse light and, if the sun is
// known, with those relit for it; a view without a certain pose is pooled with its neighbours. The pose of the highest
// -log10 NFA at the given place counts.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/geometry/box.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/recognize/recognize_options.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

enum class EvidenceStage {
  kRatioTest,
  kFirstVoting,
  kSecondVoting,
  kThirdVoting,
  kRankedMatches,
  kPoseVotes,
  kInliers
};

/// The texts in the API.
inline constexpr auto kEvidenceStageTexts =
    std::to_array<EnumText<EvidenceStage>>({{EvidenceStage::kRatioTest, "ratio_test"},
                                            {EvidenceStage::kFirstVoting, "scales"},
                                            {EvidenceStage::kSecondVoting, "orientations"},
                                            {EvidenceStage::kThirdVoting, "strict_scales"},
                                            {EvidenceStage::kRankedMatches, "ranked_matches"},
                                            {EvidenceStage::kPoseVotes, "pose_votes"},
                                            {EvidenceStage::kInliers, "inliers"}});

/// A match of descriptors.
struct EvidenceMatch {
  Eigen::Vector2d in_template_px;  ///< in pixels of the view
  Eigen::Vector2d in_scene_px;     ///< in pixels of the frame
  std::size_t stages = 1;          ///< how many of MatchEvidence::stages it passed, from the first on
};

struct MatchEvidence {
  struct StageCount {
    EvidenceStage stage = EvidenceStage::kInliers;
    std::size_t matches = 0;  ///< that passed it
  };

  std::vector<StageCount> stages;      ///< in their order
  std::vector<EvidenceMatch> matches;  ///< those that passed most stages first
  bool is_relit = false;               ///< of a template relit for the sun, not of one for diffuse light
  bool is_pooled = false;              ///< with keypoints of the neighbouring views
  std::optional<Detection> detection;  ///< the pose at the given place; nullopt: the matches give none
};

/// @param scene            features of the whole frame, as the search makes them
/// @param conditions       as of the search
/// @param relit_templates  of the model; null: none
/// @param view             index into the model's views
/// @param box              of the sighting, px
/// Errors: kInvalidArgument for a view that the model does not have; those of RelitTemplateSource.
/// Cost: that of matching one view and, for votes, its neighbours.
[[nodiscard]] Expected<MatchEvidence> GatherEvidence(const FeatureSet& scene, const FrameConditions& conditions,
                                                     const ObjectModel& model,
                                                     const RelitTemplateSource* relit_templates, std::size_t view,
                                                     const Box& box, const RecognizeOptions& options);

}  // namespace victorious
