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
    "SELECT v.id, v.content_id, v.name, v.width_px, v.height_px, v.frame_count, v.duration_s, coalesce(o.json, '') "
    "FROM videos v LEFT JOIN options o ON o.id = v.features_options ";
inline constexpr std::string_view kSelectModels = "SELECT id, name, model_id, kind FROM models ";
inline constexpr std::string_view kSelectObjects =
    "SELECT id, video, model, score, frames, first_time_s, last_time_s FROM objects ";
inline constexpr std::string_view kSelectSightings =
    "SELECT s.object, s.video, o.model, s.frame, s.time_s, s.box_x_px, s.box_y_px, s.box_width_px, s.box_height_px, "
    "s.outline, s.score, s.source, s.matches, s.view_index, s.azimuth_rad, s.off_nadir_rad, s.in_plane_rad "
    "FROM sightings s JOIN objects o ON o.id = s.object ";
inline constexpr std::string_view kSelectKeptFrames =
    "SELECT video, frame, time_s, image_width_px, image_height_px, keypoints, descriptors FROM frame_features ";

VideoRecord ReadVideo(const Statement& row);
ModelRecord ReadModel(const Statement& row);
ObjectRecord ReadObject(const Statement& row);
/// kDataLoss where a binary column has not the size it must have. `name`: the file's, for the message.
Expected<SightingRecord> ReadSighting(const Statement& row, std::string_view name);
Expected<KeptFrame> ReadKeptFrame(const Statement& row, std::string_view name);

/// Little-endian doubles x, y, x, y, ….
std::span<const std::byte> OutlineBytes(const Polygon& outline);

}  // namespace victorious::sqlite
