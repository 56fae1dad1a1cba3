#include "victorious/place/calibrate/time_offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/camera.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/place/calibrate/motion_comparison.h"
#include "victorious/place/calibrate/motion_contradiction.h"
#include "victorious/track/camera_motion.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr double kMinPairInterval_s = 0.1;     // between two compared frames: less gives too little motion
constexpr double kMinSigma_s = 0.002;          // exposure time and rounding of time stamps are unknown
constexpr double kMaxSigma_s = 0.1;            // above it the camera's motion changes too little for an offset
constexpr double kMinExplainedVariance = 0.5;  // below it telemetry does not match the video
constexpr int kUnknowns = 5;                   // time offset, s; inverse height above the ground, 1/m; three biases, px
using OffsetUnknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// Mean absolute residual after subtraction of the median biases.
double MeanAbsResidual(const ResidualSet& residual_set) {
  if (residual_set.residuals.size() < kMinPairs) return std::numeric_limits<double>::infinity();
  const Vector3d bias = Medians(residual_set.residuals);
  double sum = 0;
  for (const Vector3d& residual : residual_set.residuals) sum += (residual - bias).lpNorm<1>();
  return sum / static_cast<double>(residual_set.residuals.size());
}

struct GridMinimum {
  OffsetUnknowns unknowns = OffsetUnknowns::Zero();
  double cost = std::numeric_limits<double>::infinity();  // mean absolute residual
};

// Grid search over offset and height. Returns the local minima over the offset, best first.
std::vector<GridMinimum> GridSearch(const MotionComparison& comparison, double max_offset_s) {
  constexpr std::array kHeights_m = {15.0, 30.0, 60.0, 90.0, 130.0, 190.0, 280.0, 420.0, 800.0, 1600.0, 3200.0, 6400.0};
  const double step_s = kMinPairInterval_s / 2;
  const int steps = static_cast<int>(std::ceil(max_offset_s / step_s));
  std::vector<GridMinimum> along;
  for (int k = -steps; k <= steps; ++k) {
    GridMinimum best;
    best.unknowns[0] = k * step_s;
    const MotionComparison::Poses poses = comparison.PosesAt(k * step_s);
    const auto try_height = [&](double per_m) {
      const ResidualSet residual_set = ComputeResiduals(comparison, poses, per_m);
      const double cost = MeanAbsResidual(residual_set);
      if (cost >= best.cost) return;
      best.cost = cost;
      best.unknowns[1] = per_m;
      best.unknowns.tail<3>() = Medians(residual_set.residuals);
    };
    try_height(0);
    for (const double height_m : kHeights_m) try_height(1 / height_m);
    along.push_back(best);
  }
  std::vector<GridMinimum> minima;
  for (std::size_t i = 0; i < along.size(); ++i) {
    if (!std::isfinite(along[i].cost)) continue;
    if (i > 0 && along[i - 1].cost < along[i].cost) continue;
    if (i + 1 < along.size() && along[i + 1].cost < along[i].cost) continue;
    minima.push_back(along[i]);
  }
  std::ranges::sort(minima, {}, &GridMinimum::cost);
  return minima;
}

// A refined local minimum.
struct OffsetFit {
  OffsetUnknowns unknowns = OffsetUnknowns::Zero();
  ResidualSet residual_set;   // biases subtracted
  Vector3d scales_px;         // robust standard deviations of the residuals
  double variance = 0;        // of the offset, s^2, for independent residuals
  double block_variance = 0;  // the same, for residuals correlated within 1 s
};

// Robust standard deviation (MAD) per component.
Vector3d RobustScales(const ResidualSet& residual_set) {
  constexpr double kMinPx = 0.02;
  Vector3d scales;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> sizes;
    for (const Vector3d& residual : residual_set.residuals) sizes.push_back(std::abs(residual[c]));
    scales[c] = std::max(kMinPx, kMadToSigma * Median(std::move(sizes)));
  }
  return scales;
}

constexpr double kHuber = 2;  // in standard deviations

double PairLoss(const Vector3d& residual, const Vector3d& scales_px) {
  double loss = 0;
  for (int c = 0; c < 3; ++c) loss += HuberLoss(residual[c] / scales_px[c], kHuber);
  return loss;
}

// Infinite with too few pairs: an offset that leaves telemetry fits nothing.
double MeanHuberLoss(const ResidualSet& residual_set, const Vector3d& scales_px) {
  if (residual_set.residuals.size() < kMinPairs) return std::numeric_limits<double>::infinity();
  double cost = 0;
  for (const Vector3d& residual : residual_set.residuals) cost += PairLoss(residual, scales_px);
  return cost / static_cast<double>(residual_set.residuals.size());
}

double Variance(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return squares / std::max(1.0, count - 1);
}

// Whether a fit at another offset is worse than the best one by more than noise explains, over the pairs of frames that
// both cover.
//
// The noise of the image is the same at both offsets and nearly cancels in the difference. The noise of telemetry does
// not, as other rows predict a pair there: the losses at all offsets by whole periods of a periodic motion differ by
// sqrt(2 n) standard deviations of one loss. The standard error is therefore that of the differences over blocks of 1
// s, or, where few of them contain the camera's manoeuvres and they differ for that, of independent losses.
bool IsSignificantlyWorse(const MotionComparison& comparison, const OffsetFit& other, const OffsetFit& best,
                          const Vector3d& scales_px) {
  constexpr double kSignificantLoss = 9;  // three standard deviations of the offset, without noise of telemetry
  constexpr double kSignificantSigmas = 4;
  const double correlation_factor = std::max(1.0, best.block_variance / best.variance);
  std::map<double, double> of_second;  // differences of the losses, by the second of the video
  std::vector<double> losses;          // of the best fit
  auto of_best = best.residual_set.pairs.begin();
  for (std::size_t i = 0; i < other.residual_set.pairs.size(); ++i) {
    const std::size_t pair = other.residual_set.pairs[i];
    of_best = std::lower_bound(of_best, best.residual_set.pairs.end(), pair);
    if (of_best == best.residual_set.pairs.end()) break;
    if (*of_best != pair) continue;
    const auto k = static_cast<std::size_t>(of_best - best.residual_set.pairs.begin());
    losses.push_back(PairLoss(best.residual_set.residuals[k], scales_px));
    of_second[std::floor(comparison.time_s(pair))] +=
        PairLoss(other.residual_set.residuals[i], scales_px) - losses.back();
  }
  if (losses.size() < kMinPairs) return false;
  std::vector<double> differences;
  for (const auto& [second, difference] : of_second) differences.push_back(difference);
  const double in_all = std::accumulate(differences.begin(), differences.end(), 0.0);
  const double variance = std::min(static_cast<double>(differences.size()) * Variance(differences),
                                   2 * static_cast<double>(losses.size()) * Variance(losses) * correlation_factor);
  return in_all > std::max(kSignificantLoss * correlation_factor, kSignificantSigmas * std::sqrt(variance));
}

// Derivatives of the predictions by offset and inverse height; those by the biases are 1.
//
// Noise of telemetry is in predictions and derivatives, and interpolation between two rows reduces it, which would bias
// least squares towards the offset of least noise. Derivatives are therefore finite differences over one row interval,
//   (p(offset + row / 2) - p(offset - row / 2)) / row,
// and residuals are against the mean of these two predictions, whose noise is uncorrelated with their difference. The
// measured motion is averaged at the same times.
struct Derivatives {
  ResidualSet at;
  std::vector<Eigen::Matrix<double, 3, 2>> derivatives;  // one per pair of `at`
};

Derivatives ComputeDerivatives(const MotionComparison& comparison, const OffsetUnknowns& unknowns, double row_s) {
  const double per_m = std::max(0.0, unknowns[1]);
  const double step_per_m = std::max(1e-5, 0.02 * per_m);
  const MotionComparison::Poses before = comparison.PosesAt(unknowns[0] - row_s / 2);
  const MotionComparison::Poses after = comparison.PosesAt(unknowns[0] + row_s / 2);
  Derivatives result;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const auto measured = comparison.MeanMeasured(i, row_s);
    if (!before[i] || !after[i] || !measured) continue;
    const auto earlier = comparison.Predict(*before[i], per_m);
    const auto later = comparison.Predict(*after[i], per_m);
    const auto nearer = comparison.Predict(*after[i], per_m + step_per_m);
    if (!earlier || !later || !nearer) continue;
    Eigen::Matrix<double, 3, 2> slope;
    slope.col(0) = (*later - *earlier) / row_s;
    slope.col(1) = (*nearer - *later) / step_per_m;
    result.at.pairs.push_back(i);
    result.at.residuals.push_back(*measured - (*earlier + *later) / 2 - unknowns.tail<3>());
    result.derivatives.push_back(slope);
  }
  return result;
}

// Normal equations J'WJ and J'Wr, and the sum over blocks of 1 s of the outer products of J'Wr (meat of the sandwich).
struct OffsetEquations {
  Normal normal = Normal::Zero();
  OffsetUnknowns gradient = OffsetUnknowns::Zero();
  Normal blocks = Normal::Zero();

  void AddBlock(const OffsetUnknowns& block, int& count) {
    blocks += block * block.transpose();
    ++count;
  }
};

OffsetEquations MakeNormalEquations(const MotionComparison& comparison, const Derivatives& derivatives,
                                    const Vector3d& scales_px) {
  OffsetEquations system;
  int blocks = 0;
  OffsetUnknowns block = OffsetUnknowns::Zero();
  std::optional<double> block_from_s;
  constexpr double kBlock_s = 1;
  for (std::size_t i = 0; i < derivatives.derivatives.size(); ++i) {
    const double time_s = comparison.time_s(derivatives.at.pairs[i]);
    if (block_from_s && time_s - *block_from_s >= kBlock_s) {
      system.AddBlock(block, blocks);
      block.setZero();
      block_from_s.reset();
    }
    if (!block_from_s) block_from_s = time_s;
    for (int c = 0; c < 3; ++c) {
      OffsetUnknowns row = OffsetUnknowns::Zero();
      row.head<2>() = derivatives.derivatives[i].row(c).transpose();
      row[2 + c] = 1;
      row /= scales_px[c];
      const double residual = derivatives.at.residuals[i][c] / scales_px[c];
      const double weight = HuberWeight(residual, kHuber);
      system.normal += weight * row * row.transpose();
      system.gradient += weight * residual * row;
      block += weight * residual * row;
    }
  }
  system.AddBlock(block, blocks);
  // Degrees-of-freedom correction: the unknowns were fitted to the same blocks.
  system.blocks *= static_cast<double>(blocks) / std::max(1, blocks - kUnknowns);
  return system;
}

constexpr double kNotAMinimum = 1e6;

std::optional<OffsetFit> Refine(const MotionComparison& comparison, OffsetUnknowns unknowns, double row_s) {
  constexpr int kRounds = 40;
  constexpr int kLineSearchRounds = 8;  // iterations with step halving
  constexpr double kConvergedStep_s = 1e-5;
  const auto system_at = [&](const Derivatives& derivatives, const Vector3d& scales_px) {
    OffsetEquations system = MakeNormalEquations(comparison, derivatives, scales_px);
    // Damping keeps unobservable unknowns (the height, if the camera only rotates) at their value.
    for (int k = 0; k < kUnknowns; ++k) system.normal(k, k) *= 1 + 1e-9;
    system.normal(1, 1) += 1e-6;
    return system;
  };
  OffsetFit fit;
  for (int round = 0; round < kRounds; ++round) {
    const Derivatives derivatives = ComputeDerivatives(comparison, unknowns, row_s);
    if (derivatives.derivatives.size() < kMinPairs) return std::nullopt;
    fit.scales_px = RobustScales(derivatives.at);
    const OffsetEquations system = system_at(derivatives, fit.scales_px);
    OffsetUnknowns step = system.normal.inverse() * system.gradient;
    if (!step.allFinite()) return std::nullopt;
    if (std::abs(step[0]) > row_s) step *= row_s / std::abs(step[0]);
    const double cost = MeanHuberLoss(derivatives.at, fit.scales_px);
    const auto after = [&](const OffsetUnknowns& change) {
      OffsetUnknowns next = unknowns + change;
      next[1] = std::max(0.0, next[1]);
      return next;
    };
    for (int halved = 0; round < kLineSearchRounds && halved < 4; ++halved) {
      if (MeanHuberLoss(ComputeDerivatives(comparison, after(step), row_s).at, fit.scales_px) <= cost) break;
      step /= 2;
    }
    unknowns = after(step);
    if (round >= kLineSearchRounds && std::abs(step[0]) < kConvergedStep_s) break;
  }
  const Derivatives derivatives = ComputeDerivatives(comparison, unknowns, row_s);
  if (derivatives.derivatives.size() < kMinPairs) return std::nullopt;
  const OffsetEquations system = system_at(derivatives, fit.scales_px);
  const Normal inverse = system.normal.inverse();
  if (!inverse.allFinite() || !(inverse(0, 0) > 0)) return std::nullopt;
  // Noise inflates the derivatives. The numerical derivative of the gradient gives the true curvature; their ratio
  // corrects the variance.
  const auto gradient_at = [&](double apart_s) {
    OffsetUnknowns there = unknowns;
    there[0] += apart_s;
    return system_at(ComputeDerivatives(comparison, there, row_s), fit.scales_px).gradient[0];
  };
  const double curvature = (gradient_at(-row_s / 2) - gradient_at(row_s / 2)) / row_s;
  const double noise_factor = curvature > 0 ? std::max(1.0, system.normal(0, 0) / curvature) : kNotAMinimum;
  fit.variance = inverse(0, 0) * noise_factor * noise_factor;
  fit.block_variance = (inverse * system.blocks * inverse)(0, 0) * noise_factor * noise_factor;
  fit.unknowns = unknowns;
  fit.residual_set = derivatives.at;
  return fit;
}

// Fraction of the motion's variance about its median that telemetry explains, from mean absolute values for robustness.
double ExplainedVariance(const MotionComparison& comparison, const ResidualSet& residual_set, double row_s) {
  std::vector<Vector3d> measured;
  for (const std::size_t i : residual_set.pairs) measured.push_back(comparison.MeanMeasured(i, row_s).value());
  const Vector3d middle = Medians(measured);
  double all = 0;
  double rest = 0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    all += (measured[k] - middle).norm();
    rest += residual_set.residuals[k].norm();
  }
  const double ratio = all > 0 ? rest / all : 1;
  return 1 - ratio * ratio;
}

// Median interval between telemetry rows, s; 0 for one row.
double MedianRowInterval(const CameraTrajectory& cameras) {
  std::vector<double> rows_s;
  for (std::size_t i = 1; i < cameras.states().size(); ++i) {
    rows_s.push_back(cameras.states()[i].time_s - cameras.states()[i - 1].time_s);
  }
  return MedianOr(std::move(rows_s), 0);
}

TimeOffset NoOffset(TimeOffsetStatus why, std::size_t pairs) { return {.status = why, .pairs = pairs}; }

// Beyond the range that was searched a standard error says no more than that.
std::string DescribeUncertainty(const TimeOffset& offset) {
  return offset.sigma_s < offset.max_offset_s
             ? fmt::format("the standard error would be {:.2g} s", offset.sigma_s)
             : fmt::format("the standard error would be more than the searched range of {:g} s", offset.max_offset_s);
}

// A frame on its way through MeasureMotions.
struct CleanFrame {
  Frame frame;
  cv::Mat clean;  // without impulse noise
};

}  // namespace

void TimeOffsetOptions::ListFields(FieldList& fields) {
  fields.Add("max_offset_s", max_offset_s,
             {.min = 0.1, .max = 600, .unit = "s", .reason = "maximum absolute offset searched"});
  fields.Add("max_duration_s", max_duration_s,
             {.min = 2, .max = 1e6, .unit = "s", .reason = "length of the video's beginning that is used"});
}

void TimedTelemetryOptions::ListFields(FieldList& fields) {
  telemetry.ListFields(fields);
  fields.AddGroup("offset", offset);
  fields.Add("features.impulse_fraction", impulse_fraction,
             {.min = 0,
              .max = 1,
              .reason = "impulse noise fraction of the frames whose motion is measured, as in `params index`"});
}

Expected<ImageMotions> MeasureMotions(const std::string& video, const TimeOffsetOptions& options,
                                      double impulse_fraction, const CancelToken& cancel) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video, {}));
  FrameLoop loop(*reader, cancel, {.label = video + ", motion"});
  std::optional<double> selected_s;
  const auto select = [&](Frame frame) -> std::optional<CleanFrame> {
    constexpr double kRoundingAllowance = 0.95;  // of the interval, as time stamps are rounded
    if (frame.time_s > options.max_duration_s) {
      loop.Stop();
      return std::nullopt;
    }
    if (selected_s && frame.time_s - *selected_s < kRoundingAllowance * kMinPairInterval_s) return std::nullopt;
    selected_s = frame.time_s;
    return CleanFrame{.frame = std::move(frame), .clean = {}};
  };
  const auto clean = [&](CleanFrame& one) -> Status {
    one.clean = RemoveImpulses(one.frame.image, impulse_fraction);
    return {};
  };
  ImageMotions seen;
  ImageMotionEstimator camera;
  std::optional<double> last_s;
  const auto measure = [&](const CleanFrame& one) -> Status {
    const auto motion = camera.Step(one.clean);
    if (motion && last_s) {
      seen.motions.push_back({.from_s = *last_s,
                              .to_s = one.frame.time_s,
                              .to_from = *motion,
                              .flow = FitImageFlow(camera.corners(), one.frame.image.size())});
    }
    seen.image = one.frame.image.size();
    last_s = one.frame.time_s;
    return {};
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const FrameLoopEnd end, loop.Run<CleanFrame>(select, {Parallel<CleanFrame>(clean),
                                                                                    InOrder<CleanFrame>(measure)}));
  if (end == FrameLoopEnd::kCancelled) return Fail(ErrorCode::kCancelled, video + ": interrupted");
  return seen;
}

TimeOffset EstimateTimeOffset(const ImageMotions& seen, const CameraTrajectory& cameras,
                              const TimeOffsetOptions& options) {
  const auto is_usable = [](const CameraState& state) { return state.attitude && state.hfov_rad; };
  if (std::ranges::none_of(cameras.states(), is_usable)) {
    return NoOffset(TimeOffsetStatus::kNoAttitude, 0);
  }
  if (seen.motions.size() < kMinPairs) {
    return NoOffset(TimeOffsetStatus::kFewPairs, seen.motions.size());
  }
  const MotionComparison comparison(seen, cameras);
  const double row_s = std::max(MedianRowInterval(cameras), kMinPairInterval_s / 2);
  constexpr std::size_t kMaxMinima = 4;
  std::vector<OffsetFit> fits;
  for (const GridMinimum& candidate : GridSearch(comparison, options.max_offset_s)) {
    if (fits.size() == kMaxMinima) break;
    if (auto fit = Refine(comparison, candidate.unknowns, row_s)) fits.push_back(*std::move(fit));
  }
  if (fits.empty()) return NoOffset(TimeOffsetStatus::kNoOverlap, seen.motions.size());
  const Vector3d scales_px =
      std::ranges::min_element(fits, {}, [](const OffsetFit& fit) { return fit.scales_px.prod(); })->scales_px;
  const auto cost = [&](const OffsetFit& fit) { return MeanHuberLoss(fit.residual_set, scales_px); };
  const OffsetFit& best = *std::ranges::min_element(fits, {}, cost);
  TimeOffset result{.sigma_s = std::hypot(std::sqrt(std::max(best.variance, best.block_variance)), kMinSigma_s),
                    .explained = ExplainedVariance(comparison, best.residual_set, row_s),
                    .pairs = best.residual_set.pairs.size()};
  result.best_s = best.unknowns[0];
  result.max_offset_s = options.max_offset_s;
  if (!(result.sigma_s <= kMaxSigma_s)) {
    result.status = TimeOffsetStatus::kUncertain;
    result.contradicted = FindContradiction(seen, cameras);
    return result;
  }
  if (!(result.explained >= kMinExplainedVariance)) {
    result.status = TimeOffsetStatus::kUnexplained;
    result.contradicted = FindContradiction(seen, cameras);
    return result;
  }
  for (const OffsetFit& other : fits) {
    const double apart_s = std::abs(other.unknowns[0] - result.best_s);
    if (apart_s < std::max(4 * result.sigma_s, kMinPairInterval_s)) continue;
    if (IsSignificantlyWorse(comparison, other, best, scales_px)) continue;
    result.status = TimeOffsetStatus::kPeriodic;
    result.other_s = other.unknowns[0];
    return result;
  }
  if (std::abs(result.best_s) > options.max_offset_s) {
    result.status = TimeOffsetStatus::kOutOfRange;
    return result;
  }
  result.offset_s = result.best_s;
  return result;
}

std::string DescribeStatus(const TimeOffset& offset) {
  switch (offset.status) {
    case TimeOffsetStatus::kOk:
      return "ok";
    case TimeOffsetStatus::kNoAttitude:
      return "telemetry has no attitude or no field of view";
    case TimeOffsetStatus::kFewPairs:
      return fmt::format("the image motion is measurable for {} pairs of frames only", offset.pairs);
    case TimeOffsetStatus::kNoOverlap:
      return "telemetry and video overlap too little in time";
    case TimeOffsetStatus::kUncertain:
      return "the camera's motion changes too little: " + DescribeUncertainty(offset);
    case TimeOffsetStatus::kUnexplained:
      return fmt::format("telemetry explains only {:.0f} % of the image motion's variance at any offset",
                         100 * std::max(0.0, offset.explained));
    case TimeOffsetStatus::kPeriodic:
      return fmt::format("the motion is periodic: {:+.2f} s fits as well as {:+.2f} s", offset.other_s, offset.best_s);
    case TimeOffsetStatus::kOutOfRange:
      return fmt::format("beyond the searched range of {:g} s: raise max_offset_s", offset.max_offset_s);
  }
  return {};
}

std::string Describe(const TimeOffset& offset) {
  if (!offset.offset_s) return "offset of telemetry's clock: unknown: " + DescribeStatus(offset);
  return fmt::format("offset of telemetry's clock: {:+.3f} s, standard error {:.3f} s (time_offset_s adds it)",
                     *offset.offset_s, offset.sigma_s);
}

}  // namespace victorious
