#include "victorious/store/sqlite/records.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

namespace victorious::sqlite {
namespace {

// The binary columns are the structs as they lie in memory.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Eigen::Vector2d) == 2 * sizeof(double));

int ReadInt(const Statement& row, int column) { return static_cast<int>(row.Integer(column)); }

// A blob as items of T, or an error if they do not fill it.
template <typename T>
Expected<std::vector<T>> ReadItems(std::span<const std::byte> blob, std::string_view column, std::string_view name) {
  if (blob.size() % sizeof(T) != 0) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the index is damaged ({} of {} bytes, expected a multiple of {}): restore it from a "
                            "copy, or index again",
                            name, column, blob.size(), sizeof(T)));
  }
  std::vector<T> items(blob.size() / sizeof(T));
  if (!blob.empty()) std::memcpy(static_cast<void*>(items.data()), blob.data(), blob.size());
  return items;
}

}  // namespace

VideoRecord ReadVideo(const Statement& row) {
  return {.id = row.Integer(0),
          .content_id = row.Text(1),
          .name = row.Text(2),
          .width = ReadInt(row, 3),
          .height = ReadInt(row, 4),
          .frame_count = row.OptionalInteger(5),
          .duration_s = row.OptionalReal(6),
          .features_json = row.Text(7)};
}

ModelRecord ReadModel(const Statement& row) {
  return {.id = row.Integer(0), .name = row.Text(1), .model_id = row.Text(2), .kind = row.Text(3)};
}

ObjectRecord ReadObject(const Statement& row) {
  return {.id = row.Integer(0),
          .video = row.Integer(1),
          .model = row.Integer(2),
          .score = row.Real(3),
          .frames = row.Integer(4),
          .first_time_s = row.Real(5),
          .last_time_s = row.Real(6)};
}

Expected<SightingRecord> ReadSighting(const Statement& row, std::string_view name) {
  SightingRecord sighting{.object = row.Integer(0),
                          .video = row.Integer(1),
                          .model = row.Integer(2),
                          .frame = row.Integer(3),
                          .time_s = row.Real(4),
                          .box = {row.Real(5), row.Real(6), row.Real(7), row.Real(8)},
                          .score = row.Real(10),
                          .source = row.Text(11),
                          .matches = ReadInt(row, 12),
                          .view_index = ReadInt(row, 13),
                          .in_plane_rad = row.Real(16)};
  VICTORIOUS_ASSIGN_OR_RETURN(sighting.outline, ReadItems<Eigen::Vector2d>(row.Blob(9), "an outline", name));
  if (!row.IsNull(14) && !row.IsNull(15)) sighting.view = ViewAngles{row.Real(14), row.Real(15)};
  return sighting;
}

Expected<KeptFrame> ReadKeptFrame(const Statement& row, std::string_view name) {
  KeptFrame kept{.video = row.Integer(0), .frame = row.Integer(1), .time_s = row.Real(2)};
  FeatureSet& features = kept.features;
  features.image_width = ReadInt(row, 3);
  features.image_height = ReadInt(row, 4);
  VICTORIOUS_ASSIGN_OR_RETURN(features.keypoints, ReadItems<Keypoint>(row.Blob(5), "keypoints", name));
  VICTORIOUS_ASSIGN_OR_RETURN(features.descriptors, ReadItems<std::uint8_t>(row.Blob(6), "descriptors", name));
  if (features.descriptors.size() != features.size() * kDescriptorSize) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the index is damaged ({} keypoints with {} bytes of descriptors, expected {} each): "
                            "restore it from a copy, or index again",
                            name, features.size(), features.descriptors.size(), kDescriptorSize));
  }
  const bool has_size = features.keypoints.empty() || (features.image_width > 0 && features.image_height > 0);
  if (!has_size || !std::ranges::all_of(features.keypoints, IsUsable)) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the index is damaged (a kept frame with a keypoint that is no place in an image): "
                            "restore it from a copy, or index again",
                            name));
  }
  return kept;
}

std::span<const std::byte> OutlineBytes(const Polygon& outline) { return std::as_bytes(std::span(outline)); }

}  // namespace victorious::sqlite
