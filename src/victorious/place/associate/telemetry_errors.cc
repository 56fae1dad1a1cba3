#include "victorious/place/associate/telemetry_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/count_text.h"
#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/focal_prior.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/place/geolocate/flight_shift.h"
#include "victorious/types/line_direction.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kMinErrorLines = 5;     // of an object
constexpr std::size_t kMaxErrorObjects = 12;  // those with most lines
constexpr std::size_t kMaxErrorFrames = 60;   // more change little

// The place by the ranges alone, as a prior of the distance, where lines do not meet.
constexpr double kDistanceFraction = 0.1;
constexpr double kAcross_m = 100;

// Standard deviation of a line's own error: at least this, that of the object's centre, which differs from view to
// view.
constexpr double kMinSigma_rad = 1e-4;

// Standard deviations of log a and log b about log q, and of log m. Chosen, not fitted: a factor of 1.5 either way.
constexpr double kTieSigma = 0.4;
constexpr double kOwnSigma = 0.5;

// A line farther from the others of its object than this many standard deviations, of all lines, is an outlier.
constexpr double kGateSigmas = 4;

struct ComparedLine {
  int frame = 0;  // index into the frames that are used
  double time_s = 0;
  Vector3d camera;     // ENU, m
  Vector3d direction;  // as observed
  double sigma_rad = 0;
  double range_m = 0;  // 0: none
  Vector3d clock_m;    // shifts by one standard deviation, at the distance of the place
  Vector3d focal_m;
  const LineOfSight* source = nullptr;
};

struct ComparedObject {
  std::vector<ComparedLine> lines;
  Vector3d place = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();  // horizontal, of the fit with motion
  double velocity_sigma_m_s = 0;
};

// Of each recognition the first observation: those that were tracked from it share its error.
ComparedObject MakeComparedObject(const ObservedTracklet& tracklet, const TangentPlane& plane) {
  ComparedObject object;
  std::int64_t recognition = 0;
  for (std::size_t i = 0; i < tracklet.observations.size(); ++i) {
    const BearingObservation& observation = tracklet.observations[i];
    if (observation.recognition_id != 0 && observation.recognition_id == recognition) continue;
    recognition = observation.recognition_id;
    const LineOfSight& line = observation.line;
    const Vector3d camera = plane.EnuFromGeodetic(line.camera);
    object.lines.push_back(
        {.frame = static_cast<int>(i < tracklet.observation_frames.size() ? tracklet.observation_frames[i] : -1),
         .time_s = line.time_s,
         .camera = camera,
         .direction = plane.LocalEnuFromEnu(camera).conjugate() * DirectionOf(line),
         .sigma_rad = std::max(kMinSigma_rad, line.sigma_rad.value_or(RadiansFromDegrees(0.5))),
         .range_m = line.range_m.value_or(0),
         .clock_m = Vector3d::Zero(),
         .focal_m = Vector3d::Zero(),
         .source = &line});
  }
  return object;
}

// The point nearest to the lines, or a point that moves steadily and level, by least squares; the distance by the
// ranges counts as much as it is accurate beside the lines, so that it decides where they do not meet. False if the
// place is behind a camera.
bool FitComparedPlace(ComparedObject& object, bool moving) {
  const int unknowns = moving ? 5 : 3;
  std::vector<double> ranges_m;
  for (const ComparedLine& line : object.lines) {
    if (line.range_m > 0) ranges_m.push_back(line.range_m);
  }
  if (ranges_m.empty()) return false;
  const double range_m = Median(ranges_m);
  const double middle_s = (object.lines.front().time_s + object.lines.back().time_s) / 2;
  const auto factors_of = [&](const ComparedLine& line) {
    MatrixXd factors = MatrixXd::Zero(3, unknowns);
    factors.leftCols<3>().setIdentity();
    if (moving) factors.block<2, 2>(0, 3) = (line.time_s - middle_s) * Eigen::Matrix2d::Identity();
    return factors;
  };
  const auto to_place = [&](const ComparedLine& line, const VectorXd& solution) -> Vector3d {
    return factors_of(line) * solution - line.camera;
  };
  const double count = static_cast<double>(object.lines.size());
  constexpr int kRounds = 3;
  double along_weight = 1;  // of a range relative to a direction
  double variance_m2 = 0;
  Eigen::LDLT<MatrixXd> solver;
  VectorXd solution;
  for (int round = 0; round < kRounds; ++round) {
    MatrixXd normal = MatrixXd::Zero(unknowns, unknowns);
    VectorXd right = VectorXd::Zero(unknowns);
    for (const ComparedLine& line : object.lines) {
      const Vector3d& u = line.direction;
      const Matrix3d weight = Matrix3d::Identity() - (line.range_m > 0 ? 1 - along_weight : 1.0) * u * u.transpose();
      const MatrixXd factors = factors_of(line);
      normal += factors.transpose() * weight * factors;
      right += factors.transpose() * weight * (line.camera + line.range_m * u);
    }
    if (moving) normal.diagonal().tail(2).array() += 1e-6 * count;
    solver.compute(normal);
    solution = solver.solve(right);
    if (!solution.allFinite()) return false;
    double squares = 0;
    for (const ComparedLine& line : object.lines)
      squares += line.direction.cross(to_place(line, solution)).squaredNorm();
    variance_m2 = squares / std::max(1.0, 2 * count - unknowns);
    along_weight = std::min(1.0, variance_m2 / std::pow(kDistanceFraction * range_m, 2));
  }
  for (const ComparedLine& line : object.lines) {
    if (!(to_place(line, solution).dot(line.direction) > 0.2 * range_m)) return false;
  }
  if (!moving) {
    object.place = solution.head<3>();
    return true;
  }
  object.velocity = Vector3d(solution(3), solution(4), 0);
  object.velocity_sigma_m_s =
      std::sqrt(variance_m2 * solver.solve(MatrixXd::Identity(unknowns, unknowns)).diagonal().tail(2).sum());
  return true;
}

double OffsetOf(const ComparedObject& object, const ComparedLine& line) {
  return line.direction.cross(object.place - line.camera).norm();
}

// m/s, while the object that is seen for the longest time is.
double SpeedOfCamera(std::span<const ComparedObject> objects) {
  double longest_s = 0;
  double speed_m_s = 0;
  for (const ComparedObject& object : objects) {
    const double time_s = object.lines.back().time_s - object.lines.front().time_s;
    if (time_s <= longest_s) continue;
    longest_s = time_s;
    speed_m_s = (object.lines.back().camera - object.lines.front().camera).norm() / time_s;
  }
  return speed_m_s;
}

bool MovesWith(const ComparedObject& object, const Vector3d& velocity) {
  constexpr double kMinSpeed_m_s = 0.5;
  constexpr double kSpeedSigmas = 4;
  return (object.velocity - velocity).norm() <= std::max(kMinSpeed_m_s, kSpeedSigmas * object.velocity_sigma_m_s);
}

// The velocity with which all standing objects seem to move: a wrong yaw turns it out of the camera's. It is none if an
// object stands that does not move so, or if it is too large for such an error: then the others drive along one road.
Vector3d CommonVelocity(std::span<const ComparedObject> objects) {
  constexpr std::size_t kMinOfCommon = 3;
  constexpr double kMaxOfCamera = 0.2;
  if (objects.size() < kMinOfCommon) return Vector3d::Zero();
  std::vector<double> east;
  std::vector<double> north;
  for (const ComparedObject& object : objects) {
    east.push_back(object.velocity.x());
    north.push_back(object.velocity.y());
  }
  const Vector3d common(Median(std::move(east)), Median(std::move(north)), 0);
  const bool stands = std::ranges::any_of(objects, [&](const ComparedObject& object) {
    return MovesWith(object, Vector3d::Zero()) && !MovesWith(object, common);
  });
  return stands || common.norm() > kMaxOfCamera * SpeedOfCamera(objects) ? Vector3d::Zero() : common;
}

void RemoveMoving(std::vector<ComparedObject>& objects) {
  std::erase_if(objects, [](ComparedObject& object) { return !FitComparedPlace(object, true); });
  const Vector3d common = CommonVelocity(objects);
  std::erase_if(objects, [&](const ComparedObject& object) { return !MovesWith(object, common); });
}

// Fits the places; removes outliers, and objects whose lines meet far worse than those of the others.
void FitPlaces(std::vector<ComparedObject>& objects) {
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    std::erase_if(objects, [](ComparedObject& object) { return !FitComparedPlace(object, false); });
    std::vector<double> medians;
    for (const ComparedObject& object : objects) {
      std::vector<double> offsets;
      for (const ComparedLine& line : object.lines) offsets.push_back(OffsetOf(object, line));
      medians.push_back(Median(std::move(offsets)));
    }
    if (medians.empty()) return;
    constexpr double kFarWorse = 4;
    const double usual_m = Median(medians);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const double gate_m = kGateSigmas / kRayleighMedian * medians[i];
      std::erase_if(objects[i].lines, [&](const ComparedLine& line) { return OffsetOf(objects[i], line) > gate_m; });
      if (objects.size() > 2 && medians[i] > kFarWorse * usual_m + 0.2) objects[i].lines.clear();
    }
    std::erase_if(objects, [](const ComparedObject& object) { return object.lines.size() < kMinErrorLines; });
  }
  std::erase_if(objects, [](ComparedObject& object) { return !FitComparedPlace(object, false); });
}

// The lines of all objects in one frame. Rows: side and rise of each.
struct FrameLines {
  VectorXd offset_m;
  VectorXd own_m2;     // variance of each row's own error
  MatrixXd position;   // rows x 3, by one supposed sigma of the position of the row
  MatrixXd attitude;   // rows x 2, by one supposed sigma of the attitude: yaw, pitch
  MatrixXd unknowns;   // rows x (3 a place): by the places
  MatrixXd of_flight;  // rows x 2: by errors of clock and focal length
};

struct Supposed {
  double position_m = 0;
  double attitude_rad = 0;
};

// Mean square of the offsets of an object's lines, m^2.
double MeanSquareOffset(const ComparedObject& object) {
  double squares = 0;
  for (const ComparedLine& line : object.lines) squares += std::pow(OffsetOf(object, line), 2);
  return squares / static_cast<double>(object.lines.size());
}

std::vector<FrameLines> MakeFrames(std::span<const ComparedObject> objects, const Supposed& supposed) {
  std::map<int, std::vector<std::pair<std::size_t, const ComparedLine*>>> by_frame;
  std::vector<double> mean_squares_m2;
  std::ranges::transform(objects, std::back_inserter(mean_squares_m2), MeanSquareOffset);
  for (std::size_t o = 0; o < objects.size(); ++o) {
    for (const ComparedLine& line : objects[o].lines) by_frame[line.frame].emplace_back(o, &line);
  }
  std::vector<FrameLines> frames;
  const std::size_t step = (by_frame.size() + kMaxErrorFrames - 1) / kMaxErrorFrames;
  std::size_t number = 0;
  for (const auto& [frame, lines] : by_frame) {
    if (number++ % step != 0) continue;
    const auto rows = static_cast<Eigen::Index>(2 * lines.size());
    const auto places = static_cast<Eigen::Index>(3 * objects.size());
    FrameLines made{.offset_m = VectorXd::Zero(rows),
                    .own_m2 = VectorXd::Zero(rows),
                    .position = MatrixXd::Zero(rows, 3),
                    .attitude = MatrixXd::Zero(rows, 2),
                    .unknowns = MatrixXd::Zero(rows, places),
                    .of_flight = MatrixXd::Zero(rows, 2)};
    Eigen::Index row = 0;
    for (const auto& [o, line] : lines) {
      const Vector3d to_place = objects[o].place - line->camera;
      const double distance_m = to_place.norm();
      const Vector3d side = line->direction.cross(Vector3d::UnitZ()).normalized();
      const Vector3d rise = side.cross(line->direction);
      Eigen::Matrix<double, 2, 3> across;
      across.row(0) = side;
      across.row(1) = rise;
      made.offset_m.segment<2>(row) = across * to_place;
      // Offsets are linear in the errors only to the first order.
      const double second_order_m = mean_squares_m2[o] / distance_m;
      made.own_m2.segment<2>(row).setConstant(std::pow(distance_m * line->sigma_rad, 2) + std::pow(second_order_m, 2));
      made.position.middleRows<2>(row) = supposed.position_m * across;
      made.attitude(row, 0) = supposed.attitude_rad * distance_m * line->direction.head<2>().norm();
      made.attitude(row + 1, 1) = supposed.attitude_rad * distance_m;
      made.unknowns.block<2, 3>(row, static_cast<Eigen::Index>(3 * o)) = across;
      made.of_flight.block<2, 1>(row, 0) = across * ClockShiftAt(*line->source, distance_m);
      made.of_flight.block<2, 1>(row, 1) = across * FocalShiftAt(*line->source, distance_m);
      row += 2;
    }
    frames.push_back(std::move(made));
  }
  return frames;
}

struct Scales {
  double position = 1;
  double attitude = 1;
  double own = 1;
};

// The information about the places before the lines are seen: by the ranges.
MatrixXd PlaceInformation(std::span<const ComparedObject> objects) {
  const auto places = static_cast<Eigen::Index>(3 * objects.size());
  MatrixXd information = MatrixXd::Zero(places, places);
  for (std::size_t o = 0; o < objects.size(); ++o) {
    const ComparedObject& object = objects[o];
    const Vector3d to_place = object.place - object.lines[object.lines.size() / 2].camera;
    const Vector3d along = to_place.normalized();
    const double along_m = kDistanceFraction * to_place.norm();
    const auto at = static_cast<Eigen::Index>(3 * o);
    information.block<3, 3>(at, at) = (Matrix3d::Identity() - along * along.transpose()) / (kAcross_m * kAcross_m) +
                                      along * along.transpose() / (along_m * along_m);
  }
  return information;
}

// The logarithm of the likelihood of the offsets, but for a constant. Unknown and integrated out: the places, the
// attitude error of the flight, clock, focal length.
double LogLikelihood(std::span<const FrameLines> frames, const MatrixXd& place_information, const Scales& scales) {
  const Eigen::Index places = place_information.rows();
  const Eigen::Index unknowns = places + 4;
  MatrixXd information = MatrixXd::Identity(unknowns, unknowns);
  information.topLeftCorner(places, places) = place_information;
  VectorXd right = VectorXd::Zero(unknowns);
  double log_determinant = 0;
  double squares = 0;
  MatrixXd design;
  for (const FrameLines& frame : frames) {
    MatrixXd covariance = scales.position * scales.position * frame.position * frame.position.transpose() +
                          scales.attitude * scales.attitude * frame.attitude * frame.attitude.transpose();
    covariance.diagonal() += scales.own * scales.own * frame.own_m2;
    const Eigen::LLT<MatrixXd> factors(covariance);
    design.resize(frame.offset_m.size(), unknowns);
    design << frame.unknowns, scales.attitude * frame.attitude, frame.of_flight;
    const MatrixXd whitened = factors.matrixL().solve(design);
    const VectorXd offset = factors.matrixL().solve(frame.offset_m);
    information.selfadjointView<Eigen::Lower>().rankUpdate(whitened.transpose());
    right += whitened.transpose() * offset;
    squares += offset.squaredNorm();
    log_determinant += 2 * factors.matrixLLT().diagonal().array().log().sum();
  }
  const Eigen::LLT<MatrixXd> solver(information.selfadjointView<Eigen::Lower>());
  squares -= right.dot(solver.solve(right));
  log_determinant += 2 * solver.matrixLLT().diagonal().array().log().sum();
  return -(squares + log_determinant) / 2;
}

// Coordinates of the grid of the scales: the mean of log a and log b, their difference, and log m.
struct GridPoint {
  double log_q = 0;
  double difference = 0;
  double log_own = 0;
};

struct ScaleNode {
  GridPoint at;
  Scales scales;
  double log_prior = 0;
  double log_posterior = 0;
};

ScaleNode MakeNode(const GridPoint& at) {
  const double q = std::exp(at.log_q);
  const double log_prior =
      std::log(q / (1 + q * q)) - std::pow(at.difference / kTieSigma, 2) / 4 - std::pow(at.log_own / kOwnSigma, 2) / 2;
  return {.at = at,
          .scales = {.position = q * std::exp(at.difference / 2),
                     .attitude = q * std::exp(-at.difference / 2),
                     .own = std::exp(at.log_own)},
          .log_prior = log_prior};
}

constexpr GridPoint kGridStep = {.log_q = 0.34, .difference = 0.6, .log_own = 0.5};

std::vector<ScaleNode> MakeGrid(const GridPoint& centre, const std::array<int, 3>& reach, const GridPoint& step) {
  std::vector<ScaleNode> nodes;
  for (int i = -reach[0]; i <= reach[0]; ++i) {
    for (int j = -reach[1]; j <= reach[1]; ++j) {
      for (int k = -reach[2]; k <= reach[2]; ++k) {
        nodes.push_back(MakeNode({.log_q = centre.log_q + i * step.log_q,
                                  .difference = centre.difference + j * step.difference,
                                  .log_own = centre.log_own + k * step.log_own}));
      }
    }
  }
  return nodes;
}

// Sets the logarithm of the posterior, at most 0. Returns the share of the best node, and that node.
std::pair<double, const ScaleNode*> Weigh(std::span<const FrameLines> frames, const MatrixXd& place_information,
                                          std::vector<ScaleNode>& nodes) {
  oneapi::tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    nodes[i].log_posterior = nodes[i].log_prior + LogLikelihood(frames, place_information, nodes[i].scales);
  });
  const auto best = std::ranges::max_element(nodes, {}, &ScaleNode::log_posterior);
  const double most = best->log_posterior;
  double total = 0;
  for (ScaleNode& node : nodes) {
    node.log_posterior -= most;
    total += std::exp(node.log_posterior);
  }
  return {1 / total, &*best};
}

// A coarse grid over all sizes; where it finds the posterior within a step or two, a fine one there.
std::vector<ScaleNode> WeighScales(std::span<const FrameLines> frames, const MatrixXd& place_information) {
  constexpr double kNarrow = 0.2;
  constexpr GridPoint kMiddle = {.log_q = -1.7, .difference = 0, .log_own = 0};  // from exact to 6 times the supposed
  std::vector<ScaleNode> nodes = MakeGrid(kMiddle, {10, 2, 2}, kGridStep);
  const auto [share, best] = Weigh(frames, place_information, nodes);
  if (share < kNarrow) return nodes;
  constexpr GridPoint kFineStep = {.log_q = kGridStep.log_q / 4, .difference = 0.2, .log_own = 0.25};
  std::vector<ScaleNode> fine = MakeGrid(best->at, {5, 4, 2}, kFineStep);
  Weigh(frames, place_information, fine);
  return fine;
}

// The root of the mean square of a scale, and whether the posterior is narrow or lies far below the prior.
template <typename Scale>
ErrorScale SummariseScale(std::span<const ScaleNode> nodes, const Scale& scale) {
  double total = 0;
  double square = 0;
  double log_mean = 0;
  double log_square = 0;
  for (const ScaleNode& node : nodes) {
    const double weight = std::exp(node.log_posterior);
    const double value = scale(node.scales);
    total += weight;
    square += weight * value * value;
    log_mean += weight * std::log(value);
    log_square += weight * std::pow(std::log(value), 2);
  }
  constexpr double kMeasuredLogSigma = 0.5;
  constexpr double kMeasuredBelow = 0.5;
  const double ratio = std::sqrt(square / total);
  const double log_sigma = std::sqrt(std::max(0.0, log_square / total - std::pow(log_mean / total, 2)));
  return {.ratio = ratio, .is_measured = log_sigma < kMeasuredLogSigma || ratio < kMeasuredBelow};
}

// True if the standard deviation of the clock is the supposed one: the shift of the lines over the velocity of the
// camera.
bool HasSupposedClock(std::span<const ComparedObject> objects) {
  double count = 0;
  double mean_s = 0;
  Vector3d mean_m = Vector3d::Zero();
  Vector3d shift_m = Vector3d::Zero();
  const auto for_each = [&](const auto& visit) {
    for (const ComparedObject& object : objects) {
      for (const ComparedLine& line : object.lines) {
        if (line.source->clock_shift) visit(line);
      }
    }
  };
  for_each([&](const ComparedLine& line) {
    count += 1;
    mean_s += line.time_s;
    mean_m += line.camera;
    shift_m += line.source->clock_shift->camera_enu_m;
  });
  if (count == 0) return false;
  mean_s /= count;
  mean_m /= count;
  shift_m /= count;
  double spread_s2 = 0;
  Vector3d slope = Vector3d::Zero();
  for_each([&](const ComparedLine& line) {
    spread_s2 += std::pow(line.time_s - mean_s, 2);
    slope += (line.time_s - mean_s) * (line.camera - mean_m);
  });
  const Vector3d velocity = slope / std::max(1e-9, spread_s2);
  const double sigma_s = std::abs(shift_m.dot(velocity)) / std::max(1e-9, velocity.squaredNorm());
  // That of a clock whose telemetry was recorded with the video. A measured one, or one that was given, is another.
  const double supposed_s = TelemetryOptions().clock_sigma_s;
  constexpr double kTolerance = 0.2;
  return std::abs(sigma_s - supposed_s) < kTolerance * supposed_s;
}

// False if the field of view may well be that of another zoom, of which rows say nothing.
bool HasRightFieldOfView(std::span<const ComparedObject> objects) {
  return std::ranges::all_of(objects, [](const ComparedObject& object) {
    return std::ranges::all_of(object.lines, [](const ComparedLine& line) {
      return !line.source->focal_shift || line.source->focal_shift->sigma < 2 * kRightFocalSigma;
    });
  });
}

bool StatesErrors(const ObservedTracklet& tracklet) {
  const auto states = std::ranges::count_if(tracklet.observations, [](const BearingObservation& observation) {
    return observation.sigma_position_m || observation.sigma_attitude_rad;
  });
  return 2 * states > std::ssize(tracklet.observations);  // some rows may only be old
}

Supposed SupposedErrors(const CommonErrorOptions& common) {
  return {.position_m = common.position_m, .attitude_rad = RadiansFromDegrees(common.heading_deg)};
}

}  // namespace

std::optional<TelemetryErrors> EstimateTelemetryErrors(std::span<const ObservedTracklet> tracklets,
                                                       const ObjectOptions& options) {
  if (options.telemetry_errors == ErrorSource::kSupposed) return std::nullopt;
  const Supposed supposed = SupposedErrors(options.locate.common);
  if (!(supposed.position_m > 0) || !(supposed.attitude_rad > 0)) return std::nullopt;
  std::optional<TangentPlane> plane;
  bool is_filtered = false;
  std::vector<ComparedObject> objects;
  for (const ObservedTracklet& tracklet : tracklets) {
    if (tracklet.is_category || tracklet.is_of_photos || tracklet.observations.size() < kMinErrorLines) continue;
    if (StatesErrors(tracklet)) return std::nullopt;
    is_filtered = is_filtered || tracklet.has_filtered_telemetry;
    if (!plane) plane.emplace(tracklet.observations.front().line.camera);
    objects.push_back(MakeComparedObject(tracklet, *plane));
  }
  std::erase_if(objects, [](const ComparedObject& object) { return object.lines.size() < kMinErrorLines; });
  std::ranges::stable_sort(objects, std::greater(), [](const ComparedObject& object) { return object.lines.size(); });
  if (objects.size() > kMaxErrorObjects) objects.erase(objects.begin() + kMaxErrorObjects, objects.end());
  RemoveMoving(objects);
  FitPlaces(objects);
  if (objects.empty()) return std::nullopt;
  const std::vector<FrameLines> frames = MakeFrames(objects, supposed);
  if (frames.size() < kMinErrorFrames) return std::nullopt;
  const std::vector<ScaleNode> nodes = WeighScales(frames, PlaceInformation(objects));
  TelemetryErrors errors{.is_receiver_known = options.telemetry_errors == ErrorSource::kReceiver && !is_filtered,
                         .objects = static_cast<int>(objects.size()),
                         .frames = static_cast<int>(frames.size())};
  errors.position = SummariseScale(nodes, [](const Scales& scales) { return scales.position; });
  errors.attitude = SummariseScale(nodes, [](const Scales& scales) { return scales.attitude; });
  const double q =
      SummariseScale(nodes, [](const Scales& scales) { return std::sqrt(scales.position * scales.attitude); }).ratio;
  const double others = q * std::exp(kTieSigma * kTieSigma / 2);
  if (HasSupposedClock(objects)) errors.clock_ratio = errors.is_receiver_known ? others : std::max(1.0, others);
  if (HasRightFieldOfView(objects) && errors.is_receiver_known) errors.focal_ratio = std::min(1.0, others);
  return errors;
}

void SetTelemetryErrors(const TelemetryErrors& errors, const ObjectOptions& options,
                        std::span<ObservedTracklet> tracklets) {
  const Supposed supposed = SupposedErrors(options.locate.common);
  const auto of_flight = [&](double ratio) { return errors.is_receiver_known ? ratio : std::max(1.0, ratio); };
  const TelemetrySigmas sigmas{.row_position_m = errors.position.ratio * supposed.position_m,
                               .row_attitude_rad = errors.attitude.ratio * supposed.attitude_rad,
                               .common_position = of_flight(errors.position.ratio),
                               .common_attitude = of_flight(errors.attitude.ratio)};
  for (ObservedTracklet& tracklet : tracklets) {
    if (tracklet.is_of_photos) continue;
    for (BearingObservation& observation : tracklet.observations) {
      observation.flight_sigmas = sigmas;
      if (auto& shift = observation.line.clock_shift) {
        shift->camera_enu_m *= errors.clock_ratio;
        shift->azimuth_rad *= errors.clock_ratio;
        shift->elevation_rad *= errors.clock_ratio;
      }
      if (auto& shift = observation.line.focal_shift) {
        for (double* of_shift : {&shift->sigma, &shift->azimuth_rad, &shift->elevation_rad})
          *of_shift *= errors.focal_ratio;
      }
    }
  }
}

std::vector<std::string> DescribeErrors(const std::optional<TelemetryErrors>& errors, const ObjectOptions& options) {
  const Supposed supposed = SupposedErrors(options.locate.common);
  const double attitude_deg = DegreesFromRadians(supposed.attitude_rad);
  if (!errors) {
    return {fmt::format("position: {:.2g} m, assumed", supposed.position_m),
            fmt::format("attitude: {:.2g} degrees, assumed", attitude_deg)};
  }
  const std::string measured =
      fmt::format("on {} and {}", CountText(errors->objects, "object"), CountText(errors->frames, "frame"));
  const auto describe = [&](std::string_view what, std::string_view unit, double sigma, const ErrorScale& scale) {
    const double common = errors->is_receiver_known ? scale.ratio : std::max(1.0, scale.ratio);
    return fmt::format("{}: {:.2g} {} from row to row, {}; {:.2g} {} in the whole flight, assumed{}", what,
                       sigma * scale.ratio, unit, scale.is_measured ? "measured " + measured : "assumed",
                       sigma * common, unit, errors->is_receiver_known ? " to be of that size" : "");
  };
  std::vector<std::string> lines = {describe("position", "m", supposed.position_m, errors->position),
                                    describe("attitude", "degrees", attitude_deg, errors->attitude)};
  const auto describe_other = [&](std::string_view what, double ratio) {
    if (ratio != 1)
      lines.push_back(fmt::format("{}: {:.2g} times the usual error, assumed to be as the others", what, ratio));
  };
  describe_other("clock", errors->clock_ratio);
  describe_other("field of view", errors->focal_ratio);
  return lines;
}

}  // namespace victorious
