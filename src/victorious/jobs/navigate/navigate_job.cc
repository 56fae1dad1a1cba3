#include "victorious/jobs/navigate/navigate_job.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/model_engine.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/place/cameras/camera_states.h"

namespace victorious {

NavigateVideoOptions::NavigateVideoOptions() {
  follow.restart_interval_frames = kNoRestart;
  follow.search_interval_s = 0.5;
}

void NavigateVideoOptions::ListFields(FieldList& fields) {
  fields.AddGroup("video", video);
  fields.AddGroup("features", features);
  recognize.ListFields(fields);
  fields.AddGroup("daylight", sun_direction);
  fields.AddGroup("telemetry", telemetry);
  fields.AddGroup("follow", follow);
  fields.AddGroup("landmark_list", list);
  navigate.ListFields(fields);
  fields.Add("second_pass", second_pass,
             {.reason = "runs a second pass over the video if there is no telemetry, or if its attitude is off by a "
                        "degree or more: the second pass uses the estimated attitude for upright and relit templates"});
  fields.Add("every", every,
             {.min = 1,
              .max = 1e6,
              .unit = "frames",
              .reason = "interval between full-frame searches while a landmark is tracked"});
  fields.Add("lost_every", lost_every,
             {.min = 1,
              .max = 1e6,
              .unit = "frames",
              .reason = "interval between full-frame searches while no landmark is tracked"});
}

namespace {

using Clock = std::chrono::steady_clock;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Telemetry, if there is any; the field of view from the parameters, else from telemetry, is known at any time.
Expected<CameraStates> LoadCameras(const NavigateJob& job, const NavigateVideoOptions& options, const VideoInfo& info,
                                   const WarningSink& warn) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      CameraStates cameras,
      CameraStates::Load(job.video, info, job.telemetry, options.telemetry, "navigation uses landmarks only", warn));
  std::optional<double> hfov_rad = GivenFieldOfView(options.telemetry);
  if (!hfov_rad) hfov_rad = cameras.first_hfov_rad();
  if (!hfov_rad) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: the camera's field of view is unknown: give --hfov DEG, or telemetry with a field of view",
                    job.video));
  }
  cameras.SetFallbackFieldOfView(hfov_rad);
  return cameras;
}

// Drops models without a landmark and landmarks without a model.
Status MatchModelsToLandmarks(std::vector<ObjectModel>& models, std::vector<Landmark>& landmarks,
                              const std::string& list, const WarningSink& warn) {
  std::set<std::string> named;
  for (const Landmark& landmark : landmarks) named.insert(landmark.model);
  std::erase_if(models, [&](const ObjectModel& model) { return !named.contains(model.name); });
  std::set<std::string> missing = named;
  for (const ObjectModel& model : models) missing.erase(model.name);
  if (models.empty()) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: no model of its landmarks ({}) is in the model folder: make one with `victorious model add`",
                    list, fmt::join(missing, ", ")));
  }
  if (!missing.empty()) warn(fmt::format("landmarks without a model are skipped: {}", fmt::join(missing, ", ")));
  std::erase_if(landmarks, [&](const Landmark& landmark) { return missing.contains(landmark.model); });
  return {};
}

// What a pass needs to find landmarks. The references outlive it.
struct PassContext {
  const NavigateVideoOptions& options;
  const Recognizer& recognizer;
  const FeatureExtractor& extractor;
  const WarningSink& warn;
  std::vector<std::vector<std::size_t>> landmarks_by_model;  // landmark indices, by model
};

// Attitude that is known before the search, and the sun's direction.
struct KnownAttitude {
  const CameraTrajectory* track = nullptr;
  std::optional<Sun> sun;
};

// One pass over the video.
class Pass {
 public:
  Pass(const PassContext& context, Follower follower, const CameraStates& cameras, const KnownAttitude& held)
      : context_(context), follower_(std::move(follower)), cameras_(cameras), held_(held) {}

  Status ProcessFrame(const Frame& frame) {
    const Clock::time_point start = Clock::now();
    const std::clock_t cpu_start = std::clock();
    const CameraState camera = cameras_.At(frame.time_s).value();
    std::optional<CameraState> held;
    if (held_.track != nullptr) held = held_.track->At(frame.time_s);
    const FrameConditions conditions = MakeFrameConditions(held, frame.image.size(), held_.sun);
    const bool whole = since_whole_ + 1 >= (landmarks_last_ > 0 ? context_.options.every : context_.options.lost_every);
    since_whole_ = whole ? 0 : since_whole_ + 1;
    FeatureSet features;
    std::vector<Detection> detections;
    std::optional<FullFrameResult> searched;
    Frame clean = frame;
    clean.image = RemoveImpulses(frame.image, context_.options.features.impulse_fraction);
    if (whole) {
      VICTORIOUS_ASSIGN_OR_RETURN(features, context_.extractor.Extract(frame.image));
      VICTORIOUS_ASSIGN_OR_RETURN(detections, context_.recognizer.Recognize(features, conditions, clean.image));
      searched.emplace(features, detections);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObservedObject> all, follower_.Follow(clean, searched, conditions));
    landmarks_last_ = all.size();
    for (const ObservedObject& seen : all) AddSighting(seen, camera);
    frames_.push_back({frame.time_s, std::nullopt});
    if (camera.attitude && camera.IsComplete()) frames_.back().measured = camera;
    if (whole || all.empty()) return {};
    tracked_ms_.push_back(MillisecondsSince(start));
    tracked_cpu_ms_.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
    return {};
  }

  [[nodiscard]] const std::vector<NavigationFrame>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<LandmarkSighting>& sightings() const { return sightings_; }
  [[nodiscard]] double tracked_ms() const { return MedianOr(tracked_ms_, 0); }
  [[nodiscard]] double tracked_cpu_ms() const { return MedianOr(tracked_cpu_ms_, 0); }

 private:
  void AddSighting(const ObservedObject& seen, const CameraState& camera) {
    const Detection& detection = seen.detection;
    const auto object_pose = EstimateObjectPose(detection, context_.recognizer.models()[detection.model_index],
                                                seen.features, camera, context_.options.observation);
    if (!object_pose) return;
    auto sighting = MakeLandmarkSighting(*object_pose, context_.options.observation, context_.options.sighting);
    if (!sighting) return;
    sighting->frame = frames_.size();
    sighting->model = detection.model_index;
    sightings_.push_back(*std::move(sighting));
  }

  const PassContext& context_;
  Follower follower_;
  const CameraStates& cameras_;
  KnownAttitude held_;
  std::vector<NavigationFrame> frames_;
  std::vector<LandmarkSighting> sightings_;
  std::vector<double> tracked_ms_;
  std::vector<double> tracked_cpu_ms_;
  std::size_t landmarks_last_ = 0;
  int since_whole_ = 1000000;
};

struct Source {
  std::string video;
  VideoReaderOptions reading;
  bool live = false;
};

// Runs a pass from the first frame of the reader to its end.
Expected<Pass> RunPass(const PassContext& context, const Source& source, const CameraStates& cameras,
                       const std::optional<CameraTrajectory>& held, std::unique_ptr<VideoReader>& reader,
                       const CancelToken& cancel) {
  KnownAttitude known;
  if (held) {
    known.track = &*held;
    VICTORIOUS_ASSIGN_OR_RETURN(
        known.sun, EstimateSunDirection({*held, context.recognizer, context.extractor, context.options.sun_direction},
                                        *reader, cancel, context.warn));
    if (!source.live) {
      VICTORIOUS_ASSIGN_OR_RETURN(reader, VideoReader::Open(source.video, source.reading));
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Follower follower,
                              Follower::Create(context.recognizer, context.extractor, context.options.follow));
  Pass pass(context, std::move(follower), cameras, known);
  FrameLoop loop(*reader, cancel, {.label = source.video});
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameLoopEnd end,
                              loop.ForEach([&](const Frame& frame) { return pass.ProcessFrame(frame); }));
  if (end == FrameLoopEnd::kCancelled && !source.live) {
    return Fail(ErrorCode::kCancelled, fmt::format("{}: stopped; nothing was written", source.video));
  }
  return pass;
}

// Runs a pass over the video and estimates the trajectory.
Expected<NavigationResult> RunPassAndNavigate(const PassContext& context, const Source& source,
                                              const CameraStates& cameras, const std::optional<CameraTrajectory>& held,
                                              const LandmarkList& list, std::unique_ptr<VideoReader>& reader,
                                              const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Pass pass, RunPass(context, source, cameras, held, reader, cancel));
  const Clock::time_point start = Clock::now();
  std::vector<CameraState> rows;
  if (cameras.trajectory() != nullptr) rows = cameras.trajectory()->states();
  NavigationResult result;
  VICTORIOUS_ASSIGN_OR_RETURN(
      result.navigation, Navigate({pass.frames(), rows, list.landmarks, context.landmarks_by_model, pass.sightings(),
                                   list.common_covariance_enu_m2},
                                  context.options.navigate));
  result.estimate_ms = MillisecondsSince(start) / static_cast<double>(std::max<std::size_t>(1, pass.frames().size()));
  result.frames = static_cast<std::int64_t>(pass.frames().size());
  result.tracked_ms = pass.tracked_ms();
  result.tracked_cpu_ms = pass.tracked_cpu_ms();
  return result;
}

// Estimated camera states of the frames whose attitude is accurate enough for upright templates. std::nullopt if there
// are none.
std::optional<CameraTrajectory> AccurateStates(const Navigation& navigation, const CameraStates& cameras,
                                               const NavigateVideoOptions& options) {
  constexpr double kMaxSigmaDeg = 6;
  std::vector<CameraState> states;
  for (const NavigatedFrame& frame : navigation.frames) {
    if (*frame.camera.sigma_attitude_rad > RadiansFromDegrees(kMaxSigmaDeg)) continue;
    states.push_back(frame.camera);
    states.back().hfov_rad = cameras.At(frame.camera.time_s)->hfov_rad;
  }
  if (states.empty()) return std::nullopt;
  return CameraTrajectory(std::move(states), options.telemetry.max_gap_s);
}

// True if telemetry has attitudes and their median error is below 1 degree, which suffices for upright and relit
// templates.
bool IsTelemetryAttitudeAccurate(const Navigation& navigation, const CameraStates& cameras) {
  constexpr double kMaxErrorDeg = 1;
  std::vector<double> turns_rad;
  for (const NavigatedFrame& frame : navigation.frames) {
    const CameraState measured = cameras.At(frame.camera.time_s).value();
    if (!measured.attitude || !frame.camera.attitude) continue;
    turns_rad.push_back(CameraFromEnu(*measured.attitude).angularDistance(CameraFromEnu(*frame.camera.attitude)));
  }
  return !turns_rad.empty() && Median(std::move(turns_rad)) < RadiansFromDegrees(kMaxErrorDeg);
}

}  // namespace

Expected<NavigationResult> NavigateVideo(const NavigateJob& job, std::vector<ObjectModel> models,
                                         const NavigateVideoOptions& options, const CancelToken& cancel,
                                         const WarningSink& warn) {
  NavigateVideoOptions checked = options;
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(checked));
  VICTORIOUS_ASSIGN_OR_RETURN(LandmarkList list, ReadLandmarks(job.landmarks, options.list));
  for (const std::string& warning : list.warnings) warn(job.landmarks + ": " + warning);
  VICTORIOUS_RETURN_IF_ERROR(MatchModelsToLandmarks(models, list.landmarks, job.landmarks, warn));
  VICTORIOUS_RETURN_IF_ERROR(AdoptEngineOfModels(models, checked.features, warn));
  const VideoReaderOptions reading{.folder_frame_rate = options.video.folder_frame_rate};
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<VideoReader> reader, VideoReader::Open(job.video, reading));
  VICTORIOUS_ASSIGN_OR_RETURN(const CameraStates cameras, LoadCameras(job, options, reader->info(), warn));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(checked.features));

  std::vector<std::vector<std::size_t>> landmarks_by_model(models.size());
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (std::size_t i = 0; i < list.landmarks.size(); ++i) {
      if (list.landmarks[i].model == models[m].name) landmarks_by_model[m].push_back(i);
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto relit_templates, MakeRelitViews(models));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Recognizer recognizer,
      Recognizer::Create(std::move(models), checked.features.engine, checked.recognize, relit_templates));
  const PassContext context{checked, recognizer, *extractor, warn, std::move(landmarks_by_model)};
  const Source source{job.video, reading, reader->info().live};
  std::optional<CameraTrajectory> held;
  if (cameras.trajectory() != nullptr) held = *cameras.trajectory();
  VICTORIOUS_ASSIGN_OR_RETURN(NavigationResult result,
                              RunPassAndNavigate(context, source, cameras, held, list, reader, cancel));
  if (options.second_pass && !source.live &&
      (cameras.trajectory() == nullptr || !IsTelemetryAttitudeAccurate(result.navigation, cameras))) {
    // The attitude is now known, or known better than from telemetry, so a second pass finds more.
    held = AccurateStates(result.navigation, cameras, options);
    if (held) {
      VICTORIOUS_ASSIGN_OR_RETURN(reader, VideoReader::Open(job.video, reading));
      VICTORIOUS_ASSIGN_OR_RETURN(result, RunPassAndNavigate(context, source, cameras, held, list, reader, cancel));
    }
  }
  for (const std::string& warning : reader->warnings()) warn(warning);
  result.landmarks = std::move(list.landmarks);
  result.sightings.resize(result.landmarks.size());
  for (const auto& assigned : result.navigation.landmark_by_sighting) {
    (assigned ? result.sightings[*assigned] : result.rejected_sightings) += 1;
  }
  for (const NavigatedFrame& frame : result.navigation.frames) {
    result.states.push_back(frame.camera);
    const CameraState camera = cameras.At(frame.camera.time_s).value();
    result.states.back().hfov_rad = camera.hfov_rad;
    result.states.back().distortion = camera.distortion;
    result.states.back().utc_us = camera.utc_us;
  }
  return result;
}

std::string ToCsv(const NavigationResult& result) {
  const std::vector<NavigatedFrame>& frames = result.navigation.frames;
  std::vector<CsvColumn> columns;
  const auto add = [&](const char* name, const auto& cell) {
    CsvColumn& column = columns.emplace_back(CsvColumn{name, {}});
    for (const NavigatedFrame& frame : frames) column.cells.push_back(cell(frame));
  };
  add("landmarks", [](const NavigatedFrame& frame) { return fmt::format("{}", frame.landmarks); });
  constexpr std::array kAxes = {"east", "north", "up"};
  for (int i = 0; i < 3; ++i) {
    for (int k = i; k < 3; ++k) {
      const std::string name = fmt::format("covariance_{}_{}_m2", kAxes[i], kAxes[k]);
      add(name.c_str(), [&](const NavigatedFrame& frame) { return fmt::format("{:.6g}", frame.covariance(i, k)); });
    }
  }
  const bool offset = std::ranges::any_of(frames, [](const NavigatedFrame& frame) { return frame.offset.has_value(); });
  constexpr std::array<std::string_view, 3> kColumnsEvenIfEmpty = {"sigma_position_m", "sigma_attitude_deg",
                                                                   "vertical_datum"};
  if (!offset) return FormatCameraCsv(result.states, columns, kColumnsEvenIfEmpty);
  const auto add_offset = [&](const char* name, const auto& value) {
    add(name, [&](const NavigatedFrame& frame) {
      return frame.offset ? fmt::format("{:.4f}", value(*frame.offset)) : std::string();
    });
  };
  constexpr std::array kPlaces = {"offset_east_m", "offset_north_m", "offset_up_m"};
  constexpr std::array kAngles = {"offset_yaw_deg", "offset_pitch_deg", "offset_roll_deg"};
  for (int i = 0; i < 3; ++i) {
    add_offset(kPlaces[i], [i](const TelemetryOffset& measured) { return measured.place_enu_m[i]; });
  }
  for (int i = 0; i < 3; ++i) {
    add_offset(kAngles[i],
               [i](const TelemetryOffset& measured) { return DegreesFromRadians(measured.attitude_rad[i]); });
  }
  return FormatCameraCsv(result.states, columns, kColumnsEvenIfEmpty);
}

}  // namespace victorious
