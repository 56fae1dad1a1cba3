// telemetry/: the cameras of common aircraft, whose telemetry gives no field of view, or only the focal length in the
// 35 mm equivalent. The latter is by the diagonal of the sensor, whose aspect ratio differs from that of the video:
//
//   hfov = 2 atan(w tan(fov / 2)),   fov = 2 atan(43.267 mm / (2 f)),   w = width / diagonal of the sensor
//
// w is 0.8 for 4:3 and 0.832 for 3:2. A video of 16:9 shows the whole width of the sensor, unless its mode crops it.
// Source: the makers' data sheets (field of view of photos, by the diagonal).
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace victorious {

struct CameraModel {
  std::string_view aircraft;       ///< "mavic-pro"
  std::string_view code;           ///< the model that its photos name in EXIF: "FC220"
  double diagonal_deg = 0;         ///< field of view by the diagonal of the sensor, unzoomed
  double width_of_diagonal = 0.8;  ///< width of the sensor relative to its diagonal
};

/// All that are known.
[[nodiscard]] std::span<const CameraModel> CameraModels();

/// The model by aircraft or code; case, blanks, hyphens and a maker's "DJI" before it are ignored. Null if unknown.
[[nodiscard]] const CameraModel* FindCameraModel(std::string_view name);

/// The horizontal field of view, rad, of a 35 mm equivalent focal length of an unknown camera: that of 36 mm, which
/// differs from that of sensors of 4:3 by 4 % and is that of 3:2.
[[nodiscard]] double FieldOfViewFromFocal(double focal_35mm_mm);

/// The inverse: the 35 mm equivalent focal length, mm, of a field of view that FieldOfViewFromFocal returned.
[[nodiscard]] double FocalFromFieldOfView(double hfov_rad);

/// The horizontal field of view of a known camera, rad.
/// @param focal_35mm_mm  35 mm equivalent focal length with any zoom; std::nullopt: unzoomed
[[nodiscard]] double FieldOfView(const CameraModel& camera, std::optional<double> focal_35mm_mm);

}  // namespace victorious
