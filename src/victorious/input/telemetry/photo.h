// telemetry/: what a drone's photo says about its camera. EXIF gives position, height and focal length, XMP in the
// words of DJI aircraft ("drone-dji:GimbalYawDegree") the gimbal's angles and the height above the take-off.
// Source: Exif 2.32 (CIPA DC-008); XMP part 3; DJI's drone-dji namespace as its photos have it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/geometry/attitude.h"
#include "victorious/input/telemetry/dji_srt.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// The tags of one photo, as stored.
struct PhotoMetadata {
  double time_s = 0;         ///< of its frame; set by the caller
  std::uint32_t width = 0;   ///< px
  std::uint32_t height = 0;  ///< px
  bool is_upright = true;    ///< false: the image is turned before use, and no longer fits the gimbal's angles
  std::optional<double> latitude_deg;
  std::optional<double> longitude_deg;
  std::optional<double> altitude_m;                      ///< above the `altitude_datum`
  VerticalDatum altitude_datum = VerticalDatum::kEgm96;  ///< the ellipsoid for RTK heights
  std::optional<double> above_takeoff_m;
  std::optional<Attitude> attitude;
  std::optional<double> focal_35mm_mm;     ///< 35 mm equivalent focal length
  std::string camera;                      ///< the model, "FC220"
  std::optional<double> sigma_position_m;  ///< of RTK positions
  std::optional<std::int64_t> utc_us;      ///< of the GPS receiver

  [[nodiscard]] bool HasPlace() const { return latitude_deg && longitude_deg; }
};

/// Parses the tags. `head` is a JPEG file up to the image data at least. Accepts any bytes. A position of EXIF without
/// the letters of its hemispheres is none; that of XMP is then used.
/// @return std::nullopt if it is no JPEG, or has neither EXIF nor XMP
[[nodiscard]] std::optional<PhotoMetadata> ReadPhotoMetadata(std::span<const std::byte> head);

/// The camera of a photo; std::nullopt for one without a position, or one that is not upright. The field of view is
/// that of the given camera, else of the one that EXIF names (camera_models.h), else that of the focal length for an
/// uncropped photo.
/// @param camera_model  as TelemetryOptions
[[nodiscard]] std::optional<CameraState> CameraFromPhoto(const PhotoMetadata& photo, DjiHeight height,
                                                         std::string_view camera_model);

}  // namespace victorious
