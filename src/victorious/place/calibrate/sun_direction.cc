#include "victorious/place/calibrate/sun_direction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/enum_text.h"
#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/video/frame_loop.h"

namespace victorious {

namespace {

constexpr std::array<EnumText<SunSearch>, 2> kSunSearchTexts = {{{SunSearch::kAuto, "auto"}, {SunSearch::kOff, "off"}}};

// Number of sampled frames: one in kFramesPerSample, within these bounds. Most videos agree on a direction after three
// to nine frames; 200 frames cost about a minute.
constexpr std::int64_t kFramesPerSample = 100;
constexpr std::int64_t kMinSamples = 24;
constexpr std::int64_t kMaxSamples = 200;
constexpr std::int64_t kUnknownLengthStep = 25;  // frames between samples if the length of the video is unknown
// Samples that are farther apart are sought, else all frames in between are decoded: of common encoders' key frames, at
// most 250 frames apart, none may be nearer to the next sample than the reader is.
constexpr std::int64_t kMinSkippedFrames = 250;

// Frames estimated in parallel, and between two tests for a consensus; independent of the number of threads, so that
// the result is.
constexpr std::size_t kBatchSize = 2;
// The sampling ends when this many estimates agree, with this much evidence, which is this many times that of all
// others together. Neighbouring samples may show the same object and err alike, by chance poses of a few decades.
constexpr int kMinConsensus = 3;
constexpr double kMinEvidence_decades = 30;
constexpr double kMinEvidenceRatio = 2;

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

// The first state with a clock; null if there is none.
const CameraState* FindTimedState(const CameraTrajectory& cameras) {
  const auto timed =
      std::ranges::find_if(cameras.states(), [](const CameraState& state) { return state.utc_us.has_value(); });
  return timed == cameras.states().end() ? nullptr : &*timed;
}

// By the ephemeris. std::nullopt if the sun is too low to cast hard light. @param state  with a clock
std::optional<Sun> SunFromEphemeris(const CameraState& state) {
  constexpr double kMinElevation_rad = 0.1;
  const Sun sun = SunAt(*state.utc_us, state.place);
  return sun.elevation_rad > kMinElevation_rad ? std::optional(sun) : std::nullopt;
}

// Sun direction estimated from one frame.
struct SunDirectionEstimate {
  Eigen::Vector3d direction;  // unit vector
  double gain_decades;        // its evidence
};

// The set of most evidence of estimates that agree with one of them.
struct SunConsensus {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // directions weighted by their evidence
  int count = 0;
  double evidence_decades = 0;
  double rest_decades = 0;  // of the other estimates
};

SunConsensus FindSunConsensus(const std::vector<SunDirectionEstimate>& estimates) {
  SunConsensus best;
  for (const SunDirectionEstimate& one : estimates) {
    SunConsensus agreement;
    for (const SunDirectionEstimate& other : estimates) {
      if (one.direction.dot(other.direction) < std::cos(kConsensusGate_rad)) {
        agreement.rest_decades += other.gain_decades;
        continue;
      }
      agreement.sum += other.gain_decades * other.direction;
      agreement.evidence_decades += other.gain_decades;
      ++agreement.count;
    }
    if (agreement.evidence_decades > best.evidence_decades) best = agreement;
  }
  return best;
}

// A sampled frame on its way through the stages.
struct SampledFrame {
  Frame frame;
  Expected<std::optional<SunDirectionEstimate>> estimate;
};

Expected<std::optional<SunDirectionEstimate>> EstimateSunFromFrame(const SunDirectionInput& input, const Frame& frame) {
  const StageScope scope(Stage::kSun);
  const std::optional<CameraState> camera = input.cameras.At(frame.time_s);
  if (!camera || !camera->attitude || !camera->hfov_rad) return std::nullopt;
  const cv::Mat image = input.searched_image ? input.searched_image(frame) : frame.image;
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, input.extractor.Extract(image));
  const FrameConditions conditions = MakeFrameConditions(camera, image.size(), {});
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<SunEstimate> found,
                              input.recognizer.EstimateSun(features, *conditions.vertical));
  if (!found) return std::nullopt;
  found->relative_sun.azimuth_rad += camera->attitude->yaw_rad;
  return SunDirectionEstimate{DirectionFromSun(found->relative_sun), found->gain_decades};
}

// Selects the frames to sample: the middle one of each of the equal parts of the video.
class SampleSelector {
 public:
  explicit SampleSelector(const VideoInfo& info) : frame_rate_(info.frame_rate) {
    const std::int64_t frames = info.frame_count.value_or(0);
    const std::int64_t wanted = std::clamp(frames / kFramesPerSample, kMinSamples, kMaxSamples);
    step_ = frames > 0 ? std::max<std::int64_t>(1, frames / wanted) : kUnknownLengthStep;
    next_ = step_ / 2;
  }

  bool IsSelected(const Frame& frame) {
    at_ = has_sought_ ? std::llround(frame.time_s * frame_rate_) : frame.index;
    if (IsDone() || at_ < next_) return false;
    while (next_ <= at_) next_ += step_;
    ++sampled_;
    return true;
  }

  [[nodiscard]] bool IsDone() const { return sampled_ >= kMaxSamples; }

  // Seeks to the next sample if it is far.
  void SkipToNext(VideoReader& reader) {
    if (next_ - at_ < kMinSkippedFrames || !(frame_rate_ > 0) || IsDone()) return;
    has_sought_ |= reader.SeekTo(static_cast<double>(next_) / frame_rate_);
  }

 private:
  double frame_rate_;
  std::int64_t step_ = 1;
  std::int64_t at_ = 0;    // number of the last frame seen
  std::int64_t next_ = 0;  // number of the next frame to sample, counted as if the frame rate were constant
  std::int64_t sampled_ = 0;
  bool has_sought_ = false;  // the index of a frame is not its number any more
};

// Collects the estimates in frame order until enough agree.
class SunCollector {
 public:
  void Add(const Expected<std::optional<SunDirectionEstimate>>& estimate) {
    if (is_determined_) return;
    ++frames_;
    if (!estimate) {
      if (failures_++ == 0) first_error_ = estimate.error();
    } else if (*estimate) {
      estimates_.push_back(**estimate);
    }
    if (frames_ % kBatchSize != 0) return;
    const SunConsensus agreement = FindSunConsensus(estimates_);
    is_determined_ = agreement.count >= kMinConsensus && agreement.evidence_decades >= kMinEvidence_decades &&
                     agreement.evidence_decades >= kMinEvidenceRatio * agreement.rest_decades;
  }

  [[nodiscard]] bool is_determined() const { return is_determined_; }

  [[nodiscard]] std::optional<Sun> Result(bool only_if_certain) const {
    if (only_if_certain && !is_determined_) return std::nullopt;
    const SunConsensus agreement = FindSunConsensus(estimates_);
    const bool is_accepted = agreement.count >= 2 || estimates_.size() == 1;
    return is_accepted ? std::optional(SunFromDirection(agreement.sum)) : std::nullopt;
  }

  void WarnOfFailures(const WarningSink& warn) const {
    if (failures_ == 0) return;
    warn(fmt::format("the sun's direction: {} of {} sampled frames are skipped: {}", failures_, frames_,
                     first_error_.message));
  }

 private:
  std::vector<SunDirectionEstimate> estimates_;
  std::size_t frames_ = 0;
  std::size_t failures_ = 0;
  Error first_error_;
  bool is_determined_ = false;
};

}  // namespace

FrameConditions MakeFrameConditions(const std::optional<CameraState>& camera, const cv::Size& size_px,
                                    const std::optional<Sun>& sun) {
  if (!camera || !camera->attitude || !camera->hfov_rad) return {};
  FrameConditions conditions;
  conditions.vertical = MakeVertical(*camera->attitude, *camera->hfov_rad, size_px.width, size_px.height);
  if (sun) conditions.relative_sun = Sun{sun->azimuth_rad - camera->attitude->yaw_rad, sun->elevation_rad};
  return conditions;
}

std::optional<Sun> SunByClock(const CameraTrajectory& cameras) {
  const CameraState* timed = FindTimedState(cameras);
  return timed == nullptr ? std::nullopt : SunFromEphemeris(*timed);
}

void SunDirectionOptions::ListFields(FieldList& fields) {
  fields.Add("sun", sun, kSunSearchTexts,
             {.reason = "auto: also searches for CAD models with templates relit for the sun's direction, if telemetry "
                        "has the camera's attitude; off: templates for diffuse light only"});
}

Expected<std::optional<Sun>> EstimateSunDirection(const SunDirectionInput& input, VideoReader& reader,
                                                  const CancelToken& cancel, const WarningSink& warn) {
  if (input.options.sun == SunSearch::kOff || !input.recognizer.HasRelitTemplates()) return std::nullopt;
  if (const CameraState* timed = FindTimedState(input.cameras)) return SunFromEphemeris(*timed);
  if (reader.info().live) return std::nullopt;  // a live source cannot be read again for the search

  SampleSelector selector(reader.info());
  SunCollector collector;
  FrameLoop loop(reader, cancel, {.threads = input.threads, .max_in_flight = kBatchSize});
  selector.SkipToNext(reader);
  const auto select = [&](Frame frame) -> std::optional<SampledFrame> {
    if (selector.IsDone()) loop.Stop();
    if (!selector.IsSelected(frame)) return std::nullopt;
    selector.SkipToNext(reader);
    return SampledFrame{.frame = std::move(frame), .estimate = std::nullopt};
  };
  const auto estimate = [&](SampledFrame& sample) -> Status {
    sample.estimate = EstimateSunFromFrame(input, sample.frame);
    return {};
  };
  const auto collect = [&](const SampledFrame& sample) -> Status {
    collector.Add(sample.estimate);
    if (collector.is_determined()) loop.Stop();
    return {};
  };
  const Expected<FrameLoopEnd> end =
      loop.Run<SampledFrame>(select, {Parallel<SampledFrame>(estimate), InOrder<SampledFrame>(collect)});
  collector.WarnOfFailures(warn);
  if (!end) {
    // The search of the same video fails there too, after it has stored what is before.
    warn("the sun's direction is estimated from the frames before an error: " + end.error().message);
  } else if (*end == FrameLoopEnd::kCancelled) {
    return Fail(ErrorCode::kCancelled, "stopped while estimating the sun's direction; run again to resume");
  }
  return collector.Result(input.only_if_certain);
}

}  // namespace victorious
