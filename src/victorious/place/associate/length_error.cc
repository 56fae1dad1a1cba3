#include "victorious/place/associate/length_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Core>
#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/types/line_direction.h"

namespace victorious {
namespace {

constexpr double kMaxSigma = 0.05;     // of a tracklet's ratio, relative
constexpr double kAgreement = 0.08;    // of two logarithms of ratios
constexpr double kAgreeingSize = 0.1;  // |log ratio| of an object whose size is right
constexpr double kDrivesWithin_rad = RadiansFromDegrees(30);
constexpr double kStraight_rad = RadiansFromDegrees(20);  // of a flight that counts as straight
constexpr double kClearlyNearer = 3;                      // ratio of two deviations in height

// A tracklet whose lines of sight meet in a point that contradicts its ranges, or agrees with them.
struct Comparison {
  const ObservedTracklet* tracklet = nullptr;
  double log_ratio = 0;
};

Eigen::Vector2d Displacement(const BearingObservation& from, const BearingObservation& to) {
  return TangentPlane(from.line.camera).EnuFromGeodetic(to.line.camera).head<2>();
}

double CourseOf(const Eigen::Vector2d& displacement) { return std::atan2(displacement.x(), displacement.y()); }

// True if a vehicle cannot move as the camera does: it would turn with it, or move across its heading.
bool CannotDrive(const ObservedTracklet& tracklet) {
  const std::vector<BearingObservation>& seen = tracklet.observations;
  const BearingObservation& middle = seen[seen.size() / 2];
  const double before_rad = CourseOf(Displacement(seen.front(), middle));
  const double after_rad = CourseOf(Displacement(middle, seen.back()));
  if (std::abs(WrapAngle(after_rad - before_rad)) > kStraight_rad) return true;
  std::vector<double> headings_rad;
  for (const BearingObservation& one : seen) {
    if (one.heading_rad) headings_rad.push_back(*one.heading_rad);
  }
  if (2 * headings_rad.size() < seen.size()) return false;
  const double across_rad = *EstimateHeadingMode(headings_rad) - CourseOf(Displacement(seen.front(), seen.back()));
  return std::abs(std::sin(across_rad)) > std::sin(kDrivesWithin_rad);
}

// The end of a line of sight whose range is multiplied by `factor`.
GeodeticPoint EndOf(const LineOfSight& line, double factor) {
  return TangentPlane(line.camera).GeodeticFromEnu(factor * *line.range_m * DirectionOf(line));
}

// The height of a tracklet whose ranges are multiplied by `factor`, m; above the ground if that is given.
double HeightBy(const ObservedTracklet& tracklet, double factor, const ObjectOptions& options) {
  std::vector<double> heights_m;
  for (const BearingObservation& one : tracklet.observations) {
    const GeodeticPoint end = EndOf(one.line, factor);
    const double ground_m = options.ground ? options.ground->HeightAt(end).value_or(0) : 0;
    heights_m.push_back(end.altitude_m - ground_m);
  }
  return Median(std::move(heights_m));
}

// The height at which objects stand in this flight, as HeightBy: that of objects whose size is right.
std::optional<double> StandingHeight(std::span<const Comparison> compared, const ObjectOptions& options) {
  if (options.ground) return 0;
  std::vector<double> heights_m;
  for (const Comparison& other : compared) {
    if (std::abs(other.log_ratio) <= kAgreeingSize) heights_m.push_back(HeightBy(*other.tracklet, 1, options));
  }
  if (heights_m.empty()) return std::nullopt;
  return Median(std::move(heights_m));
}

// True if the object stands and is of another size; false if it drives, or if nothing decides.
bool Stands(const Comparison& one, const std::optional<double>& height_m, const ObjectOptions& options) {
  if (!height_m) return CannotDrive(*one.tracklet);
  const double standing_m = std::abs(HeightBy(*one.tracklet, std::exp(one.log_ratio), options) - *height_m);
  const double driving_m = std::abs(HeightBy(*one.tracklet, 1, options) - *height_m);
  if (kClearlyNearer * standing_m < driving_m) return true;
  return standing_m < kClearlyNearer * driving_m && CannotDrive(*one.tracklet);
}

// @param height_m  at which objects stand, if it is known
std::optional<LengthError> ErrorOf(const std::vector<Comparison>& of_model, const std::optional<double>& height_m,
                                   const ObjectOptions& options) {
  std::vector<double> log_ratios;
  for (const Comparison& one : of_model) log_ratios.push_back(one.log_ratio);
  const double log_factor = Median(std::move(log_ratios));
  if (std::abs(log_factor) < std::log(kMinLengthFactor) || std::abs(log_factor) > std::log(kMaxLengthFactor))
    return std::nullopt;
  const auto differs = [&](const Comparison& one) { return std::abs(one.log_ratio - log_factor) > kAgreement; };
  if (std::ranges::any_of(of_model, differs)) return std::nullopt;
  if (std::ranges::none_of(of_model, [&](const Comparison& one) { return Stands(one, height_m, options); }))
    return std::nullopt;
  return LengthError{of_model.front().tracklet->record.model, std::exp(log_factor), static_cast<int>(of_model.size())};
}

}  // namespace

std::vector<LengthError> FindLengthErrors(std::span<const ObservedTracklet> tracklets,
                                          std::span<const RangeComparison> comparisons, const ObjectOptions& options) {
  std::vector<Comparison> compared;
  std::map<std::int64_t, std::vector<Comparison>> of_models;
  for (std::size_t i = 0; i < tracklets.size(); ++i) {
    if (!tracklets[i].is_cad_model || !comparisons[i] || !*comparisons[i]) continue;
    const SizeRatio& ratio = **comparisons[i];
    if (!ratio.stands || ratio.sigma > kMaxSigma) continue;
    compared.push_back({&tracklets[i], std::log(ratio.ratio)});
    of_models[tracklets[i].record.model].push_back(compared.back());
  }
  const std::optional<double> height_m = StandingHeight(compared, options);
  std::vector<LengthError> errors;
  for (const auto& [model, of_model] : of_models) {
    if (const auto error = ErrorOf(of_model, height_m, options)) errors.push_back(*error);
  }
  return errors;
}

double LengthFactorOf(std::span<const LengthError> errors, std::int64_t model) {
  const auto found = std::ranges::find(errors, model, &LengthError::model);
  return found == errors.end() ? 1 : found->factor;
}

std::string DescribeLengthFactor(double factor) {
  return fmt::format("stands still only if the model is {:.1f} times too {}", std::max(factor, 1 / factor),
                     factor < 1 ? "long" : "short");
}

void CorrectLengths(std::span<const LengthError> errors, std::span<ObservedTracklet> tracklets) {
  for (ObservedTracklet& tracklet : tracklets) ScaleRanges(LengthFactorOf(errors, tracklet.record.model), tracklet);
}

}  // namespace victorious
