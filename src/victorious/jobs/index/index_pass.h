// One pass over one video: searches it for a set of models and categories from a given frame on.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/geometry/sun.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/frame_results.h"
#include "victorious/jobs/index/index_job.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/store/index_store.h"
#include "victorious/store/segment_store.h"

namespace victorious {

/// Where a pass over one segment of a video writes its results.
struct SegmentOutput {
  std::int64_t first_read = 0;  ///< the last frame before the segment that is searched as a whole, or the first of it
  FrameInterval frames;         ///< of the segment; the pass ends with it
  /// Receives the results in the order of frames.
  std::function<void(FrameResult result, std::optional<KeptFrame> kept)> add;
};

/// Input of a pass. The references outlive it.
struct IndexPass {
  const IndexJob& job;
  const VideoRecord& video;
  /// One entry per model of the recogniser, in its order, then one per category; all with the same next_frame.
  std::span<const SearchRecord> searches;
  const Recognizer& recognizer;
  const CategorySource* categories = nullptr;  ///< null: no categories are searched for
  /// Database id of each category of the source; std::nullopt for those that this pass does not search for.
  std::span<const std::optional<std::int64_t>> category_ids = {};
  const ShapeSearch* shapes = nullptr;  ///< null: models are not searched for by their shape
  const FeatureExtractor& extractor;
  const FeatureExtractor& kept_extractor;  ///< of the features that are kept
  const IndexOptions& options;
  FollowOptions follow;  ///< options.follow, or that of a pass that keeps a pace
  SearchIntervals intervals;
  CameraStates& cameras;
  std::optional<Sun> sun = {};            ///< sun direction, if known (sun_direction.h)
  std::optional<double> duration_s = {};  ///< of the video, if it is known before
  std::string source = {};                ///< the live source whose times the frames cover (CoveredTime); empty: none
  std::optional<std::int64_t> recorded_utc_us = {};  ///< when the first frame came; std::nullopt: they come now
  std::span<const double> times_s = {};              ///< of all frames; only used by JoinFrames, which needs them
  /// Of a segment, whose `searches` begin at its first frame; null: all frames. Nothing is written to the store then.
  const SegmentOutput* segment = nullptr;
};

/// True if objects of models are tracked between full-frame searches.
[[nodiscard]] inline bool IsTrackingEnabled(const IndexPass& pass) {
  return pass.follow.enabled && !pass.recognizer.models().empty();
}

/// True if what a detector finds is tracked between the frames that it searches. Categories of other sources are
/// searched for in full frames only.
[[nodiscard]] inline bool FollowsCategories(const IndexPass& pass) {
  return pass.follow.enabled && pass.categories != nullptr && pass.categories->IsDetector() &&
         pass.intervals.categories > 1;
}

/// True if the frame lies beyond the interval of time to search, or the segment.
[[nodiscard]] inline bool IsBeyondEnd(const IndexPass& pass, const Frame& frame) {
  return (pass.job.to_s && frame.time_s > *pass.job.to_s + kSameTime_s) ||
         (pass.segment && frame.index >= pass.segment->frames.to);
}

/// Reads `reader` to its end, commits to `store` on the way, and adds the counts to `report`. A cancelled live source
/// counts as ended. Warnings are passed to `warn` in any case.
/// Errors: those of reading, of feature extraction and of the store; kCancelled, after what was done is stored.
[[nodiscard]] Status RunIndexPass(const IndexPass& pass, VideoReader& reader, const CancelToken& cancel,
                                  IndexStore& store, const WarningSink& warn, IndexReport& report);

/// The first frame whose results a pass needs: that of the searches, or an earlier one whose camera motion affects the
/// linking of tracklets. Error: that of the store.
[[nodiscard]] Expected<std::int64_t> FirstLinkedFrame(const IndexPass& pass, const VideoInfo& info, IndexStore& store);

/// Links the results of the frames of a video from FirstLinkedFrame on, which were searched in segments, and commits
/// them: the same as RunIndexPass on all frames, but for the length of the video.
/// @param visit   calls its argument with the results of one segment after the other
/// @param is_end  the last of them ends the video: the searches are finished. Else later frames are joined by another
///   call, whose pass begins where this one ended
/// Errors: those of `visit` and of the store; kCancelled, after what was linked is stored.
[[nodiscard]] Status JoinFrames(
    const IndexPass& pass, const VideoInfo& info,
    const std::function<Status(const std::function<Status(std::vector<FrameResult>)>& add)>& visit, bool is_end,
    const CancelToken& cancel, IndexStore& store, IndexReport& report);

}  // namespace victorious
