// The part of Indexer that estimates the direction of the sun before a pass.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "victorious/geometry/angles.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/jobs/index/indexer_parts.h"
#include "victorious/jobs/index/search_scale.h"
#include "victorious/place/calibrate/assumed_attitude.h"
#include "victorious/place/calibrate/sun_direction.h"
#include "victorious/place/calibrate/time_offset.h"

namespace victorious {

bool HasAttitudes(const CameraTrajectory* trajectory) {
  return trajectory != nullptr &&
         std::ranges::any_of(trajectory->states(), [](const CameraState& state) { return state.attitude.has_value(); });
}

// The tilt is unknown: the first of these angles off nadir is taken at which the sun's direction is certain. Objects
// are searched for within 20 degrees of the vertical.
Status Indexer::AssumeSun(const Recognizer& recognizer, const IndexJob& job, OpenedVideo& video,
                          const CancelToken& cancel, const WarningSink& warn, IndexReport& report) const {
  constexpr std::array kOffNadir_rad = {RadiansFromDegrees(45), RadiansFromDegrees(65)};
  constexpr double kMaxDuration_s = 60;  // the yaw drifts, and the tilt may change
  const VideoInfo& info = video.reader->info();
  if (options_.sun_direction.sun == SunSearch::kOff || !recognizer.HasRelitTemplates() || info.live ||
      video.cameras.is_of_photos() || !info.duration_s || *info.duration_s > kMaxDuration_s) {
    return {};
  }
  const auto motions =
      MeasureMotions(job.video, {.max_duration_s = kMaxDuration_s}, options_.features.impulse_fraction, cancel);
  if (!motions) {
    if (motions.error().code == ErrorCode::kCancelled) return std::unexpected(motions.error());
    return {};  // the search of the same video reports it
  }
  for (const double off_nadir_rad : kOffNadir_rad) {
    std::vector<CameraState> states = AssumeAttitudes(*motions, off_nadir_rad);
    if (states.empty()) return {};
    const CameraTrajectory assumed(states, kMaxDuration_s);
    VICTORIOUS_ASSIGN_OR_RETURN(
        report.sun, EstimateSunDirection({assumed, recognizer, *extractor_, options_.sun_direction, job.threads, true},
                                         *video.reader, cancel, warn));
    VICTORIOUS_ASSIGN_OR_RETURN(video.reader, VideoReader::Open(job.video, MakeReaderOptions(job)));
    if (!report.sun) continue;
    video.cameras.SetAssumedAttitudes(std::move(states));
    report.sun_from_camera = true;
    report.sun_by_clock = false;
    return {};
  }
  return {};
}

Status Indexer::EstimateSun(const Recognizer& recognizer, const IndexJob& job, OpenedVideo& video,
                            const CancelToken& cancel, const WarningSink& warn, IndexReport& report) const {
  const CameraTrajectory* trajectory = video.cameras.trajectory();
  report.sun.reset();
  report.sun_from_camera = false;
  video.cameras.SetAssumedAttitudes({});
  report.sun_by_clock =
      trajectory != nullptr &&
      std::ranges::any_of(trajectory->states(), [](const CameraState& state) { return state.utc_us.has_value(); });
  if (recognizer.models().empty()) return {};
  if (!HasAttitudes(trajectory)) {
    VICTORIOUS_RETURN_IF_ERROR(AssumeSun(recognizer, job, video, cancel, warn, report));
    if (report.sun || trajectory == nullptr) return {};
  }
  const SearchScale scale(
      {.models = recognizer.models(),
       .cameras = video.cameras,
       .ground = options_.objects.ground.get(),
       .object_px = options_.resolution.object_px,
       .restart_interval_frames = FollowOptionsOf(options_.follow, video.intervals.tracked).restart_interval_frames},
      video.reader->info());
  VICTORIOUS_ASSIGN_OR_RETURN(
      report.sun,
      EstimateSunDirection(
          {.cameras = *trajectory,
           .recognizer = recognizer,
           .extractor = *extractor_,
           .options = options_.sun_direction,
           .threads = job.threads,
           .searched_image = [&](const Frame& frame) { return scale.ShrinkNear(frame.time_s, frame.image); }},
          *video.reader, cancel, warn));
  if (video.reader->info().live) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(video.reader, VideoReader::Open(job.video, MakeReaderOptions(job)));
  return {};
}

}  // namespace victorious
