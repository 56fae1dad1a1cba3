#include "victorious/jobs/track/track_job.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/reverse_frame_reader.h"
#include "victorious/jobs/track/box_locator.h"
#include "victorious/jobs/track/track_pass.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/place/cameras/clock_offset.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/track/box_tracker.h"

namespace victorious {
namespace {

// Input of all steps. The references outlive them.
struct TrackContext {
  std::span<const std::string> videos;
  std::span<const UserBox> boxes;
  const TrackBoxesOptions& options;
  const FeatureExtractor& extractor;
  const CancelToken& cancel;
  const WarningSink& warn;
};

// Result of the passes over the first video.
struct FirstVideoTracks {
  std::vector<double> times_s;         // time stamps of the frames
  std::vector<UserBoxTarget> targets;  // in the order in which they were started
  GroundPointTracks ground_points;
};

Expected<CameraStates> LoadCameras(const std::string& video, const VideoInfo& info,
                                   const std::optional<std::string>& file, const TelemetryOptions& options,
                                   const WarningSink& warn) {
  return CameraStates::Load(video, info, file, options, "nothing will get a place",
                            [&](const std::string& warning) { warn(fmt::format("{}: {}", video, warning)); });
}

std::unexpected<Error> EndsBefore(const std::string& video, double end_s, const std::string& why, std::size_t box,
                                  double at_s) {
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: ends at {:.3f} s{}, before {} at {:g} s: give a time in it",
                                                       video, end_s, why, BoxName(box), at_s));
}

// Boxes that the video cannot have: it need not be read to find that out.
Status CheckBoxes(std::span<const UserBox> boxes, const std::string& video, const VideoInfo& info) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const bool is_late = info.duration_s && boxes[i].at_s >= *info.duration_s + kSameTime_s;
    if (is_late && !info.is_duration_estimated) return EndsBefore(video, *info.duration_s, "", i, boxes[i].at_s);
    const Expected<Box> box = BoxTracker::ClipToFrame(boxes[i].box, {info.width, info.height});
    if (!box) return std::unexpected(Error(box.error()).WithContext(BoxName(i)));
  }
  return {};
}

// Opens all videos, before any is read to its end, and reads their telemetry.
// @param telemetry  telemetry file of the first video
Expected<TrackedVideos> OpenVideos(std::span<const std::string> videos, std::span<const UserBox> boxes,
                                   const std::optional<std::string>& telemetry, const TelemetryOptions& options,
                                   const WarningSink& warn) {
  std::vector<VideoInfo> infos;
  for (const std::string& video : videos) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenRereadable(video));
    infos.push_back(reader->info());
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckBoxes(boxes, videos[0], infos[0]));
  TrackedVideos opened;
  opened.sizes.resize(videos.size());
  for (std::size_t video = 0; video < videos.size(); ++video) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        CameraStates cameras,
        LoadCameras(videos[video], infos[video], video == 0 ? telemetry : std::nullopt, options, warn));
    opened.cameras.push_back(std::move(cameras));
  }
  return opened;
}

// @param with_ground_points  also tracks the ground points on which the boxes are drawn
Expected<TrackPass> MakePass(const TrackContext& context, bool with_ground_points) {
  VICTORIOUS_ASSIGN_OR_RETURN(BoxTracker tracker, BoxTracker::Create(context.options.box));
  const auto impulse_fraction =
      with_ground_points ? std::optional(context.options.model.features.impulse_fraction) : std::nullopt;
  return TrackPass(std::move(tracker), context.extractor, context.options.recognize_every, impulse_fraction);
}

// Calls `visit` with every frame of a video.
Status ReadVideo(const TrackContext& context, VideoReader& reader, const std::string& video,
                 const std::function<Status(const Frame&)>& visit) {
  FrameLoop loop(reader, context.cancel, {.label = video});
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameLoopEnd end, loop.ForEach(visit));
  if (end == FrameLoopEnd::kCancelled) return Fail(ErrorCode::kCancelled, "interrupted: nothing was written");
  for (const std::string& warning : reader.warnings()) context.warn(video + ": " + warning);
  return {};
}

void StoreGroundPoints(TrackPass& pass, GroundPointTracks& tracks) {
  for (UserBoxGroundPoint& point : pass.TakeGroundPoints()) tracks[point.box_index][point.seen.frame] = point.seen;
}

// Starts a user box in the last frame that the pass processed: adds its target, its model and its first sighting.
Status StartBox(const TrackContext& context, std::size_t index, const Frame& frame, TrackPass& pass,
                FirstVideoTracks& tracks, std::vector<BoxSighting>& sightings) {
  UserBoxTarget target{.box_index = index, .box = context.boxes[index].box, .frame = frame.index};
  Expected<Box> box = pass.Start(target);
  if (!box) return std::unexpected(std::move(box).error().WithContext(BoxName(index)));
  target.box = *box;
  Expected<std::shared_ptr<const Recognizer>> recognizer =
      MakeBoxRecognizer(frame, target.box, BoxName(index), context.options.model, context.options.recognize);
  if (recognizer) {
    target.recognizer = *recognizer;
    pass.SetRecognizer(target.recognizer);
  } else {
    context.warn(fmt::format("{}: re-detected by its template only: {}", BoxName(index), recognizer.error().message));
  }
  sightings.push_back({.box_index = index,
                       .frame = frame.index,
                       .time_s = frame.time_s,
                       .box = target.box,
                       .extent = target.box,
                       .score = 1});
  tracks.targets.push_back(std::move(target));
  return {};
}

// Tracks the boxes from where they were drawn to the end of the first video.
Expected<FirstVideoTracks> TrackForward(const TrackContext& context, TrackPass& pass, TrackedVideos& videos,
                                        std::vector<BoxSighting>& sightings) {
  const std::string& video = context.videos[0];
  const std::span<const UserBox> boxes = context.boxes;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenRereadable(video));
  FirstVideoTracks tracks;
  tracks.ground_points.resize(boxes.size());
  std::vector<bool> started(boxes.size(), false);
  double last_time_s = 0;
  const auto visit = [&](const Frame& frame) -> Status {
    videos.sizes[0] = frame.image.size();
    tracks.times_s.push_back(frame.time_s);
    VICTORIOUS_RETURN_IF_ERROR(pass.ProcessFrame(frame, 0, nullptr, sightings));
    last_time_s = frame.time_s;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (started[i] || frame.time_s < boxes[i].at_s - kSameTime_s) continue;
      VICTORIOUS_RETURN_IF_ERROR(StartBox(context, i, frame, pass, tracks, sightings));
      started[i] = true;
    }
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(ReadVideo(context, *reader, video, visit));
  StoreGroundPoints(pass, tracks.ground_points);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (started[i]) continue;
    const std::string why = reader->warnings().empty() ? "" : fmt::format(" ({})", reader->warnings().back());
    return EndsBefore(video, last_time_s, why, i, boxes[i].at_s);
  }
  return tracks;
}

// Tracks the boxes from where they were drawn to the beginning of the first video.
Status TrackBackward(const TrackContext& context, TrackPass& pass, FirstVideoTracks& tracks,
                     std::vector<BoxSighting>& sightings) {
  std::int64_t end = 0;
  for (const UserBoxTarget& target : tracks.targets) end = std::max(end, target.frame + 1);
  if (end <= 1) return {};
  const ReverseFrameReader reader(context.videos[0], tracks.times_s, context.options.memory_mb, context.cancel);
  const auto visit = [&](const Frame& frame) -> Status {
    VICTORIOUS_RETURN_IF_ERROR(pass.ProcessFrame(frame, 0, nullptr, sightings));
    for (const UserBoxTarget& target : tracks.targets) {
      if (target.frame == frame.index) VICTORIOUS_RETURN_IF_ERROR(pass.Start(target));
    }
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(reader.ForEach(end, visit));
  StoreGroundPoints(pass, tracks.ground_points);
  return {};
}

// Searches another video for the objects.
// @param static_boxes  one entry per user box
Status SearchVideo(const TrackContext& context, std::size_t video,
                   const std::vector<std::optional<StaticBox>>& static_boxes, TrackPass& pass, TrackedVideos& videos,
                   std::vector<BoxSighting>& sightings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, OpenRereadable(context.videos[video]));
  pass.ChangeVideo();
  const BoxPlacePrior place_prior(static_boxes, videos.cameras[video], context.options.place);
  return ReadVideo(context, *reader, context.videos[video], [&](const Frame& frame) {
    videos.sizes[video] = frame.image.size();
    return pass.ProcessFrame(frame, video, &place_prior, sightings);
  });
}

}  // namespace

void TrackBoxesOptions::ListFields(FieldList& fields) {
  fields.AddGroup("box", box);
  fields.AddGroup("telemetry", telemetry);
  fields.AddGroup("place", place);
  fields.AddGroup("ground", ground);
  fields.Add("recognize_every", recognize_every,
             {.min = 1,
              .max = 100'000,
              .unit = "frames",
              .reason = "interval at which a lost object is searched for by its keypoints: costs as much as tracking "
                        "some ten frames"});
  fields.Add("memory_mb", memory_mb,
             {.min = 1,
              .max = 1'000'000,
              .unit = "MiB",
              .reason = "memory for the frames of the backward pass: less reads the video more often"});
}

Expected<TrackedBoxes> TrackBoxes(std::span<const std::string> videos, std::span<const UserBox> boxes,
                                  const std::optional<std::string>& telemetry, const TrackBoxesOptions& options,
                                  const CancelToken& cancel, const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (videos.empty() || boxes.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "nothing to track: give a video and a box in it");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const Ground> ground, MakeGround(options.ground, warn));
  VICTORIOUS_ASSIGN_OR_RETURN(TrackedVideos opened, OpenVideos(videos, boxes, telemetry, options.telemetry, warn));
  for (std::size_t video = 0; options.telemetry.time_offset_s == 0 && video < videos.size(); ++video) {
    VICTORIOUS_RETURN_IF_ERROR(CorrectTelemetry(
        videos[video], options.model.features.impulse_fraction, FindGiven(options.telemetry), cancel,
        [&](const std::string& warning) { warn(fmt::format("{}: {}", videos[video], warning)); },
        opened.cameras[video]));
  }
  for (std::size_t video = 0; ground && video < videos.size(); ++video) {
    if (!opened.cameras[video].HasStates()) continue;
    const auto underground = DescribeUnderground(opened.cameras[video].trajectory()->states(), *ground);
    if (underground) warn(fmt::format("{}: telemetry: {}", videos[video], *underground));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.model.features));
  const TrackContext context{videos, boxes, options, *extractor, cancel, warn};
  const bool with_telemetry = opened.cameras[0].HasStates();

  TrackedBoxes tracked;
  std::vector<BoxSighting>& sightings = tracked.sightings;
  VICTORIOUS_ASSIGN_OR_RETURN(TrackPass forward, MakePass(context, with_telemetry));
  VICTORIOUS_ASSIGN_OR_RETURN(FirstVideoTracks tracks, TrackForward(context, forward, opened, sightings));
  VICTORIOUS_ASSIGN_OR_RETURN(TrackPass backward, MakePass(context, with_telemetry));
  VICTORIOUS_RETURN_IF_ERROR(TrackBackward(context, backward, tracks, sightings));

  const BoxLocator locator(boxes, opened, tracks.ground_points, ground, options.place);
  locator.Locate(sightings);
  const std::vector<std::optional<StaticBox>> static_boxes = locator.FindStaticBoxes(tracks.targets, sightings);
  for (std::size_t video = 1; video < videos.size(); ++video) {
    TrackPass search = forward;
    VICTORIOUS_RETURN_IF_ERROR(SearchVideo(context, video, static_boxes, search, opened, sightings));
  }
  if (videos.size() > 1) locator.Locate(sightings);
  locator.WarnOfGround(sightings, warn);
  for (std::size_t box_index = 0; box_index < boxes.size(); ++box_index) {
    tracked.place_failures.push_back(locator.DescribePlaceFailure(box_index, sightings));
  }
  return tracked;
}

}  // namespace victorious
