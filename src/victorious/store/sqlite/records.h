// The store's records as rows of SQLite: columns read in the order that the SELECT texts here name them, and the
// binary columns, which docs/formats/index.md describes.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

inline constexpr std::string_view kSelectVideos =
    "SELECT v.id, v.content_id, v.name, v.width_px, v.height_px, v.frame_count, v.duration_s, coalesce(o.json, ''), "
    "v.start_utc_us "
    "FROM videos v LEFT JOIN options o ON o.id = v.features_options ";
inline constexpr std::string_view kSelectModels = "SELECT id, name, model_id, kind FROM models ";
inline constexpr std::string_view kSelectRuns =
    "SELECT id, object, video, model, score, frames, first_time_s, last_time_s FROM runs ";
// Followed by conditions, then by kGroupObjects.
inline constexpr std::string_view kSelectObjects =
    "SELECT o.id, o.model, max(r.score) AS score, sum(r.frames) AS frames, min(r.first_time_s), max(r.last_time_s), "
    "group_concat(r.video), group_concat(r.id), o.place_time_s, o.latitude_rad, o.longitude_rad, o.altitude_m, "
    "o.covariance_enu_m2, o.ce90_m, o.le90_m, o.velocity_enu_m_s, o.velocity_covariance, o.heading_rad, "
    "coalesce(o.rejected, '') FROM objects o JOIN runs r ON r.object = o.id ";
inline constexpr std::string_view kGroupObjects = "GROUP BY o.id ORDER BY score DESC, frames DESC, o.id";
inline constexpr std::string_view kSelectSightings =
    "SELECT r.object, s.run, s.video, r.model, s.frame, s.time_s, s.box_x_px, s.box_y_px, s.box_width_px, "
    "s.box_height_px, s.outline, s.score, s.source, s.matches, s.view_index, s.azimuth_rad, s.off_nadir_rad, "
    "s.in_plane_rad, s.camera_latitude_rad, s.camera_longitude_rad, s.camera_altitude_m, s.line_azimuth_rad, "
    "s.line_elevation_rad, s.line_sigma_rad, s.range_m, s.range_sigma_m, s.heading_rad, s.camera_sigma_m, "
    "s.camera_sigma_rad, s.view_sigma_rad, s.distance_m, s.distance_sigma_m, s.track FROM sightings s JOIN runs r ON "
    "r.id = "
    "s.run JOIN objects o ON o.id = r.object ";
inline constexpr std::string_view kSelectKeptFrames =
    "SELECT video, frame, time_s, image_width_px, image_height_px, keypoints, descriptors FROM frame_features ";

VideoRecord ReadVideo(const Statement& row);
ModelRecord ReadModel(const Statement& row);
RunRecord ReadRun(const Statement& row);
/// kDataLoss as ReadSighting.
Expected<ObjectRecord> ReadObject(const Statement& row, std::string_view name);
/// kDataLoss where a binary column has not the size it must have. `name`: the file's, for the message.
Expected<SightingRecord> ReadSighting(const Statement& row, std::string_view name);
Expected<KeptFrame> ReadKeptFrame(const Statement& row, std::string_view name);

/// The rows of a matrix, or a vector: little-endian doubles.
template <typename Matrix>
std::span<const std::byte> NumberBytes(const Matrix& numbers) {
  return std::as_bytes(std::span(numbers.data(), static_cast<std::size_t>(numbers.size())));
}

/// Little-endian doubles x, y, x, y, ….
std::span<const std::byte> OutlineBytes(const Polygon& outline);

}  // namespace victorious::sqlite
