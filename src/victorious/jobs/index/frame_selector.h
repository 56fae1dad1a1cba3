// jobs/, which frames of a pass are searched, for what, and in which size.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/category/finder/category_finder.h"
#include "victorious/geometry/similarity.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_pass.h"
#include "victorious/jobs/index/interval_selector.h"
#include "victorious/jobs/index/search_pace.h"
#include "victorious/jobs/index/search_part_writer.h"
#include "victorious/jobs/index/search_scale.h"
#include "victorious/jobs/index/shape_detections.h"
#include "victorious/search/follow/backward_follower.h"
#include "victorious/search/follow/full_search_schedule.h"
#include "victorious/search/recognize/view_part.h"
#include "victorious/track/camera_motion.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// A frame on its way through the stages.
struct FrameWork {
  FollowedFrame now;  ///< from Search on with the image that is searched
  FrameSizes sizes;
  bool is_between = false;                     ///< between two tracked frames: nothing is done with its image
  bool whole = true;                           ///< full-frame search for models
  ViewPart views;                              ///< that are searched for
  bool by_shape = false;                       ///< search for models by their shape
  bool classify = false;                       ///< search for categories
  bool is_slow = false;                        ///< a search that the pace counts
  bool keep = false;                           ///< keep its features
  bool already_stored = false;                 ///< results are stored already: only updates the trackers
  bool motion_only = false;                    ///< before the restart of tracking: only camera motion is needed
  bool has_time = true;                        ///< within the pace of the pass
  bool left_out = false;                       ///< no full-frame search, to keep the pace, although one was due
  std::optional<DamagedTime> damaged;          ///< the time before the frame
  std::optional<Similarity2> now_from_before;  ///< camera motion from the previous frame
  std::optional<CameraState> camera;
  FeatureSet features;
  FeatureSet kept;  ///< set with `keep`
  std::vector<Detection> detections;
  std::vector<ShapeDetection> shape_detections;  ///< those that count join the others when the frame is tracked
  std::vector<Detection> undecided;              ///< by shape: later frames may decide, until then they do not count
  std::vector<FoundCategory> categories;
  std::vector<SightingRecord> sightings;
};

/// Selects the frames to search or track. Call in frame order. Not thread-safe.
class FrameSelector {
 public:
  /// @param first_required_frame  first frame whose camera motion is needed, if before those to search
  FrameSelector(const IndexPass& pass, const VideoInfo& info, SearchPace& pace,
                std::optional<std::int64_t> first_required_frame);

  /// Returns what is to be done with a frame, std::nullopt: nothing. @param behind_s  FrameLoop::ReadBehind
  [[nodiscard]] std::optional<FrameWork> Select(Frame frame, std::optional<double> behind_s);

 private:
  [[nodiscard]] FrameSizes SizesOf(const Frame& frame);
  [[nodiscard]] bool IsBetweenTracked(std::int64_t index) const;

  IntervalSelector kept_frames_;
  double tracked_rate_;  // tracked frames a second; 0: unknown
  IntervalSelector shape_frames_;
  ImageMotionEstimator motion_;
  FullSearchSchedule schedule_;
  SearchScale scale_;
  std::optional<FrameSizes> sizes_;  // of the frames of one interval between restarts of tracks
  std::int64_t sizes_interval_ = 0;
  SearchPace& pace_;
  const IndexPass& pass_;
  std::int64_t next_frame_;
  std::int64_t follow_from_;
  std::int64_t first_frame_;
  bool has_started_ = false;  // a frame from pass_.from_s on has come
};

}  // namespace victorious
