#include "victorious/place/associate/object_place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Cholesky>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/geolocate/error_ellipse.h"
#include "victorious/place/geolocate/flight_shift.h"
#include "victorious/types/line_direction.h"

namespace victorious {
namespace {

// The upper limits of standard deviations that LocateOptions allows.
constexpr double kMaxSigma_m = 1e5;
constexpr double kMaxSigma_deg = 90;

// Own variance of an observation that is tracked from a recognition, as a fraction of the recognition's: at least this,
// so that those with almost none do not dominate.
constexpr double kMinOwnFraction = 0.1;

// Standard deviations from telemetry replace those of the parameters, clamped to their allowed range.
LocateOptions MakeLocateOptions(std::span<const BearingObservation> observations, const ObjectOptions& options,
                                double common_fraction) {
  LocateOptions locate = options.LocateOnGround();
  std::vector<double> positions_m;
  std::vector<double> attitudes_rad;
  for (const BearingObservation& observation : observations) {
    positions_m.push_back(observation.sigma_position_m.value_or(locate.common.position_m));
    attitudes_rad.push_back(observation.sigma_attitude_rad.value_or(RadiansFromDegrees(locate.common.heading_deg)));
  }
  // Of most, as some rows may be older than others: the median.
  if (std::ranges::any_of(observations, [](const auto& one) { return one.sigma_position_m.has_value(); })) {
    locate.line.position_m = locate.common.position_m = locate.common.height_m =
        std::min(kMaxSigma_m, Median(positions_m));
  }
  if (std::ranges::any_of(observations, [](const auto& one) { return one.sigma_attitude_rad.has_value(); })) {
    const double attitude_deg = std::min(kMaxSigma_deg, DegreesFromRadians(Median(attitudes_rad)));
    locate.common.heading_deg = locate.common.boresight_rise_deg = attitude_deg;
    locate.common.boresight_side_deg = 0;
  }
  if (const auto& sigmas = observations.front().flight_sigmas) {
    constexpr double kMinPosition_m = 0.01;
    locate.line.position_m = std::clamp(sigmas->row_position_m, kMinPosition_m, kMaxSigma_m);
    for (double* sigma : {&locate.common.position_m, &locate.common.height_m}) {
      *sigma = std::min(kMaxSigma_m, *sigma * sigmas->common_position);
    }
    for (double* sigma :
         {&locate.common.heading_deg, &locate.common.boresight_side_deg, &locate.common.boresight_rise_deg}) {
      *sigma = std::min(kMaxSigma_deg, *sigma * sigmas->common_attitude);
    }
  }
  CommonErrorOptions& common = locate.common;
  for (double* sigma : {&common.position_m, &common.height_m, &common.heading_deg, &common.boresight_side_deg,
                        &common.boresight_rise_deg}) {
    *sigma *= common_fraction;
  }
  return locate;
}

// Headings of one object agree within this angle.
constexpr double kHeadingGate_rad = RadiansFromDegrees(20);

double Square(double value) { return value * value; }

// Decorrelates observations that rest on one recognition. Observation i has the variance own_i + shared: tracked
// observations inherit the error of the recognition. The solver assumes independence. The weighted mean of independent
// observations has the same variance as that of the correlated ones if each gets the variance
//   own (1 + shared sum(1 / own)).
// @param variances  total variance of each; the recognition is the first
// @param more       additional independent variance of each; neither in `variances` nor in the result
std::vector<double> Decorrelate(std::vector<double> variances, const std::vector<double>& more) {
  const double shared = variances.front();
  double total = 0;
  for (std::size_t i = 0; i < variances.size(); ++i) {
    variances[i] = std::max({variances[i] - shared, 0.0}) + std::max(more[i], kMinOwnFraction * shared);
    total += 1 / variances[i];
  }
  for (std::size_t i = 0; i < variances.size(); ++i) variances[i] = variances[i] * (1 + shared * total) - more[i];
  return variances;
}

// The error of the attitude of an observation's row.
double RowAttitude(const BearingObservation& observation) {
  if (observation.flight_sigmas) return observation.flight_sigmas->row_attitude_rad;
  return observation.sigma_attitude_rad.value_or(0);
}

// Sets the angular standard deviations. The attitude noise from telemetry and the position noise are independent from
// frame to frame.
// @param followed  indices of observations that rest on one recognition, in order of time
void SetAngles(std::span<const BearingObservation> observations, const std::vector<std::size_t>& followed,
               const LineErrorOptions& errors, std::vector<LineOfSight>& lines) {
  std::vector<double> total;
  std::vector<double> more;
  for (const std::size_t i : followed) {
    const LineOfSight& line = lines[i];
    total.push_back(Square(line.sigma_rad.value_or(RadiansFromDegrees(errors.angle_deg))));
    more.push_back(Square(RowAttitude(observations[i])) +
                   (line.range_m ? Square(errors.position_m / *line.range_m) : 0));
  }
  const std::vector<double> decorrelated = Decorrelate(std::move(total), more);
  for (std::size_t k = 0; k < followed.size(); ++k) {
    lines[followed[k]].sigma_rad = std::sqrt(decorrelated[k] + Square(RowAttitude(observations[followed[k]])));
  }
}

void SetRanges(std::vector<std::size_t> followed, const LineErrorOptions& errors, std::vector<LineOfSight>& lines) {
  std::erase_if(followed, [&](std::size_t i) { return !lines[i].range_m; });
  if (followed.empty()) return;
  std::vector<double> total;
  for (const std::size_t i : followed) {
    total.push_back(Square(lines[i].sigma_range_m.value_or(errors.range_fraction * *lines[i].range_m)));
  }
  const std::vector<double> decorrelated =
      Decorrelate(std::move(total), std::vector(followed.size(), Square(errors.position_m)));
  for (std::size_t k = 0; k < followed.size(); ++k) lines[followed[k]].sigma_range_m = std::sqrt(decorrelated[k]);
}

void SetErrors(std::span<const BearingObservation> observations, const std::vector<std::size_t>& followed,
               const LineErrorOptions& errors, std::vector<LineOfSight>& lines) {
  SetAngles(observations, followed, errors, lines);
  SetRanges(followed, errors, lines);
}

std::vector<LineOfSight> MakeLines(std::span<const BearingObservation> observations, const LineErrorOptions& errors) {
  std::vector<LineOfSight> lines;
  std::map<std::int64_t, std::vector<std::size_t>> of_recognition;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    lines.push_back(observations[i].line);
    if (observations[i].recognition_id == 0) {
      SetErrors(observations, {i}, errors, lines);
    } else {
      of_recognition[observations[i].recognition_id].push_back(i);
    }
  }
  for (const auto& [recognition, followed] : of_recognition) SetErrors(observations, followed, errors, lines);
  return lines;
}

// Geolocation of a moving object from its last observations only, if they determine it.
Geolocation EstimateLastPlace(std::span<const LineOfSight> lines, const Geolocation& by_all, LocateOptions locate,
                              const ObjectOptions& options) {
  std::vector<LineOfSight> last(lines.begin(), lines.end());
  std::erase_if(last, [&](const LineOfSight& line) { return line.time_s < by_all.time_s - options.motion_window_s; });
  if (last.size() == lines.size()) return by_all;
  locate.motion = MotionModel::kVelocity;
  return LocateChecked(last, locate).place.value_or(by_all);
}

// Triangulates without ranges and ground, and compares the distances with the ranges by apparent size.
std::optional<SizeRatio> CompareWithRanges(std::vector<LineOfSight> lines, LocateOptions locate,
                                           double min_inlier_fraction) {
  locate.ground.reset();
  std::vector<double> ranges_m;
  for (LineOfSight& line : lines) {
    if (!line.range_m) return std::nullopt;
    ranges_m.push_back(*line.range_m);
    line.range_m.reset();
  }
  const GeoFix unranged = LocateChecked(lines, locate);
  if (!unranged.place) return std::nullopt;
  const Geolocation& place = *unranged.place;
  std::vector<double> factors;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!unranged.inliers[i]) continue;
    const TangentPlane plane(lines[i].camera);
    Eigen::Vector3d there = plane.EnuFromGeodetic(place.point);
    if (place.velocity_enu) there += (lines[i].time_s - place.time_s) * *place.velocity_enu;
    factors.push_back(there.norm() / ranges_m[i]);
  }
  const double inlier_fraction = static_cast<double>(factors.size()) / static_cast<double>(lines.size());
  if (factors.empty() || inlier_fraction < min_inlier_fraction) return std::nullopt;
  const TangentPlane plane(place.point);
  const Eigen::Vector3d to_camera = plane.EnuFromGeodetic(lines.back().camera);
  const Eigen::Vector3d along = to_camera.normalized();
  return SizeRatio{.ratio = Median(std::move(factors)),
                   .sigma = std::sqrt(along.dot(place.covariance_enu_m2 * along)) / to_camera.norm(),
                   .stands = !place.IsMoving()};
}

// Number of inliers whose headings agree: with the common heading for a static object and for one on a path, whose
// headings are turned to its end; else with the previous heading. Subtracts the observations that a moving model fits
// in any case: two with ranges, three without. Sets those fields of `result`, of which the others are known.
void CountConsistent(std::span<const BearingObservation> observations,
                     const std::vector<std::optional<double>>& headings_rad, const GeoFix& fix, ObjectPlace& result) {
  result.consistent_fraction = 0;
  if (!fix.place) return;
  std::optional<double> heading_rad = result.heading_rad;
  bool ranged = false;
  int consistent = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!fix.inliers[i]) continue;
    ranged = ranged || observations[i].line.range_m;
    const std::optional<double>& own_rad = headings_rad[i];
    const bool agrees = !own_rad || std::abs(WrapAngle(*own_rad - *heading_rad)) <= kHeadingGate_rad;
    if (agrees) ++consistent;
    if (own_rad) ++result.headings;
    if (!agrees) ++result.contradicting_headings;
    if (own_rad && fix.place->IsMoving() && !result.HasPath()) heading_rad = own_rad;
  }
  const int needed = fix.place->IsMoving() ? (ranged ? 1 : 2) : 0;
  result.consistent_fraction = std::max(1, consistent - needed) / static_cast<double>(observations.size());
}

// The motion of an object whose ranges place each observation; std::nullopt for any other, and for one that is static
// by definition.
std::optional<MotionPath> EstimateMotion(std::span<const BearingObservation> observations,
                                         std::span<const LineOfSight> lines, const LocateOptions& locate) {
  if (locate.motion == MotionModel::kStatic) return std::nullopt;
  std::vector<double> fractions;
  for (const BearingObservation& observation : observations) {
    const LineOfSight& line = observation.line;
    if (!line.range_m) return std::nullopt;
    fractions.push_back(line.sigma_range_m.value_or(locate.line.range_fraction * *line.range_m) / *line.range_m);
  }
  if (Median(std::move(fractions)) > kMaxPathRangeFraction) return std::nullopt;
  return EstimatePath(lines, locate);
}

// The fix, corrected by the decision on motion that uses the ranges.
GeoFix ApplyMotion(const MotionPath& motion, std::span<const LineOfSight> lines, LocateOptions locate, GeoFix fix) {
  if (motion.is_moving) {
    const bool plausible = motion.acceleration_m_s2 <= kMaxAcceleration_m_s2;
    fix.place = plausible ? std::optional(motion.places.back()) : std::nullopt;
    fix.inliers = plausible ? motion.inliers : std::vector<bool>(lines.size(), false);
    return fix;
  }
  if (!fix.place || !fix.place->IsMoving()) return fix;
  const std::optional<Eigen::Matrix3d> velocity_covariance = fix.place->velocity_covariance_enu;
  locate.motion = MotionModel::kStatic;
  fix = LocateChecked(lines, locate);
  fix.inliers = motion.inliers;
  if (fix.place) {
    fix.place->velocity_enu = Eigen::Vector3d::Zero();
    fix.place->velocity_covariance_enu = velocity_covariance;
  }
  return fix;
}

// The course of an object along its path; at rest its last one, and before it starts the first.
std::vector<double> CoursesAlong(std::span<const Geolocation> path) {
  constexpr double kMinSpeed_m_s = 1;  // below it the course is uncertain
  std::vector<double> courses;
  std::optional<double> course;
  for (const Geolocation& place : path) {
    const Eigen::Vector3d velocity = place.velocity_enu.value_or(Eigen::Vector3d::Zero());
    if (velocity.head<2>().norm() >= kMinSpeed_m_s) {
      const bool first = !course;
      course = std::atan2(velocity.x(), velocity.y());
      if (first) std::ranges::fill(courses, *course);
    }
    courses.push_back(course.value_or(0));
  }
  return courses;
}

// The observed headings; those of an object on a path are turned by its change of course until the end.
std::vector<std::optional<double>> HeadingsAtEnd(std::span<const BearingObservation> observations,
                                                 std::span<const Geolocation> path) {
  const std::vector<double> courses = CoursesAlong(path);
  std::vector<std::optional<double>> headings_rad;
  std::size_t at = 0;
  for (const BearingObservation& observation : observations) {
    headings_rad.push_back(observation.heading_rad);
    while (at + 1 < path.size() && path[at].time_s < observation.line.time_s) ++at;
    if (headings_rad.back() && !path.empty()) *headings_rad.back() += courses.back() - courses[at];
  }
  return headings_rad;
}

}  // namespace

Geolocation PredictPlace(const Geolocation& place, double time_s) {
  Geolocation then = place;
  then.time_s = time_s;
  if (!place.IsMoving()) return then;
  const double after_s = time_s - place.time_s;
  then.point = TangentPlane(place.point).GeodeticFromEnu(after_s * *place.velocity_enu);
  if (place.velocity_covariance_enu) then.covariance_enu_m2 += after_s * after_s * *place.velocity_covariance_enu;
  return then;
}

Geolocation PropagatePlace(const Geolocation& place, double time_s) {
  Geolocation then = PredictPlace(place, time_s);
  if (!place.IsMoving()) return then;
  SetErrorRadii(then);
  return then;
}

Geolocation PlaceAt(const ObjectPlace& estimate, double time_s) {
  const std::vector<Geolocation>& path = estimate.path;
  if (path.empty()) return PredictPlace(*estimate.place, time_s);
  const auto distance_s = [&](const Geolocation& place) { return std::abs(place.time_s - time_s); };
  const Geolocation& nearest = *std::ranges::min_element(path, {}, distance_s);
  Geolocation then = PredictPlace(nearest, time_s);
  constexpr double kManoeuvre_m_s2 = 1.5;  // standard deviation of an acceleration that lasts until then
  then.covariance_enu_m2.diagonal().head<2>().array() += Square(kManoeuvre_m_s2 * Square(distance_s(nearest)) / 2);
  return then;
}

double MahalanobisDistance(const BearingObservation& observation, const Geolocation& place, double slack_m,
                           const LocateOptions& errors, double common_fraction) {
  const LineOfSight& line = observation.line;
  const Eigen::Vector3d to = TangentPlane(line.camera).EnuFromGeodetic(place.point);
  const Eigen::Vector3d along = DirectionOf(line);
  if (to.dot(along) <= 0) return std::numeric_limits<double>::infinity();
  const CommonErrorOptions& common = errors.common;
  const double own_rad = line.sigma_rad.value_or(RadiansFromDegrees(errors.line.angle_deg));
  const double flight_rad =
      observation.sigma_attitude_rad.value_or(common_fraction * RadiansFromDegrees(common.boresight_rise_deg));
  const double shift_m =
      std::hypot(slack_m, observation.sigma_position_m.value_or(common_fraction * common.position_m));
  Eigen::Matrix3d ray_from_enu;  // third row: along the line of sight
  ray_from_enu.row(2) = along;
  ray_from_enu.row(0) = along.unitOrthogonal();
  ray_from_enu.row(1) = along.cross(Eigen::Vector3d(ray_from_enu.row(0)));
  const double across_m2 = Square(std::hypot(own_rad, flight_rad) * to.norm()) + Square(shift_m);
  Eigen::Matrix3d covariance = ray_from_enu * place.covariance_enu_m2 * ray_from_enu.transpose();
  covariance.diagonal() += Eigen::Vector3d(across_m2, across_m2, Square(shift_m));
  if (common_fraction >= 1) {
    for (const Eigen::Vector3d& shift_enu : {ClockShiftAt(line, to.norm()), FocalShiftAt(line, to.norm())}) {
      const Eigen::Vector3d shift = ray_from_enu * shift_enu;
      covariance += shift * shift.transpose();
    }
  }
  Eigen::Vector3d off = ray_from_enu * to;
  if (!line.range_m) return std::sqrt(off.head<2>().dot(covariance.topLeftCorner<2, 2>().ldlt().solve(off.head<2>())));
  const double own_range_m = line.sigma_range_m.value_or(errors.line.range_fraction * *line.range_m);
  covariance(2, 2) += Square(own_range_m) + Square(common_fraction * common.range_fraction * *line.range_m);
  off.z() -= *line.range_m;
  return std::sqrt(off.dot(covariance.ldlt().solve(off)));
}

double Mahalanobis(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance) {
  return std::sqrt(difference.dot(covariance.ldlt().solve(difference)));
}

Eigen::Matrix3d MergeSlackCovariance() { return 2 * kMergeSlack_m * kMergeSlack_m * Eigen::Matrix3d::Identity(); }

std::optional<double> EstimateHeadingMode(std::span<const double> headings_rad) {
  // Three turns, so that no window wraps around; prefix sums give window means.
  std::vector<double> sorted;
  for (const double heading : headings_rad) sorted.push_back(WrapAngle(heading));
  std::ranges::sort(sorted);
  std::vector<double> round;
  for (const double turns : {-1.0, 0.0, 1.0}) {
    for (const double heading : sorted) round.push_back(heading + turns * 2 * kPi);
  }
  std::vector<double> sums = {0};
  for (const double heading : round) sums.push_back(sums.back() + heading);
  std::ptrdiff_t most = 0;
  double best = 0;
  for (const double candidate : sorted) {
    const auto first = std::ranges::lower_bound(round, candidate - kHeadingGate_rad) - round.begin();
    const auto end = std::ranges::upper_bound(round, candidate + kHeadingGate_rad) - round.begin();
    if (end - first <= most) continue;
    most = end - first;
    best = (sums[static_cast<std::size_t>(end)] - sums[static_cast<std::size_t>(first)]) / static_cast<double>(most);
  }
  if (most == 0) return std::nullopt;
  const double heading = WrapAngle(best);
  return heading < 0 ? heading + 2 * kPi : heading;
}

std::optional<SizeRatio> EstimateSizeRatio(std::span<const BearingObservation> observations,
                                           const ObjectOptions& options) {
  if (observations.empty()) return std::nullopt;
  const LocateOptions locate = MakeLocateOptions(observations, options, kFlightErrorFraction);
  return CompareWithRanges(MakeLines(observations, locate.line), locate, options.min_inlier_fraction);
}

namespace {

// The observations whose heading is reversed: half of a vehicle looks like its other half, and a pose on the wrong half
// is off by half a length. No vehicle turns so far from one sighting to the next. Empty if too many are for the others
// to be right.
std::vector<std::size_t> FindReversed(std::span<const BearingObservation> observations) {
  constexpr double kMaxTurn_rad = RadiansFromDegrees(120);
  constexpr double kMaxGap_s = 2;
  std::vector<std::size_t> reversed;
  std::size_t headings = 0;
  std::optional<double> last_rad;
  double last_s = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const std::optional<double>& heading_rad = observations[i].heading_rad;
    if (!heading_rad) continue;
    ++headings;
    const double time_s = observations[i].line.time_s;
    const bool turned =
        last_rad && time_s - last_s < kMaxGap_s && std::abs(WrapAngle(*heading_rad - *last_rad)) > kMaxTurn_rad;
    if (turned) reversed.push_back(i);
    last_rad = *heading_rad + (turned ? kPi : 0);
    last_s = time_s;
  }
  constexpr std::size_t kMinHeadingsOfOne = 4;
  if (kMinHeadingsOfOne * reversed.size() > headings) reversed.clear();
  return reversed;
}

ObjectPlace EstimateOfAll(std::span<const BearingObservation> observations, const ObjectOptions& options,
                          double common_fraction, const std::optional<std::optional<SizeRatio>>& size_ratio) {
  ObjectPlace result;
  if (observations.empty()) return result;
  const LocateOptions locate = MakeLocateOptions(observations, options, common_fraction);
  const std::vector<LineOfSight> lines = MakeLines(observations, locate.line);
  GeoFix fix = LocateChecked(lines, locate);
  if (std::optional<MotionPath> motion = EstimateMotion(observations, lines, locate)) {
    fix = ApplyMotion(*motion, lines, locate, std::move(fix));
    if (fix.place) result.path = std::move(motion->places);
  }
  // Between places of one flight the errors of clock and field of view cancel: they shift them alike.
  const bool is_absolute = common_fraction >= 1;
  if (is_absolute && !result.path.empty()) {
    AddFlightErrors(lines, fix.inliers, locate.ground != nullptr, std::span(result.path));
    fix.place = result.path.back();
  }
  result.place = fix.place;
  if (fix.place && fix.place->IsMoving() && result.path.empty()) {
    result.place = EstimateLastPlace(lines, *fix.place, locate, options);
  }
  if (is_absolute && result.place && result.path.empty())
    AddFlightErrors(lines, fix.inliers, locate.ground != nullptr, *result.place);
  result.inlier_fraction =
      static_cast<double>(std::ranges::count(fix.inliers, true)) / static_cast<double>(lines.size());
  const std::optional<SizeRatio> ratio =
      size_ratio ? *size_ratio : CompareWithRanges(lines, locate, options.min_inlier_fraction);
  if (ratio) {
    result.size_ratio = ratio->ratio;
    // Sizes are proportional to the focal length; what the lines of a straight flight give is, too, but not of others.
    const std::optional<FocalShift>& focal = lines.back().focal_shift;
    result.size_sigma = std::hypot(ratio->sigma, focal ? focal->sigma : 0);
  }
  result.path_size = result.path.size();
  const std::vector<std::optional<double>> headings_at_end = HeadingsAtEnd(observations, result.path);
  std::vector<double> headings;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (headings_at_end[i] && (fix.inliers[i] || !fix.place)) headings.push_back(*headings_at_end[i]);
  }
  result.heading_rad = EstimateHeadingMode(headings);
  CountConsistent(observations, headings_at_end, fix, result);
  return result;
}

}  // namespace

ObjectPlace EstimatePlace(std::span<const BearingObservation> observations, const ObjectOptions& options,
                          double common_fraction, const std::optional<std::optional<SizeRatio>>& size_ratio) {
  const std::vector<std::size_t> reversed = FindReversed(observations);
  if (reversed.empty()) return EstimateOfAll(observations, options, common_fraction, size_ratio);
  std::vector<BearingObservation> others;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!std::ranges::binary_search(reversed, i)) others.push_back(observations[i]);
  }
  ObjectPlace result = EstimateOfAll(others, options, common_fraction, size_ratio);
  const double fraction = static_cast<double>(others.size()) / static_cast<double>(observations.size());
  result.inlier_fraction *= fraction;
  result.consistent_fraction *= fraction;
  result.headings += static_cast<std::int64_t>(reversed.size());
  result.contradicting_headings += static_cast<std::int64_t>(reversed.size());
  return result;
}

}  // namespace victorious
