#include "victorious/calibrate/sun_survey.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/geometry/angles.h"

namespace victorious {

void DaylightOptions::ListFields(FieldList& fields) {
  fields.Add("sun", sun,
             {.choices = {"auto", "off"},
              .reason = "auto: also searches for CAD models with templates relit for the sun's direction, if telemetry "
                        "has the camera's attitude; off: templates for diffuse light only"});
  fields.Add("min_frames", min_frames,
             {.min = 1,
              .max = 1e6,
              .unit = "frames",
              .reason = "minimum number of frames sampled for the sun's direction if telemetry has no clock; in long "
                        "videos one frame in a hundred"});
  fields.Add(
      "max_frames", max_frames,
      {.min = 1, .max = 1e6, .unit = "frames", .reason = "maximum number of frames sampled for the sun's direction"});
}

namespace {

// Two estimates agree within this angle: the spacing of the coarse grid of sun directions.
constexpr double kConsensusGate_rad = kPi / 6;

Eigen::Vector3d DirectionFromSun(const Sun& sun) {
  return {std::cos(sun.elevation_rad) * std::sin(sun.azimuth_rad),
          std::cos(sun.elevation_rad) * std::cos(sun.azimuth_rad), std::sin(sun.elevation_rad)};
}

Sun SunFromDirection(const Eigen::Vector3d& direction) {
  return {.azimuth_rad = std::atan2(direction.x(), direction.y()),
          .elevation_rad = std::atan2(direction.z(), std::hypot(direction.x(), direction.y()))};
}

// By the ephemeris, at the first state with a clock. An outer std::nullopt: no clock. An inner std::nullopt: the sun is
// too low to cast hard light.
std::optional<std::optional<Sun>> SunFromEphemeris(const CameraTrajectory& cameras) {
  constexpr double kMinElevation_rad = 0.1;
  const auto timed =
      std::ranges::find_if(cameras.states(), [](const CameraState& state) { return state.utc_us.has_value(); });
  if (timed == cameras.states().end()) return std::nullopt;
  const Sun sun = SunAt(*timed->utc_us, timed->place);
  return sun.elevation_rad > kMinElevation_rad ? std::optional(sun) : std::nullopt;
}

// Sun direction estimated from one frame.
struct SunDirectionEstimate {
  Eigen::Vector3d direction;  // unit vector
  double neg_log10_nfa;
};

// The largest set of estimates that agree with one of them.
struct SunConsensus {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // directions weighted by -log10 NFA
  int count = 0;
};

SunConsensus FindSunConsensus(const std::vector<SunDirectionEstimate>& estimates) {
  SunConsensus best;
  for (const SunDirectionEstimate& one : estimates) {
    SunConsensus agreement;
    for (const SunDirectionEstimate& other : estimates) {
      if (one.direction.dot(other.direction) < std::cos(kConsensusGate_rad)) continue;
      agreement.sum += other.neg_log10_nfa * other.direction;
      ++agreement.count;
    }
    if (agreement.count > best.count) best = agreement;
  }
  return best;
}

Expected<std::optional<SunDirectionEstimate>> EstimateSunFromFrame(const DaylightInput& survey, const Frame& frame) {
  const std::optional<CameraState> camera = survey.cameras.At(frame.time_s);
  if (!camera || !camera->attitude || !camera->hfov_rad) return std::nullopt;
  const Expected<FeatureSet> features = survey.extractor.Extract(frame.image);
  if (!features) return std::nullopt;
  const FrameConditions conditions = MakeFrameConditions(camera, frame.image.size(), {});
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<SunEstimate> found,
                              survey.recognizer.EstimateSun(*features, *conditions.vertical));
  if (!found) return std::nullopt;
  found->relative_sun.azimuth_rad += camera->attitude->yaw_rad;
  return SunDirectionEstimate{DirectionFromSun(found->relative_sun), found->neg_log10_nfa};
}

}  // namespace

FrameConditions MakeFrameConditions(const std::optional<CameraState>& camera, const cv::Size& size_px,
                                    const std::optional<Sun>& sun) {
  if (!camera || !camera->attitude || !camera->hfov_rad) return {};
  FrameConditions conditions;
  conditions.vertical = MakeVertical(*camera->attitude, *camera->hfov_rad, size_px.width, size_px.height);
  if (sun) conditions.relative_sun = Sun{sun->azimuth_rad - camera->attitude->yaw_rad, sun->elevation_rad};
  return conditions;
}

Expected<std::optional<Sun>> EstimateSunDirection(const DaylightInput& survey, VideoReader& reader,
                                                  const CancelToken& cancel) {
  if (survey.options.sun == "off" || !survey.recognizer.HasRelitTemplates()) return std::nullopt;
  if (const auto known = SunFromEphemeris(survey.cameras)) return *known;
  if (reader.info().live) return std::nullopt;  // a live source cannot be read again for the search

  constexpr std::int64_t kFramesPerSample = 100;
  const std::int64_t frames = reader.info().frame_count.value_or(0);
  const std::int64_t wanted = std::clamp<std::int64_t>(frames / kFramesPerSample, survey.options.min_frames,
                                                       std::max(survey.options.min_frames, survey.options.max_frames));
  constexpr std::int64_t kUnknownStep = 25;  // if the length of the video is unknown
  const std::int64_t step = frames > 0 ? std::max<std::int64_t>(1, frames / wanted) : kUnknownStep;
  constexpr std::size_t kBatchSize = 2;  // frames processed in parallel, independent of the number of threads
  std::vector<SunDirectionEstimate> estimates;
  std::vector<Frame> batch;
  int sampled_frames = 0;
  bool more = true;
  while (more) {
    if (cancel.IsCancelled())
      return Fail(ErrorCode::kCancelled, "stopped while estimating the sun's direction; run again to resume");
    Expected<std::optional<Frame>> frame = reader.NextFrame();
    more = frame && *frame && sampled_frames < std::max(survey.options.min_frames, survey.options.max_frames);
    if (more && (*frame)->index % step == step / 2) {
      batch.push_back(*std::move(*frame));
      ++sampled_frames;
    }
    if (batch.size() < kBatchSize && more) continue;
    std::vector<Expected<std::optional<SunDirectionEstimate>>> batch_estimates(batch.size());
    oneapi::tbb::parallel_for(std::size_t{0}, batch.size(),
                              [&](std::size_t i) { batch_estimates[i] = EstimateSunFromFrame(survey, batch[i]); });
    for (auto& estimate : batch_estimates) {
      if (!estimate) return std::unexpected(std::move(estimate).error());
      if (*estimate) estimates.push_back(**estimate);
    }
    batch.clear();
    constexpr int kMinConsensus = 3;
    if (FindSunConsensus(estimates).count >= kMinConsensus) break;
  }
  const SunConsensus agreement = FindSunConsensus(estimates);
  const bool is_accepted = agreement.count >= 2 || estimates.size() == 1;
  return is_accepted ? std::optional(SunFromDirection(agreement.sum)) : std::nullopt;
}

}  // namespace victorious
