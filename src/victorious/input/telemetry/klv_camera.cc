#include "victorious/input/telemetry/klv_camera.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/eg0104.h"
#include "victorious/input/telemetry/klv_packets.h"

namespace victorious {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Item numbers of ST 0601.
enum : int {
  kHeading = 5,
  kPitch = 6,
  kRoll = 7,
  kSensorLatitude = 13,
  kSensorLongitude = 14,
  kSensorTrueAltitude = 15,
  kHorizontalFieldOfView = 16,
  kRelativeAzimuth = 18,
  kRelativeElevation = 19,
  kRelativeRoll = 20,
  kFrameCentreLatitude = 23,
  kFrameCentreLongitude = 24,
  kFrameCentreElevation = 25,
  kSensorEllipsoidHeight = 75,
  kFrameCentreEllipsoidHeight = 78,
  kPitchFull = 90,
  kRollFull = 91,
  kSensorEllipsoidHeightExtended = 104,
};

// The usual errors of telemetry. What an earlier packet sent has one by its age beside them, where that is larger.
constexpr double kUsualPosition_m = 2;
constexpr double kUsualAttitude_deg = 0.5;

struct Height {
  double altitude_m;
  VerticalDatum datum;
};

std::optional<double> FirstValue(const std::optional<double>& first, const std::optional<double>& second) {
  return first ? first : second;
}

std::optional<Height> SelectHeight(const std::optional<double>& ellipsoid_m, const std::optional<double>& sea_m) {
  if (ellipsoid_m) return Height{*ellipsoid_m, VerticalDatum::kEllipsoid};
  if (sea_m) return Height{*sea_m, VerticalDatum::kEgm96};
  return std::nullopt;
}

// The rotation of a body: about down by yaw, then about right by pitch, then about forward by roll.
Quaterniond BodyRotation(double yaw_deg, double pitch_deg, double roll_deg) {
  return AngleAxisd(RadiansFromDegrees(yaw_deg), Vector3d::UnitZ()) *
         AngleAxisd(RadiansFromDegrees(pitch_deg), Vector3d::UnitY()) *
         AngleAxisd(RadiansFromDegrees(roll_deg), Vector3d::UnitX());
}

Attitude SensorAttitude(const Quaterniond& ned_from_sensor) {
  Matrix3d enu_from_ned;
  enu_from_ned << 0, 1, 0,  //
      1, 0, 0,              //
      0, 0, -1;
  Matrix3d sensor_from_camera;    // x: right, y: down, z: forward
  sensor_from_camera << 0, 0, 1,  //
      1, 0, 0,                    //
      0, 1, 0;
  const Matrix3d enu_from_camera = enu_from_ned * ned_from_sensor.toRotationMatrix() * sensor_from_camera;
  return AttitudeFromRotation(Quaterniond(Matrix3d(enu_from_camera.transpose())));
}

std::optional<Attitude> AttitudeFromSt0601(const KlvPacket& packet) {
  const auto heading = packet.Number(kHeading);
  const auto pitch = FirstValue(packet.Number(kPitchFull), packet.Number(kPitch));
  const auto roll = FirstValue(packet.Number(kRollFull), packet.Number(kRoll));
  const auto azimuth = packet.Number(kRelativeAzimuth);
  const auto elevation = packet.Number(kRelativeElevation);
  if (!heading || !pitch || !roll || !azimuth || !elevation) return std::nullopt;
  return SensorAttitude(BodyRotation(*heading, *pitch, *roll) *
                        BodyRotation(*azimuth, *elevation, packet.Number(kRelativeRoll).value_or(0)));
}

// In the standard the obliquity goes from backward over forward (180) to straight down (270). Known producers write the
// elevation above the horizon instead.
std::optional<double> ElevationFromObliquity(const std::optional<double>& obliquity_deg) {
  if (!obliquity_deg) return std::nullopt;
  const double elevation_deg = *obliquity_deg > 90 ? 180 - *obliquity_deg : *obliquity_deg;
  return std::abs(elevation_deg) <= 90 ? std::optional(elevation_deg) : std::nullopt;
}

std::optional<Attitude> AttitudeFromEg0104(const KlvPacket& packet) {
  const auto azimuth = FindNumber(packet, eg0104::kAngleToNorth);
  const auto elevation = ElevationFromObliquity(FindNumber(packet, eg0104::kObliquityAngle));
  if (!azimuth || !elevation) return std::nullopt;
  return SensorAttitude(BodyRotation(*azimuth, *elevation, FindNumber(packet, eg0104::kSensorRoll).value_or(0)));
}

struct GeodeticFix {
  GeodeticPoint place;
  VerticalDatum datum;
};

std::optional<GeodeticFix> MakeFix(const std::optional<double>& latitude_deg,
                                   const std::optional<double>& longitude_deg, const std::optional<Height>& height) {
  if (!latitude_deg || !longitude_deg || !height) return std::nullopt;
  if (!(std::abs(*latitude_deg) <= 90 && std::abs(*longitude_deg) <= 180)) return std::nullopt;
  if (*latitude_deg == 0 && *longitude_deg == 0)
    return std::nullopt;  // GPS receivers write 0, 0 before their first fix
  return GeodeticFix{{RadiansFromDegrees(*latitude_deg), RadiansFromDegrees(*longitude_deg), height->altitude_m},
                     height->datum};
}

// The camera metadata of a packet of either standard; empty where absent.
struct CameraMetadata {
  std::optional<GeodeticFix> camera;
  std::optional<Attitude> attitude;
  std::optional<double> hfov_deg;
  std::optional<GeodeticFix> frame_centre;
};

CameraMetadata ReadSt0601Metadata(const KlvPacket& packet) {
  const auto ellipsoid =
      FirstValue(packet.Number(kSensorEllipsoidHeightExtended), packet.Number(kSensorEllipsoidHeight));
  return {.camera = MakeFix(packet.Number(kSensorLatitude), packet.Number(kSensorLongitude),
                            SelectHeight(ellipsoid, packet.Number(kSensorTrueAltitude))),
          .attitude = AttitudeFromSt0601(packet),
          .hfov_deg = packet.Number(kHorizontalFieldOfView),
          .frame_centre =
              MakeFix(packet.Number(kFrameCentreLatitude), packet.Number(kFrameCentreLongitude),
                      SelectHeight(packet.Number(kFrameCentreEllipsoidHeight), packet.Number(kFrameCentreElevation)))};
}

CameraMetadata ReadEg0104Metadata(const KlvPacket& packet) {
  return {.camera = MakeFix(FindNumber(packet, eg0104::kLatitude), FindNumber(packet, eg0104::kLongitude),
                            SelectHeight(std::nullopt, FindNumber(packet, eg0104::kAltitude))),
          .attitude = AttitudeFromEg0104(packet),
          .hfov_deg = FindNumber(packet, eg0104::kHorizontalFieldOfView),
          .frame_centre = MakeFix(FindNumber(packet, eg0104::kFrameCenterLatitude),
                                  FindNumber(packet, eg0104::kFrameCenterLongitude),
                                  SelectHeight(std::nullopt, FindNumber(packet, eg0104::kFrameCenterElevation)))};
}

CameraMetadata ReadMetadata(const KlvPacket& packet) {
  if (packet.checksum && !packet.checksum->IsValid()) return {};
  if (packet.standard == KlvStandard::kSt0601) return ReadSt0601Metadata(packet);
  if (packet.standard == KlvStandard::kEg0104) return ReadEg0104Metadata(packet);
  return {};
}

}  // namespace

std::optional<CameraState> CameraFromKlv(const KlvPacket& packet) {
  const CameraMetadata metadata = ReadMetadata(packet);
  if (!metadata.camera || !metadata.attitude) return std::nullopt;
  CameraState state;
  state.time_s = packet.time_s.value_or(0);
  state.place = metadata.camera->place;
  state.datum = metadata.camera->datum;
  state.attitude = metadata.attitude;
  if (metadata.hfov_deg && *metadata.hfov_deg > 0 && *metadata.hfov_deg < 180) {
    state.hfov_rad = RadiansFromDegrees(*metadata.hfov_deg);
  }
  state.utc_us = UtcTime(packet);
  if (packet.moved_m > kUsualPosition_m) state.sigma_position_m = std::hypot(kUsualPosition_m, packet.moved_m);
  if (packet.turned_deg > kUsualAttitude_deg) {
    state.sigma_attitude_rad = RadiansFromDegrees(std::hypot(kUsualAttitude_deg, packet.turned_deg));
  }
  return state;
}

std::vector<std::string_view> FindMissingCameraItems(std::span<const KlvPacket> packets) {
  struct RequiredItem {
    std::string_view description;
    std::vector<int> numbers;  // one of them suffices
  };
  const std::vector<RequiredItem> required = {
      {"the sensor's latitude and longitude (items 13, 14)", {kSensorLatitude}},
      {"the sensor's height (item 15, 75 or 104)",
       {kSensorTrueAltitude, kSensorEllipsoidHeight, kSensorEllipsoidHeightExtended}},
      {"the platform's heading (item 5)", {kHeading}},
      {"the platform's pitch (item 6 or 90)", {kPitch, kPitchFull}},
      {"the platform's roll (item 7 or 91)", {kRoll, kRollFull}},
      {"the sensor's azimuth (item 18)", {kRelativeAzimuth}},
      {"the sensor's elevation (item 19)", {kRelativeElevation}},
  };
  std::vector<std::string_view> missing;
  for (const RequiredItem& item : required) {
    const auto has_item = [&](const KlvPacket& packet) {
      return std::ranges::any_of(item.numbers, [&](int number) { return packet.Number(number).has_value(); });
    };
    if (std::ranges::none_of(packets, has_item)) missing.push_back(item.description);
  }
  return missing;
}

std::optional<double> ComputeFrameCentreError(const KlvPacket& packet) {
  const CameraMetadata metadata = ReadMetadata(packet);
  if (!metadata.camera || !metadata.attitude || !metadata.frame_centre) return std::nullopt;
  if (metadata.camera->datum != metadata.frame_centre->datum) return std::nullopt;
  const Vector3d towards = TangentPlane(metadata.camera->place).EnuFromGeodetic(metadata.frame_centre->place);
  const Vector3d seen = CameraFromEnu(*metadata.attitude) * towards;
  return std::atan2(seen.head<2>().norm(), seen.z());
}

}  // namespace victorious
