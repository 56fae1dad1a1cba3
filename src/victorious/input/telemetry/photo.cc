#include "victorious/input/telemetry/photo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>
#include <libexif/exif-data.h>

#include "victorious/base/text.h"
#include "victorious/base/utc.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_header.h"
#include "victorious/input/telemetry/camera_models.h"

namespace victorious {
namespace {

// The EXIF tags of a photo, read by libexif.
class Exif {
 public:
  explicit Exif(std::span<const std::byte> bytes) : data_(exif_data_new(), &exif_data_unref) {
    if (!data_ || bytes.empty()) return;
    exif_data_unset_option(data_.get(), EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);  // it would add what is missing
    exif_data_load_data(data_.get(), reinterpret_cast<const unsigned char*>(bytes.data()),
                        static_cast<unsigned int>(bytes.size()));
  }

  [[nodiscard]] std::optional<double> Number(ExifIfd ifd, int tag, std::size_t component = 0) const {
    const ExifEntry* entry = Entry(ifd, tag);
    if (entry == nullptr) return std::nullopt;
    const std::size_t size = exif_format_get_size(entry->format);
    if (component >= entry->components || (component + 1) * size > entry->size) return std::nullopt;
    const unsigned char* at = entry->data + component * size;
    const ExifByteOrder order = exif_data_get_byte_order(data_.get());
    switch (entry->format) {
      case EXIF_FORMAT_BYTE:
        return *at;
      case EXIF_FORMAT_SHORT:
        return exif_get_short(at, order);
      case EXIF_FORMAT_LONG:
        return exif_get_long(at, order);
      case EXIF_FORMAT_RATIONAL: {
        const ExifRational ratio = exif_get_rational(at, order);
        if (ratio.denominator == 0) return std::nullopt;
        return static_cast<double>(ratio.numerator) / ratio.denominator;
      }
      default:
        return std::nullopt;
    }
  }

  [[nodiscard]] std::string Text(ExifIfd ifd, int tag) const {
    const ExifEntry* entry = Entry(ifd, tag);
    if (entry == nullptr || entry->format != EXIF_FORMAT_ASCII) return {};
    const std::string text(reinterpret_cast<const char*>(entry->data), entry->size);
    return std::string(TrimBlanks(std::string_view(text).substr(0, text.find('\0'))));
  }

  // Degrees, minutes and seconds, with the letter of the other hemisphere negative. std::nullopt without a letter: it
  // may be either.
  [[nodiscard]] std::optional<double> Degrees(int tag, int letter_tag, std::string_view positive,
                                              std::string_view negative) const {
    const auto degrees = Number(EXIF_IFD_GPS, tag, 0);
    const std::string letter = Text(EXIF_IFD_GPS, letter_tag);
    if (!degrees || (letter != positive && letter != negative)) return std::nullopt;
    const double size =
        *degrees + Number(EXIF_IFD_GPS, tag, 1).value_or(0) / 60 + Number(EXIF_IFD_GPS, tag, 2).value_or(0) / 3600;
    return letter == negative ? -size : size;
  }

 private:
  [[nodiscard]] const ExifEntry* Entry(ExifIfd ifd, int tag) const {
    const ExifEntry* entry = data_ ? exif_content_get_entry(data_->ifd[ifd], static_cast<ExifTag>(tag)) : nullptr;
    return entry != nullptr && entry->data != nullptr ? entry : nullptr;
  }

  std::unique_ptr<ExifData, void (*)(ExifData*)> data_;
};

// The text of a property of an XMP packet, as an attribute (name="text") or an element (<name>text</name>). Properties
// of cameras have simple texts without entities.
std::string_view XmpText(std::string_view xmp, std::string_view name) {
  for (std::size_t at = xmp.find(name); at != std::string_view::npos; at = xmp.find(name, at + 1)) {
    std::string_view rest = xmp.substr(at + name.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
    if (rest.starts_with('>')) return TrimBlanks(rest.substr(1, rest.find('<', 1) - 1));
    if (!rest.starts_with('=')) continue;
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n", 1), rest.size()));
    if (rest.starts_with('"') || rest.starts_with('\'')) return rest.substr(1, rest.find(rest[0], 1) - 1);
  }
  return {};
}

std::optional<double> XmpNumber(std::string_view xmp, std::string_view name) { return ParseNumber(XmpText(xmp, name)); }

void ReadPlace(const Exif& exif, std::string_view xmp, PhotoMetadata& photo) {
  auto latitude_deg = exif.Degrees(EXIF_TAG_GPS_LATITUDE, EXIF_TAG_GPS_LATITUDE_REF, "N", "S");
  auto longitude_deg = exif.Degrees(EXIF_TAG_GPS_LONGITUDE, EXIF_TAG_GPS_LONGITUDE_REF, "E", "W");
  if (!latitude_deg || !longitude_deg) {
    latitude_deg = XmpNumber(xmp, "drone-dji:GpsLatitude");
    longitude_deg = XmpNumber(xmp, "drone-dji:GpsLongitude");
    if (!longitude_deg) longitude_deg = XmpNumber(xmp, "drone-dji:GpsLongtitude");  // as some aircraft write it
  }
  if (!latitude_deg || !longitude_deg) return;
  if (!(std::abs(*latitude_deg) <= 90 && std::abs(*longitude_deg) <= 180)) return;
  if (*latitude_deg == 0 && *longitude_deg == 0) return;  // no fix
  photo.latitude_deg = latitude_deg;
  photo.longitude_deg = longitude_deg;
}

void ReadHeights(const Exif& exif, std::string_view xmp, PhotoMetadata& photo) {
  photo.above_takeoff_m = XmpNumber(xmp, "drone-dji:RelativeAltitude");
  photo.altitude_m = XmpNumber(xmp, "drone-dji:AbsoluteAltitude");
  if (photo.altitude_m && XmpText(xmp, "drone-dji:AltitudeType") == "RtkAlt") {
    photo.altitude_datum = VerticalDatum::kEllipsoid;
  }
  if (photo.altitude_m) return;
  photo.altitude_m = exif.Number(EXIF_IFD_GPS, EXIF_TAG_GPS_ALTITUDE);
  if (photo.altitude_m && exif.Number(EXIF_IFD_GPS, EXIF_TAG_GPS_ALTITUDE_REF) == 1) *photo.altitude_m *= -1;
}

// The root mean square of the three standard deviations of an RTK position.
std::optional<double> RtkSigma(std::string_view xmp) {
  double sum = 0;
  for (const char* name : {"drone-dji:RtkStdLat", "drone-dji:RtkStdLon", "drone-dji:RtkStdHgt"}) {
    const auto sigma_m = XmpNumber(xmp, name);
    if (!sigma_m || !(*sigma_m > 0)) return std::nullopt;
    sum += *sigma_m * *sigma_m;
  }
  return std::isfinite(sum) ? std::optional(std::sqrt(sum / 3)) : std::nullopt;
}

// The time of the GPS receiver, which is UTC; the camera's own clock has no time zone.
std::optional<std::int64_t> GpsTime(const Exif& exif) {
  std::string date = exif.Text(EXIF_IFD_GPS, EXIF_TAG_GPS_DATE_STAMP);
  std::array<double, 3> clock{};
  for (std::size_t i = 0; i < clock.size(); ++i) {
    const auto part = exif.Number(EXIF_IFD_GPS, EXIF_TAG_GPS_TIME_STAMP, i);
    if (!part || !(*part < 61)) return std::nullopt;
    clock.at(i) = *part;
  }
  std::ranges::replace(date, ':', '-');
  return ParseUtc(fmt::format("{} {:02.0f}:{:02.0f}:{:06.3f}", date, clock[0], clock[1], clock[2]));
}

// The horizontal field of view of a photo as wide as the sensor of `camera`, or a narrower part of its middle.
double FieldOfViewOfPhoto(const CameraModel& camera, std::optional<double> focal_35mm_mm, double aspect) {
  const double sensor_aspect =
      camera.width_of_diagonal / std::sqrt(1 - camera.width_of_diagonal * camera.width_of_diagonal);
  return 2 * std::atan(std::min(1.0, aspect / sensor_aspect) * std::tan(FieldOfView(camera, focal_35mm_mm) / 2));
}

std::optional<double> ReadFieldOfView(const PhotoMetadata& photo, std::string_view camera_model) {
  constexpr double kWidestSensor = 1.52;  // aspect ratio; wider photos are cropped
  const double aspect = static_cast<double>(photo.width) / photo.height;
  const CameraModel* camera = FindCameraModel(camera_model.empty() ? std::string_view(photo.camera) : camera_model);
  if (camera != nullptr) return FieldOfViewOfPhoto(*camera, photo.focal_35mm_mm, aspect);
  if (!photo.focal_35mm_mm) return std::nullopt;
  if (aspect > kWidestSensor) return FieldOfViewFromFocal(*photo.focal_35mm_mm);
  const CameraModel own{.width_of_diagonal = aspect / std::hypot(aspect, 1)};
  return FieldOfView(own, photo.focal_35mm_mm);
}

}  // namespace

std::optional<PhotoMetadata> ReadPhotoMetadata(std::span<const std::byte> head) {
  const auto header = ReadImageHeader(head);
  if (!header || header->width == 0 || header->height == 0) return std::nullopt;
  if (header->exif.empty() && header->xmp.empty()) return std::nullopt;
  const Exif exif(header->exif);
  const std::string_view xmp(reinterpret_cast<const char*>(header->xmp.data()), header->xmp.size());
  PhotoMetadata photo{.width = header->width,
                      .height = header->height,
                      .is_upright = header->orientation == Orientation::kUpright,
                      .camera = exif.Text(EXIF_IFD_0, EXIF_TAG_MODEL)};
  ReadPlace(exif, xmp, photo);
  ReadHeights(exif, xmp, photo);
  photo.attitude =
      AttitudeFromGimbal(XmpNumber(xmp, "drone-dji:GimbalYawDegree"), XmpNumber(xmp, "drone-dji:GimbalPitchDegree"),
                         XmpNumber(xmp, "drone-dji:GimbalRollDegree"));
  const auto focal_mm = exif.Number(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM);
  if (focal_mm && *focal_mm > 0) photo.focal_35mm_mm = focal_mm;
  photo.sigma_position_m = RtkSigma(xmp);
  photo.utc_us = GpsTime(exif);
  return photo;
}

std::optional<CameraState> CameraFromPhoto(const PhotoMetadata& photo, DjiHeight height,
                                           std::string_view camera_model) {
  if (!photo.HasPlace() || !photo.is_upright) return std::nullopt;
  CameraState state{.time_s = photo.time_s, .datum = VerticalDatum::kUnknown};
  state.place = {RadiansFromDegrees(*photo.latitude_deg), RadiansFromDegrees(*photo.longitude_deg), 0};
  if (photo.above_takeoff_m && (height == DjiHeight::kAboveTakeoff || !photo.altitude_m)) {
    state.place.altitude_m = *photo.above_takeoff_m;
    state.datum = VerticalDatum::kTakeoff;
  } else if (photo.altitude_m) {
    state.place.altitude_m = *photo.altitude_m;
    state.datum = photo.altitude_datum;
  }
  state.attitude = photo.attitude;
  state.hfov_rad = ReadFieldOfView(photo, camera_model);
  state.sigma_position_m = photo.sigma_position_m;
  state.utc_us = photo.utc_us;
  return state;
}

}  // namespace victorious
