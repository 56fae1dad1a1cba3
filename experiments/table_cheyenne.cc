// Places from the steady stares of a real flight, compared with the frame centres that its own system recorded.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "experiments/place_experiments.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/klv_camera.h"
#include "victorious/input/telemetry/klv_packets.h"
#include "victorious/lab/evaluate/place_score.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/place/geolocate/locate.h"

namespace victorious {
namespace {

// Both heights refer to mean sea level, so that the geoid's undulation cancels.
struct CentredSighting {
  LineOfSight line;
  GeodeticPoint centre;  // recorded centre of the frame
};

struct Stare {
  std::size_t first;  // packet indexes, from 0
  std::size_t last;
};

std::vector<CentredSighting> ReadSightings(const Telemetry& telemetry) {
  std::vector<CentredSighting> sightings;
  for (const KlvPacket& packet : telemetry.packets) {
    const auto camera = CameraFromKlv(packet);
    const auto time_us = PrecisionTime(packet);
    const auto latitude_deg = packet.Number(23);
    const auto longitude_deg = packet.Number(24);
    const auto elevation_m = packet.Number(25);
    if (!camera || !camera->attitude || !time_us || !latitude_deg || !longitude_deg || !elevation_m) return {};
    sightings.push_back(
        {.line = {.time_s = static_cast<double>(*time_us) * 1e-6,
                  .camera = camera->place,
                  .azimuth_rad = camera->attitude->yaw_rad,
                  .elevation_rad = camera->attitude->pitch_rad,
                  .range_m = std::nullopt,
                  .sigma_rad = std::nullopt,
                  .sigma_range_m = std::nullopt},
         .centre = {RadiansFromDegrees(*latitude_deg), RadiansFromDegrees(*longitude_deg), *elevation_m}});
  }
  return sightings;
}

// Finds intervals of at least 5 s in which the frame centre stays within 30 m of its first position.
std::vector<Stare> FindStares(const std::vector<CentredSighting>& sightings) {
  constexpr double kSteadyM = 30;
  constexpr double kMinS = 5;
  std::vector<Stare> stares;
  for (std::size_t first = 0; first < sightings.size();) {
    const TangentPlane plane(sightings[first].centre);
    std::size_t end = first + 1;
    while (end < sightings.size() && plane.EnuFromGeodetic(sightings[end].centre).head<2>().norm() <= kSteadyM) ++end;
    if (sightings[end - 1].line.time_s - sightings[first].line.time_s >= kMinS) stares.push_back({first, end - 1});
    first = end;
  }
  return stares;
}

GeodeticPoint MeanCentre(std::span<const CentredSighting> sightings) {
  const TangentPlane plane(sightings.front().centre);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CentredSighting& one : sightings) sum += plane.EnuFromGeodetic(one.centre);
  return plane.GeodeticFromEnu(sum / static_cast<double>(sightings.size()));
}

// The change of azimuth from the first to the last line, degrees.
double TurnDeg(std::span<const CentredSighting> sightings) {
  double turn_rad = 0;
  for (std::size_t i = 1; i < sightings.size(); ++i) {
    turn_rad += WrapAngle(sightings[i].line.azimuth_rad - sightings[i - 1].line.azimuth_rad);
  }
  return std::abs(DegreesFromRadians(turn_rad));
}

struct CheyenneVariant {
  LocateMethod method;
  std::size_t every;  // step between the lines used; 0: the middle line only
};

void AddRow(const std::string& name, std::span<const CentredSighting> sightings, const CheyenneVariant& way,
            Report& report) {
  const GeodeticPoint truth = MeanCentre(sightings);
  std::vector<LineOfSight> lines;
  if (way.every == 0) {
    lines.push_back(sightings[sightings.size() / 2].line);
  } else {
    for (std::size_t i = 0; i < sightings.size(); i += way.every) lines.push_back(sightings[i].line);
  }
  LocateOptions options{.method = way.method};
  if (options.method == LocateMethod::kGround) options.ground = std::make_shared<FlatGround>(truth.altitude_m);
  const auto fix = Locate(lines, options);
  std::vector<Cell> row = {name, TurnDeg(sightings), std::string(ToText(kLocateMethodTexts, way.method)),
                           static_cast<double>(lines.size())};
  if (!fix || !fix->place) {
    row.insert(row.end(), {fix ? StatusText(*fix) : fix.error().message, std::string("-"), std::string("-"),
                           std::string("-"), std::string("-")});
  } else {
    const PlaceError error = ComputePlaceError(fix->place, std::nullopt, TruthRow{.place = truth});
    row.insert(row.end(), {*error.horizontal_error_m, *error.spatial_error_m, fix->place->ce90_m, fix->place->le90_m,
                           std::string(error.in_ellipsoid ? "yes" : "no")});
  }
  report.rows.push_back(std::move(row));
}

}  // namespace

Expected<Report> RunTableCheyenne(const ExperimentSettings& settings) {
  const std::filesystem::path path = settings.data / "real/fmv_klv/raw_packets/Cheyenne.bin";
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, ReadTelemetry(path.string(), {}));
  const std::vector<CentredSighting> sightings = ReadSightings(telemetry);
  const std::vector<Stare> stares = FindStares(sightings);
  if (stares.empty()) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: no interval with a steady frame centre", path.string()));
  }
  Report report{
      .title = "Places from a real flight's stares, against the recorded frame centres",
      .notes = {"Stares: intervals of 5 s or more in which the recorded frame centre stays within 30 m of its first "
                "position; the truth is its mean. Errors of lines and flight: the defaults. The method ground uses "
                "one line and the recorded elevation; the others use lines only."},
      .columns = {"packets", "turn, deg", "method", "lines", "error along the ground, m", "in space, m", "CE90, m",
                  "LE90, m", "in the 90 % ellipsoid"}};
  for (const Stare& stare : stares) {
    const auto lines = std::span(sightings).subspan(stare.first, stare.last - stare.first + 1);
    const std::string name = fmt::format("{} to {}", stare.first, stare.last);
    for (const CheyenneVariant& way : std::initializer_list<CheyenneVariant>{{LocateMethod::kGround, 0},
                                                                             {LocateMethod::kMaximumLikelihood, 1},
                                                                             {LocateMethod::kMaximumLikelihood, 8},
                                                                             {LocateMethod::kRansac, 1},
                                                                             {LocateMethod::kPrior, 1},
                                                                             {LocateMethod::kLeastSquares, 1}}) {
      AddRow(name, lines, way, report);
    }
  }
  return report;
}

}  // namespace victorious
