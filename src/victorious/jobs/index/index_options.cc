#include "victorious/jobs/index/index_options.h"

#include <algorithm>
#include <cmath>

namespace victorious {

void KeepOptions::ListFields(FieldList& fields) {
  fields.Add("interval_s", interval_s,
             {.min = -1,
              .max = 1e6,
              .unit = "s",
              .reason = "interval at which the features of a frame are kept for search by example image; 0 keeps each "
                        "frame at the interval of searches, -1 none (docs/formats/index.md gives their size)"});
}

FeatureOptions MakeKeptFeatureOptions(const FeatureOptions& search) {
  constexpr int kMaxFeatures = 4000;
  FeatureOptions kept = search;
  kept.max_features = kMaxFeatures;
  return kept;
}

void VideoOptions::ListFields(FieldList& fields) {
  fields.Add("folder_frame_rate", folder_frame_rate,
             {.min = 0.001,
              .max = 1000,
              .unit = "frames/s",
              .reason = "frame rate of a folder of images, which have no time stamps"});
}

void ResolutionOptions::ListFields(FieldList& fields) {
  fields.Add("object_px", object_px,
             {.min = 0,
              .max = 10'000,
              .unit = "px",
              .reason = "diagonal that the smallest CAD model keeps where frames are shrunk before they are searched; "
                        "telemetry and the height above the ground give its size; 0 searches frames as filmed"});
}

void ShapeSearchOptions::ListFields(FieldList& fields) {
  fields.Add(
      "enabled", enabled,
      {.reason = "CAD models are also searched for by the shape of their edges, where telemetry and the motion of "
                 "the image give the height above the ground, or objects of three models or more agree on their "
                 "size: objects of one colour, small or repainted; of one or two models also large objects in any "
                 "pose"});
  fields.Add("interval_s", interval_s,
             {.min = 0,
              .max = 1000,
              .unit = "s",
              .reason = "minimum interval between searches by shape; they take most "
                        "of their time for models that are not there"});
}

void IndexOptions::ListFields(FieldList& fields) {
  ListSearchFields(fields);
  fields.AddGroup("objects", objects);
  fields.AddGroup("ground", ground);
}

void IndexOptions::ListSearchFields(FieldList& fields) {
  fields.AddGroup("video", video);
  fields.AddGroup("resolution", resolution);
  fields.AddGroup("features", features);
  recognize.ListFields(fields);
  fields.AddGroup("shape", shape);
  fields.AddGroup("categories", categories);
  fields.AddGroup("detector", detector);
  fields.AddGroup("daylight", sun_direction);
  fields.AddGroup("telemetry", telemetry);
  fields.AddGroup("follow", follow);
  fields.AddGroup("grow", grow);
  fields.AddGroup("tracklets", tracklets);
  fields.AddGroup("keep", keep);
  fields.Add("every", every,
             {.min = 0,
              .max = 1e6,
              .unit = "frames",
              .reason = "interval between full-frame searches; in between, objects are tracked and searched for in "
                        "their regions only; 0 chooses it by the frame rate and the motion of the image: 0.2 to 0.7 s "
                        "for models, for a third of their views each time, every frame for categories, "
                        "`detector.interval_s` for those of an imported detector"});
}

namespace {

// Frames between two that are tracked, at least `frame_interval_s` apart, but for the rounding of frame rates.
int TrackedInterval(const FollowOptions& follow, double frame_rate) {
  constexpr double kMaxFrames = 1000;
  constexpr double kRounding = 0.1;
  return static_cast<int>(std::clamp(follow.frame_interval_s * frame_rate + kRounding, 1.0, kMaxFrames));
}

}  // namespace

SearchIntervals MakeSearchIntervals(const IndexOptions& options, const VideoInfo& info) {
  const bool is_tracked = options.follow.enabled && !info.of_images && info.frame_rate > 0;
  const int tracked = is_tracked && !info.live ? TrackedInterval(options.follow, info.frame_rate) : 1;
  if (options.every > 0) return {options.every, options.every, tracked};
  if (!is_tracked) return {};
  constexpr double kMaxFrames = 1e6;
  const auto frames_of = [&](double interval_s) {
    return static_cast<int>(std::lround(std::clamp(interval_s * info.frame_rate, 1.0, kMaxFrames)));
  };
  return {.models = frames_of(options.search_interval_s),
          .categories = frames_of(options.category_interval_s),
          .tracked = tracked};
}

FollowOptions FollowOptionsOf(FollowOptions follow, int tracked) {
  follow.restart_interval_frames =
      static_cast<int>(std::min<std::int64_t>(kNoRestart, std::int64_t{follow.restart_interval_frames} * tracked));
  return follow;
}

TrackletOptions MakeTrackletOptions(TrackletOptions tracklets, const SearchIntervals& intervals,
                                    const FollowOptions* follow, double frame_rate) {
  constexpr double kFrames = 2.5;
  const double frames = std::max(kFrames * std::max(intervals.models, intervals.categories),
                                 follow == nullptr ? 0.0 : (follow->track.missed_frames + 1.5) * intervals.tracked);
  if (frame_rate > 0) tracklets.gap_s = std::max(tracklets.gap_s, frames / frame_rate);
  return tracklets;
}

}  // namespace victorious
