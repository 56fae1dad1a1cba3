// The thesis's figure 4-2: one object followed by the tracker alone, and by tracker and recogniser together, each of
// whose finds becomes the tracker's template.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/polygon.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/track/track_options.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// Where each has the object's outline in one frame, px; nothing where it has none.
struct LockStep {
  std::int64_t frame = 0;
  double time_s = 0;
  std::optional<Polygon> alone;
  std::optional<Polygon> together;
};

/// Both begin at the first detection. Alone, the tracker follows whatever moves (least_likeness -1) and is never
/// confirmed; together, the recogniser searches the tracked region in every frame, and the whole frame while there is
/// none.
/// @param reader      of grey frames
/// @param recognizer  of one model
/// @return a step a frame, from the first detection on; none if there is no detection
/// Errors: kInvalidArgument for options out of range; those of reading; kCancelled.
Expected<std::vector<LockStep>> CompareLock(VideoReader& reader, const Recognizer& recognizer,
                                            const FeatureExtractor& extractor, const TrackOptions& options,
                                            const CancelToken& cancel);

}  // namespace victorious
