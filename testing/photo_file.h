// The head of a drone's photo: a JPEG with EXIF and XMP, written byte by byte (TIFF 6.0; Exif 2.32), independent of the
// library that reads them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace victorious::testing {

struct PhotoTags {
  std::string model = "FC6310";
  int orientation = 1;
  int focal_35mm_mm = 24;    ///< 0: none
  double latitude_deg = 48;  ///< 0 together with the longitude: no GPS tags
  double longitude_deg = 11;
  double altitude_m = 560;
  bool has_hemispheres = true;  ///< false: the letters of the hemispheres are missing
  std::string utc_date = {};    ///< "2026:05:27", with a time of 12:34:56
  std::string xmp = {};         ///< the packet; empty: none
};

namespace photo_file {

inline std::string Little(std::uint32_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
  return bytes;
}

struct Entry {
  int tag = 0;
  int type = 0;
  std::uint32_t count = 0;
  std::string value;
};

inline Entry Short(int tag, int value) { return {tag, 3, 1, Little(static_cast<std::uint32_t>(value), 2)}; }
inline Entry Long(int tag, std::size_t value) { return {tag, 4, 1, Little(static_cast<std::uint32_t>(value), 4)}; }
inline Entry Text(int tag, const std::string& text) {
  return {tag, 2, static_cast<std::uint32_t>(text.size() + 1), text + '\0'};
}
inline Entry Rationals(int tag, const std::vector<double>& values) {
  Entry entry{tag, 5, static_cast<std::uint32_t>(values.size()), {}};
  constexpr std::uint32_t kDenominator = 1'000'000;
  for (const double value : values) {
    entry.value += Little(static_cast<std::uint32_t>(value * kDenominator + 0.5), 4) + Little(kDenominator, 4);
  }
  return entry;
}

// A directory that starts at `offset` of the TIFF structure, followed by the values that are too long for it.
inline std::string Directory(const std::vector<Entry>& entries, std::size_t offset) {
  std::string table = Little(static_cast<std::uint32_t>(entries.size()), 2);
  std::string values;
  const std::size_t values_at = offset + 2 + 12 * entries.size() + 4;
  for (const Entry& entry : entries) {
    table += Little(static_cast<std::uint32_t>(entry.tag), 2) + Little(static_cast<std::uint32_t>(entry.type), 2) +
             Little(entry.count, 4);
    if (entry.value.size() <= 4) {
      table += entry.value + std::string(4 - entry.value.size(), '\0');
    } else {
      table += Little(static_cast<std::uint32_t>(values_at + values.size()), 4);
      values += entry.value;
    }
  }
  return table + Little(0, 4) + values;
}

inline std::vector<double> DegreesMinutesSeconds(double degrees) {
  const double minutes = (degrees - static_cast<int>(degrees)) * 60;
  return {static_cast<double>(static_cast<int>(degrees)), static_cast<double>(static_cast<int>(minutes)),
          (minutes - static_cast<int>(minutes)) * 60};
}

inline std::string Segment(char marker, const std::string& payload) {
  const std::size_t size = payload.size() + 2;
  return std::string("\xFF") + marker + static_cast<char>(size >> 8) + static_cast<char>(size & 0xFF) + payload;
}

inline std::string Exif(const PhotoTags& tags) {
  std::vector<Entry> camera;
  if (tags.focal_35mm_mm > 0) camera.push_back(Short(0xA405, tags.focal_35mm_mm));
  std::vector<Entry> gps;
  if (tags.latitude_deg != 0 || tags.longitude_deg != 0) {
    gps = {Text(1, tags.latitude_deg < 0 ? "S" : "N"), Rationals(2, DegreesMinutesSeconds(std::abs(tags.latitude_deg))),
           Text(3, tags.longitude_deg < 0 ? "W" : "E"),
           Rationals(4, DegreesMinutesSeconds(std::abs(tags.longitude_deg))), Rationals(6, {tags.altitude_m})};
    if (!tags.has_hemispheres) std::erase_if(gps, [](const Entry& entry) { return entry.tag == 1 || entry.tag == 3; });
  }
  if (!tags.utc_date.empty()) {
    gps.push_back(Rationals(7, {12, 34, 56}));
    gps.push_back(Text(0x1D, tags.utc_date));
  }
  const auto first = [&](std::size_t camera_at, std::size_t gps_at) {
    return Directory(
        {Text(0x0110, tags.model), Short(0x0112, tags.orientation), Long(0x8769, camera_at), Long(0x8825, gps_at)}, 8);
  };
  const std::size_t camera_at = 8 + first(0, 0).size();
  const std::string camera_directory = Directory(camera, camera_at);
  const std::size_t gps_at = camera_at + camera_directory.size();
  return std::string("Exif\0\0II*\0", 10) + Little(8, 4) + first(camera_at, gps_at) + camera_directory +
         Directory(gps, gps_at);
}

}  // namespace photo_file

/// Inserts the tags into a JPEG file.
inline std::string WithTags(const std::string& jpeg, const PhotoTags& tags) {
  std::string segments = photo_file::Segment('\xE1', photo_file::Exif(tags));
  if (!tags.xmp.empty()) {
    segments += photo_file::Segment('\xE1', std::string("http://ns.adobe.com/xap/1.0/\0", 29) + tags.xmp);
  }
  return jpeg.substr(0, 2) + segments + jpeg.substr(2);
}

/// A JPEG file up to its frame header, which gives the size.
inline std::string PhotoHead(const PhotoTags& tags, int width = 4000, int height = 3000) {
  const auto big = [](int value) {
    return std::string{static_cast<char>(value >> 8), static_cast<char>(value & 0xFF)};
  };
  const std::string frame = std::string("\x08") + big(height) + big(width) + std::string("\1\1\x11\0", 4);
  return WithTags("\xFF\xD8" + photo_file::Segment('\xC0', frame), tags);
}

/// The XMP packet of a DJI aircraft with these gimbal angles, degrees, and heights, metres.
inline std::string DjiXmp(double yaw_deg, double pitch_deg, double absolute_m, double relative_m) {
  return fmt::format(
      "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:Description drone-dji:AbsoluteAltitude=\"{:+.2f}\" "
      "drone-dji:RelativeAltitude=\"{:+.2f}\" drone-dji:GimbalRollDegree=\"+0.00\" "
      "drone-dji:GimbalYawDegree=\"{:+.2f}\" drone-dji:GimbalPitchDegree=\"{:+.2f}\"/></x:xmpmeta>",
      absolute_m, relative_m, yaw_deg, pitch_deg);
}

}  // namespace victorious::testing
