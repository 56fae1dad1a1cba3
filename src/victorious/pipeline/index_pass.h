// One pass over one video: searches it for a set of models and categories from a given frame on.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/sun.h"
#include "victorious/pipeline/camera_states.h"
#include "victorious/pipeline/index_job.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/recognize/category_finder.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/store/index_store.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// Input of a pass. The references outlive it.
struct IndexPass {
  const VideoRecord& video;
  /// One entry per model of the recogniser, in its order, then one per category; all with the same next_frame.
  std::span<const SearchRecord> searches;
  const Recognizer& recognizer;
  const CategoryFinder* categories = nullptr;  ///< null: no categories are searched for
  /// Database id of each category of the finder; std::nullopt for those that this pass does not search for.
  std::span<const std::optional<std::int64_t>> category_ids = {};
  const FeatureExtractor& extractor;
  const FeatureExtractor& kept_extractor;  ///< of the features that are kept
  const IndexOptions& options;
  SearchIntervals intervals;
  CameraStates& cameras;
  std::optional<Sun> sun;             ///< sun direction, if known (sun_direction.h)
  int threads = 0;                    ///< 0: one per hardware thread
  std::optional<double> from_s = {};  ///< see IndexJob
  std::optional<double> to_s = {};
  std::optional<double> duration_s = {};  ///< of the video, if it is known before
  WarningSink inform = {};
};

/// Reads `reader` to its end, commits to `store` on the way, and adds the counts to `report`. A cancelled live source
/// counts as ended. Warnings are passed to `warn` in any case.
/// Errors: those of reading, of feature extraction and of the store; kCancelled, after what was done is stored.
[[nodiscard]] Status RunIndexPass(const IndexPass& pass, VideoReader& reader, const CancelToken& cancel,
                                  IndexStore& store, const WarningSink& warn, IndexReport& report);

}  // namespace victorious
