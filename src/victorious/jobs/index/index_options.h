// All parameters of an index run in one struct: read from `--params`, stored in the index with the results, and printed
// by `victorious params`.
#pragma once

#include "victorious/base/options.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/category/network/network_detector.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/track_growth.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/tracklet_linker.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/place/observe/object_pose.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/types/index_records.h"

namespace victorious {

/// Which frames' features the index keeps for search by example image.
struct KeepOptions {
  double interval_s = 1.0;  ///< between kept frames, s; 0 keeps each frame at the interval of searches, below 0 none

  void ListFields(FieldList& fields);
};

/// The options of the kept features: those of the search, but at most 4000 keypoints a frame, of the highest contrast,
/// which bounds the size of the index (docs/formats/index.md). A higher contrast threshold would cost what is found in
/// videos of low contrast, which take little space anyway.
[[nodiscard]] FeatureOptions MakeKeptFeatureOptions(const FeatureOptions& search);

/// How video sources are read.
struct VideoOptions {
  double folder_frame_rate = 10.0;  ///< of a folder of images, frames/s

  void ListFields(FieldList& fields);
};

/// The search for CAD models by the shape of their edges (search/recognize/shape_search.h).
struct ShapeSearchOptions {
  bool enabled = true;
  double interval_s = 1;  ///< between two searches at least
  /// Standard deviations of a match: of its centre, of its range as a fraction, and of its direction of view. Not user
  /// parameters.
  double centre_sigma_px = 2;
  double range_sigma_fraction = 0.06;
  double view_sigma_deg = 4;

  void ListFields(FieldList& fields);
};

/// How far frames are shrunk before they are searched (search_scale.h).
struct ResolutionOptions {
  double object_px = 110;  ///< that the diagonal of the smallest CAD model keeps; 0: frames are searched as filmed

  void ListFields(FieldList& fields);
};

struct IndexOptions {
  VideoOptions video;
  ResolutionOptions resolution;
  FeatureOptions features = LowContrastFeatureOptions();
  RecognizeOptions recognize;
  ShapeSearchOptions shape;
  CategoryFindOptions categories;
  DetectorOptions detector;
  SunDirectionOptions sun_direction;
  TelemetryOptions telemetry;
  ObservationOptions observation;  ///< Not a user parameter
  FollowOptions follow;
  GrowOptions grow;
  TrackletOptions tracklets;
  ObjectOptions objects;
  GroundOptions ground;
  KeepOptions keep;
  int every = 0;  ///< frames between full-frame searches; 0: MakeSearchIntervals() chooses
  /// Between full-frame searches for models where `every` is 0: less for a part of their views, and more where the
  /// image moves slowly (full_search_schedule.h). Not a user parameter.
  double search_interval_s = 0.3;
  /// Between searches for categories where `every` is 0; 0: every frame. Not a user parameter: that of DetectorOptions,
  /// if the categories are those of a detector.
  double category_interval_s = 0;

  void ListFields(FieldList& fields);

  /// Lists the parameters that affect what is stored for a video. The others only affect data association
  /// (update_objects.h), so they may change without a new search.
  void ListSearchFields(FieldList& fields);
};

/// The numbers of frames between two full-frame searches, and between two that are tracked.
struct SearchIntervals {
  int models = 1;
  int categories = 1;
  int tracked = 1;  ///< between two frames in which models are tracked

  [[nodiscard]] int Of(const ModelRecord& target) const { return target.IsCategory() ? categories : models; }

  bool operator==(const SearchIntervals&) const = default;
};

/// The intervals of a video: `every` for both, if it is set. Else the models, which are tracked between two searches,
/// are searched for each `search_interval_s`, by the frame rate, and the categories each `category_interval_s`.
/// Images of a folder, which need not follow each other closely, and frames of an unknown rate are all searched, as are
/// those of a search without tracking. Frames of a video are tracked each `follow.frame_interval_s`, those of a live
/// source all.
[[nodiscard]] SearchIntervals MakeSearchIntervals(const IndexOptions& options, const VideoInfo& info);

/// The options with the interval of restarts in frames of the video. @param tracked  of its SearchIntervals
[[nodiscard]] FollowOptions FollowOptionsOf(FollowOptions follow, int tracked);

/// The options with the gap of a tracklet raised to 2.5 searched frames, and to the frames that a track may miss.
/// @param follow      null: nothing is tracked
/// @param frame_rate  0: unknown, the options stay as they are
[[nodiscard]] TrackletOptions MakeTrackletOptions(TrackletOptions tracklets, const SearchIntervals& intervals,
                                                  const FollowOptions* follow, double frame_rate);

}  // namespace victorious
