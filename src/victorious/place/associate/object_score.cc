#include "victorious/place/associate/object_score.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/associate/length_error.h"
#include "victorious/place/associate/object_rejection.h"

namespace victorious {
namespace {

// The weights w0 and w_k (object_score.h).
constexpr double kBias = -1.39;
constexpr double kStrengthWeight = 0.70;  // per unit of the natural logarithm, up to kMaxStrength
constexpr double kSizeWeight = -20;       // per unit of |log ratio| beyond kUsualSize
constexpr double kMissingWeight = -2;     // of the fraction of lines
constexpr double kHeadingWeight = -5;     // of the fraction of headings
constexpr double kPlaceWeight = 1;        // of what the flight says of a rejected place, a natural logarithm
constexpr double kJumpWeight = -5;        // of the fraction of steps

// Beyond it nothing becomes likelier.
constexpr double kMaxStrength = 20;

// Sizes this near to the model's do not count against it: three times the usual error of ranges.
constexpr double kUsualSize = 0.05;
// Another model's size; larger ratios say no more. Their place is rejected.
constexpr double kMaxSize = 0.5;

// Fewer say nothing about a fraction.
constexpr std::int64_t kMinCounted = 3;

// Limits of SpeaksAgainst() that are no part of the score.
constexpr double kWeakLogOdds = 5;  // a typical frame of 0.993
constexpr double kOneSide_rad = RadiansFromDegrees(6);

double Fraction(std::int64_t part, std::int64_t whole) {
  return whole < kMinCounted ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

double SizeError(const ObjectEvidence& evidence) {
  return std::min(std::abs(std::log(evidence.size_ratio.value_or(1))), kMaxSize);
}

}  // namespace

ObjectEvidence CollectEvidence(const ObjectHypothesis& hypothesis, const ObjectRecord& object, double tests,
                               const ObjectOptions& options) {
  ObjectEvidence evidence{.strength = StrengthOf(hypothesis, object.place.has_value(), tests, options)};
  Eigen::Vector3d view_sum = Eigen::Vector3d::Zero();
  std::int64_t views = 0;
  double log_odds = 0;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    const TrackletSummary& summary = tracklet->summary;
    log_odds += summary.log_odds;
    evidence.recognitions += summary.recognitions;
    evidence.frames += tracklet->record.frames;
    evidence.by_shape += summary.by_shape;
    evidence.missed += summary.missed;
    evidence.lines += summary.observations;
    evidence.view_steps += summary.view_steps;
    evidence.view_jumps += summary.view_jumps;
    view_sum += summary.view_sum;
    if (tracklet->length_factor != 1) evidence.length_factor = tracklet->length_factor;
    views += summary.views;
  }
  if (evidence.recognitions > 0) evidence.typical_log_odds = log_odds / static_cast<double>(evidence.recognitions);
  if (views > 1) {
    const double length = std::clamp(view_sum.norm() / static_cast<double>(views), 1e-9, 1.0);
    evidence.view_spread_rad = std::sqrt(-2 * std::log(length));
  }
  const ObjectPlace& estimate = hypothesis.estimate;
  evidence.place_rejected = object.place_rejected;
  if (!object.place || !estimate.place) {
    evidence.lines = 0;
    return evidence;
  }
  const double missing = (1 - estimate.inlier_fraction) * static_cast<double>(evidence.lines);
  evidence.missing_lines = std::clamp<std::int64_t>(std::llround(missing), 0, evidence.lines);
  evidence.headings = estimate.headings;
  evidence.contradicting_headings = estimate.contradicting_headings;
  if (!estimate.HasPath()) evidence.size_ratio = estimate.size_ratio;
  return evidence;
}

double ScoreObject(const ObjectEvidence& evidence) {
  const double logit = kBias + kStrengthWeight * std::min(evidence.strength, kMaxStrength) +
                       kSizeWeight * std::max(0.0, SizeError(evidence) - kUsualSize) +
                       kMissingWeight * Fraction(evidence.missing_lines, evidence.lines) +
                       kHeadingWeight * Fraction(evidence.contradicting_headings, evidence.headings) +
                       kPlaceWeight * std::min(evidence.place_weight, 0.0) +
                       kJumpWeight * Fraction(evidence.view_jumps, evidence.view_steps);
  return 1 / (1 + std::exp(-logit));
}

std::vector<std::string> SpeaksAgainst(const ObjectEvidence& evidence) {
  std::vector<std::string> against;
  if (evidence.recognitions < kMinCounted)
    against.push_back(fmt::format("recognised in {} only", CountText(evidence.recognitions, "frame")));
  if (evidence.recognitions > 0 && evidence.typical_log_odds < kWeakLogOdds) {
    against.push_back(
        fmt::format("weak: a typical frame scores {:.2f}", 1 / (1 + std::exp(-evidence.typical_log_odds))));
  }
  if (evidence.missed > 0) {
    against.push_back(fmt::format("its shape was missed in {} of {}", evidence.missed,
                                  CountText(evidence.by_shape + evidence.missed, "frame")));
  }
  if (!evidence.place_rejected.empty()) {
    against.push_back(evidence.place_rejected);
  } else if (SizeError(evidence) > kUsualSize) {
    against.push_back(fmt::format("size {:.0f} % off", 100 * std::abs(*evidence.size_ratio - 1)));
  }
  if (evidence.length_factor != 1) against.push_back(DescribeLengthFactor(evidence.length_factor));
  if (evidence.missing_lines > 0)
    against.push_back(fmt::format("{} of {} lines of sight {} its place", evidence.missing_lines, evidence.lines,
                                  evidence.missing_lines == 1 ? "misses" : "miss"));
  if (evidence.contradicting_headings > 0) {
    against.push_back(fmt::format("heading contradicts in {} of {}", evidence.contradicting_headings,
                                  CountText(evidence.headings, "frame")));
  }
  if (evidence.view_jumps > 0) {
    against.push_back(
        fmt::format("view jumps in {} of {}", evidence.view_jumps, CountText(evidence.view_steps, "step")));
  }
  if (evidence.view_spread_rad && *evidence.view_spread_rad < kOneSide_rad && evidence.recognitions >= kMinCounted)
    against.push_back("seen from one side only");
  return against;
}

std::string ToJsonText(const ObjectEvidence& evidence) {
  return DumpJson(nlohmann::ordered_json{
      {"strength", evidence.strength},
      {"typical_log_odds", evidence.typical_log_odds},
      {"recognitions", evidence.recognitions},
      {"frames", evidence.frames},
      {"by_shape", evidence.by_shape},
      {"missed", evidence.missed},
      {"size_ratio", OrNull(evidence.size_ratio)},
      {"lines", evidence.lines},
      {"missing_lines", evidence.missing_lines},
      {"place_rejected", !evidence.place_rejected.empty()},
      {"place_weight", evidence.place_weight},
      {"length_factor", evidence.length_factor},
      {"headings", evidence.headings},
      {"contradicting_headings", evidence.contradicting_headings},
      {"view_steps", evidence.view_steps},
      {"view_jumps", evidence.view_jumps},
      {"view_spread_deg", OrNull(evidence.view_spread_rad ? std::optional(DegreesFromRadians(*evidence.view_spread_rad))
                                                          : std::nullopt)}});
}

}  // namespace victorious
