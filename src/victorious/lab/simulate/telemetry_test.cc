#include "victorious/lab/simulate/telemetry.h"

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/lab/simulate/flight_path.h"
#include "victorious/lab/simulate/truth.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
// Projects a geodetic point into a camera: an independent implementation of docs/formats/telemetry.md.
std::optional<Vector2d> Project(const CameraState& camera, const GeodeticPoint& place, int width, int height) {
  const PinholeCamera pinhole =
      MakePinhole({.width = width, .height = height, .hfov_deg = DegreesFromRadians(*camera.hfov_rad)});
  return pinhole.Project(CameraFromEnu(*camera.attitude) * TangentPlane(camera.place).EnuFromGeodetic(place));
}

TEST(Telemetry, ProjectionThroughTelemetryMatchesTheCamera) {
  constexpr double kTownHeadingRad = 1.1;
  const TangentPlane earth({RadiansFromDegrees(61), RadiansFromDegrees(24), 80});
  const SceneVideo video{.width = 640, .height = 480, .hfov_deg = 15};
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    SceneCamera camera;
    camera.aim_m = {{random.Uniform(-2000, 2000), random.Uniform(-2000, 2000)}};
    camera.from_deg = {random.Uniform(0, 360)};
    camera.off_nadir_deg = {random.Uniform(0, 70)};
    camera.roll_deg = {random.Uniform(-40, 40)};
    const Rigid3 camera_from_town = CameraFromTown(camera, 0, 0, 1);
    const Vector3d point(camera.aim_m[0].x() + 4, camera.aim_m[0].y() - 3, 2);
    const std::vector<CameraState> flight = {
        MakeCameraState(camera_from_town, earth, kTownHeadingRad, 0.5, RadiansFromDegrees(video.hfov_deg))};
    const auto written = ParseCameraCsv(FormatCameraCsv(flight));
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_NEAR(written->states.at(0).time_s, 0.5, 1e-6);
    EXPECT_EQ(written->states[0].datum, VerticalDatum::kEllipsoid);
    const auto seen = MakePinhole(video).Project(camera_from_town.Apply(point));
    const auto by_telemetry = Project(written->states[0], earth.GeodeticFromEnu(EnuFromTown(kTownHeadingRad) * point),
                                      video.width, video.height);
    ASSERT_TRUE(seen && by_telemetry);
    EXPECT_LT((*seen - *by_telemetry).norm(), 0.01);
  }
}

// A flight by another renderer, made to the same definitions by independent code.
TEST(Telemetry, MatchesReferenceFlight) {
  VICTORIOUS_DATA_OR_SKIP(folder, "movies/dev_soft");
  const auto text = ReadFile(folder / "telemetry.csv");
  ASSERT_TRUE(text) << text.error().message;
  const auto telemetry = ParseCameraCsv(*text);
  ASSERT_TRUE(telemetry) << telemetry.error().message;
  std::ifstream truth(folder / "truth.jsonl");
  int whole = 0;
  for (std::string line; std::getline(truth, line);) {
    const auto json = nlohmann::json::parse(line);
    const CameraState& camera = telemetry->states.at(json["frame"].get<std::size_t>());
    const GeodeticPoint place = {RadiansFromDegrees(json["latitude_deg"].get<double>()),
                                 RadiansFromDegrees(json["longitude_deg"].get<double>()),
                                 json["altitude_m"].get<double>()};
    // Direction from the object to the camera, in the object's frame (front, left, up).
    const TangentPlane at_object(place);
    const Vector3d to_camera = at_object.EnuFromGeodetic(camera.place);
    const double heading = RadiansFromDegrees(json["heading_deg"].get<double>());
    const Vector3d front(std::sin(heading), std::cos(heading), 0);
    const Vector3d left(-std::cos(heading), std::sin(heading), 0);
    const ViewDirection view = DirectionFromVector({to_camera.dot(front), to_camera.dot(left), to_camera.z()});
    const double azimuth = RadiansFromDegrees(json["view"]["azimuth_deg"].get<double>());
    EXPECT_NEAR(DegreesFromRadians(WrapAngle(view.azimuth_rad - azimuth)), 0, 0.01) << line;
    EXPECT_NEAR(DegreesFromRadians(view.off_nadir_rad), json["view"]["off_nadir_deg"].get<double>(), 0.01) << line;
    if (json["visible"].get<double>() < 0.98) continue;
    ++whole;
    const auto seen = Project(camera, place, 640, 480);
    ASSERT_TRUE(seen);
    const std::vector<double> box = json["box"];
    // The centre of the visible box is near the projected centre of the 3D box; perspective and shape shift it
    // slightly.
    EXPECT_NEAR(seen->x(), box[0] + box[2] / 2, 0.12 * box[2] + 1) << line;
    EXPECT_NEAR(seen->y(), box[1] + box[3] / 2, 0.12 * box[3] + 1) << line;
  }
  EXPECT_GT(whole, 30);
}

}  // namespace
}  // namespace victorious
