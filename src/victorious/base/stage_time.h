// Processor time by stage of the program, for `victorious bench index`. Off by default; a scope then costs one load.
//
//   MeasureStages(true);
//   { const StageScope scope(Stage::kMatching); ... }
//   double matching_s = StageTimes()[static_cast<std::size_t>(Stage::kMatching)];
//
// A scope adds the processor time of its own thread. Of nested scopes only the outermost one counts, so that tracking
// and the estimate of the sun include the features and the matching that they cause. What they start on another thread
// counts towards the scope that is opened there: an exact division needs one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "victorious/base/enum_text.h"

namespace victorious {

/// The stages of a frame's way through an index, in the order of the flow.
enum class Stage {
  kReading,         ///< decoding
  kSun,             ///< estimate of the sun's direction at the start of a video
  kFeatures,        ///< keypoints and descriptors of whole frames
  kMatching,        ///< ranked matches of templates with the scene
  kPoses,           ///< votes, MLESAC and significance
  kRelitTemplates,  ///< templates for the sun's direction
  kDetection,       ///< non-maximum suppression and scores
  kShape,           ///< search by the shape of edges
  kNcc,             ///< rescoring of uncertain detections in the image
  kTracking,        ///< of objects and their regions, bearing observations included
  kStore,           ///< linking to tracklets, and the database
};
inline constexpr auto kStageTexts = std::to_array<EnumText<Stage>>({{Stage::kReading, "reading"},
                                                                    {Stage::kSun, "sun"},
                                                                    {Stage::kFeatures, "features"},
                                                                    {Stage::kMatching, "matching"},
                                                                    {Stage::kPoses, "poses"},
                                                                    {Stage::kRelitTemplates, "relit_templates"},
                                                                    {Stage::kDetection, "detection"},
                                                                    {Stage::kShape, "shape"},
                                                                    {Stage::kNcc, "ncc"},
                                                                    {Stage::kTracking, "tracking"},
                                                                    {Stage::kStore, "store"}});
inline constexpr std::size_t kStageCount = kStageTexts.size();
static_assert(kStageCount == static_cast<std::size_t>(Stage::kStore) + 1);

/// Starts the measurement of all threads at zero, or ends it. Not while scopes are open.
void MeasureStages(bool on);

/// Processor time of each stage since MeasureStages(true), s.
[[nodiscard]] std::array<double, kStageCount> StageTimes();

/// Adds the processor time between construction and destruction to a stage. Both on the same thread.
class StageScope {
 public:
  explicit StageScope(Stage stage);
  ~StageScope();
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  std::size_t stage_;
  std::int64_t start_ns_;  // negative: does not count
};

}  // namespace victorious
