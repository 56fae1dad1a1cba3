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
  fields.Add("least_frames", least_frames,
             {.min = 1,
              .max = 1e6,
              .unit = "frames",
              .reason = "minimum number of frames sampled for the sun's direction if telemetry has no clock; in long "
                        "videos one frame in a hundred"});
  fields.Add(
      "most_frames", most_frames,
      {.min = 1, .max = 1e6, .unit = "frames", .reason = "maximum number of frames sampled for the sun's direction"});
}

namespace {

// Two estimates agree within this angle: the spacing of the coarse grid of sun directions.
constexpr double kAgree_rad = kPi / 6;

Eigen::Vector3d DirectionOf(const Sun& sun) {
  return {std::cos(sun.elevation_rad) * std::sin(sun.azimuth_rad),
          std::cos(sun.elevation_rad) * std::cos(sun.azimuth_rad), std::sin(sun.elevation_rad)};
}

Sun SunIn(const Eigen::Vector3d& direction) {
  return {.azimuth_rad = std::atan2(direction.x(), direction.y()),
          .elevation_rad = std::atan2(direction.z(), std::hypot(direction.x(), direction.y()))};
}

// By the ephemeris, at the first state with a clock. An outer std::nullopt: no clock. An inner std::nullopt: the sun is
// too low to cast hard light.
std::optional<std::optional<Sun>> SunByClock(const CameraTrack& cameras) {
  constexpr double kLowest_rad = 0.1;
  const auto timed =
      std::ranges::find_if(cameras.states(), [](const CameraState& state) { return state.utc_us.has_value(); });
  if (timed == cameras.states().end()) return std::nullopt;
  const Sun sun = SunAt(*timed->utc_us, timed->place);
  return sun.elevation_rad > kLowest_rad ? std::optional(sun) : std::nullopt;
}

// Sun direction estimated from one frame.
struct Answer {
  Eigen::Vector3d direction;  // unit vector
  double evidence;
};

// The largest set of estimates that agree with one of them.
struct Agreement {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // directions weighted by evidence
  int count = 0;
};

Agreement MostAgreement(const std::vector<Answer>& answers) {
  Agreement most;
  for (const Answer& one : answers) {
    Agreement agreement;
    for (const Answer& other : answers) {
      if (one.direction.dot(other.direction) < std::cos(kAgree_rad)) continue;
      agreement.sum += other.evidence * other.direction;
      ++agreement.count;
    }
    if (agreement.count > most.count) most = agreement;
  }
  return most;
}

std::optional<Answer> AskFrame(const DaylightSurvey& survey, const Frame& frame) {
  const std::optional<CameraState> camera = survey.cameras.At(frame.time_s);
  if (!camera || !camera->attitude || !camera->hfov_rad) return std::nullopt;
  const Expected<FeatureSet> features = survey.extractor.Extract(frame.image);
  if (!features) return std::nullopt;
  const FrameConditions conditions = ConditionsOf(camera, frame.image.size(), {});
  std::optional<SunFound> found = survey.recognizer.FindSun(*features, *conditions.vertical);
  if (!found) return std::nullopt;
  found->ahead.azimuth_rad += camera->attitude->yaw_rad;
  return Answer{DirectionOf(found->ahead), found->evidence};
}

}  // namespace

FrameConditions ConditionsOf(const std::optional<CameraState>& camera, const cv::Size& size_px,
                             const std::optional<Sun>& sun) {
  if (!camera || !camera->attitude || !camera->hfov_rad) return {};
  FrameConditions conditions;
  conditions.vertical = MakeVertical(*camera->attitude, *camera->hfov_rad, size_px.width, size_px.height);
  if (sun) conditions.sun_ahead = Sun{sun->azimuth_rad - camera->attitude->yaw_rad, sun->elevation_rad};
  return conditions;
}

Expected<std::optional<Sun>> FindDaylight(const DaylightSurvey& survey, VideoReader& reader,
                                          const CancelToken& cancel) {
  if (survey.options.sun == "off" || !survey.recognizer.KnowsSuns()) return std::nullopt;
  if (const auto known = SunByClock(survey.cameras)) return *known;
  if (reader.info().live) return std::nullopt;  // a live source cannot be read again for the search

  constexpr std::int64_t kOneIn = 100;
  const std::int64_t frames = reader.info().frame_count.value_or(0);
  const std::int64_t wanted = std::clamp<std::int64_t>(
      frames / kOneIn, survey.options.least_frames, std::max(survey.options.least_frames, survey.options.most_frames));
  constexpr std::int64_t kUnknownStep = 25;  // if the length of the video is unknown
  const std::int64_t step = frames > 0 ? std::max<std::int64_t>(1, frames / wanted) : kUnknownStep;
  constexpr std::size_t kTogether = 2;  // frames processed in parallel, independent of the number of threads
  std::vector<Answer> answers;
  std::vector<Frame> asked;
  int asked_frames = 0;
  bool more = true;
  while (more) {
    if (cancel.IsCancelled())
      return Fail(ErrorCode::kCancelled, "stopped while estimating the sun's direction; run again to resume");
    Expected<std::optional<Frame>> frame = reader.NextFrame();
    more = frame && *frame && asked_frames < std::max(survey.options.least_frames, survey.options.most_frames);
    if (more && (*frame)->index % step == step / 2) {
      asked.push_back(*std::move(*frame));
      ++asked_frames;
    }
    if (asked.size() < kTogether && more) continue;
    std::vector<std::optional<Answer>> told(asked.size());
    oneapi::tbb::parallel_for(std::size_t{0}, asked.size(),
                              [&](std::size_t i) { told[i] = AskFrame(survey, asked[i]); });
    for (const auto& answer : told) {
      if (answer) answers.push_back(*answer);
    }
    asked.clear();
    constexpr int kEnough = 3;
    if (MostAgreement(answers).count >= kEnough) break;
  }
  const Agreement agreement = MostAgreement(answers);
  const bool undisputed = agreement.count >= 2 || answers.size() == 1;
  return undisputed ? std::optional(SunIn(agreement.sum)) : std::nullopt;
}

}  // namespace victorious
