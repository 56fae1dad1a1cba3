// Experiment of the thesis's figure 4-2: one object tracked by the tracker alone, and by tracker and recogniser
// together, where each detection becomes the tracker's new template.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/polygon.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/track/track_options.h"

namespace victorious {

/// Outline of the object in one frame by either method, px; std::nullopt where it is lost.
struct TrackingComparisonStep {
  std::int64_t frame = 0;
  double time_s = 0;
  std::optional<Polygon> alone;
  std::optional<Polygon> together;
};

/// Runs both methods from the first detection on. Alone, the tracker runs without appearance check (min_ncc -1)
/// and without confirmation. Together, the recogniser searches the tracked region in every frame, and the whole frame
/// while the track is lost.
/// @param reader      of grey frames
/// @param recognizer  of one model
/// @return one step per frame, from the first detection on; empty without a detection
/// Errors: kInvalidArgument for options out of range; those of reading; kCancelled.
[[nodiscard]] Expected<std::vector<TrackingComparisonStep>> CompareTracking(VideoReader& reader,
                                                                            const Recognizer& recognizer,
                                                                            const FeatureExtractor& extractor,
                                                                            const TrackOptions& options,
                                                                            const CancelToken& cancel);

}  // namespace victorious
