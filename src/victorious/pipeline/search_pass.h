// One reading of one video, searched for one set of models and categories from one frame on.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/sun.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/pipeline/indexer.h"
#include "victorious/pipeline/warning_sink.h"
#include "victorious/recognize/category_finder.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/store/index_store.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// What a pass works on. The references outlive it.
struct SearchPass {
  const VideoRecord& video;
  /// One a model of the recogniser, in its order, then one a category; all at the same next_frame.
  std::span<const SearchRecord> searches;
  const Recognizer& recognizer;
  const CategoryFinder* categories = nullptr;  ///< nothing: no category is sought
  /// Of each category of the finder what the store knows it by; nothing for those that are not sought in this pass.
  std::span<const std::optional<std::int64_t>> category_ids = {};
  const FeatureExtractor& extractor;
  const IndexOptions& options;
  const CameraTrack* cameras = nullptr;  ///< telemetry, if there is any
  std::optional<Sun> sun;                ///< where it stands, if known (daylight.h)
  int threads = 0;                       ///< 0: as many as the machine has
};

/// Reads `reader` to its end and commits to `store` as it goes; adds what it did to `report`. A live source that is
/// cancelled is at its end. Warnings are told however it ends.
Status RunSearchPass(const SearchPass& pass, VideoReader& reader, const CancelToken& cancel, IndexStore& store,
                     const WarningSink& warn, IndexReport& report);

}  // namespace victorious
