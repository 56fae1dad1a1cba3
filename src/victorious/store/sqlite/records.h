// Conversion between records and SQLite rows. Columns are read in the order of the SELECT texts below.
// docs/formats/index.md describes the binary columns.
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
inline constexpr std::string_view kSelectTracklets =
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
TrackletRecord ReadTracklet(const Statement& row);
/// Error: kDataLoss, as for ReadSighting. `name`: the file's, for the message.
Expected<ObjectRecord> ReadObject(const Statement& row, std::string_view name);
/// Error: kDataLoss if a binary column has the wrong size. `name`: the file's, for the message.
Expected<SightingRecord> ReadSighting(const Statement& row, std::string_view name);
/// Error: kDataLoss, as for ReadSighting, and for an invalid keypoint.
Expected<KeptFrame> ReadKeptFrame(const Statement& row, std::string_view name);

/// The elements of a vector or of a symmetric matrix as little-endian doubles. Points into `numbers`.
template <typename Matrix>
std::span<const std::byte> NumberBytes(const Matrix& numbers) {
  return std::as_bytes(std::span(numbers.data(), static_cast<std::size_t>(numbers.size())));
}

/// Little-endian doubles x, y, x, y, …. Points into `outline`.
std::span<const std::byte> OutlineBytes(const Polygon& outline);

}  // namespace victorious::sqlite
