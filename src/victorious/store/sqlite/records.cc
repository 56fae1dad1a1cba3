#include "victorious/store/sqlite/records.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <sstream>

#include <fmt/format.h>

namespace victorious::sqlite {
namespace {

// The binary columns have the memory layout of the structs.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Eigen::Vector2d) == 2 * sizeof(double));

int ReadInt(const Statement& row, int column) { return static_cast<int>(row.Integer(column)); }

// Converts a blob to items of T; an error if its size is not a multiple of the item's.
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

// Reads a vector or a symmetric matrix.
template <typename Matrix>
Expected<Matrix> ReadNumbers(std::span<const std::byte> blob, std::string_view column, std::string_view name) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> numbers, ReadItems<double>(blob, column, name));
  if (numbers.size() != static_cast<std::size_t>(Matrix::SizeAtCompileTime)) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the index is damaged ({} of {} numbers, expected {}): restore it from a copy, or "
                            "index again",
                            name, column, numbers.size(), static_cast<int>(Matrix::SizeAtCompileTime)));
  }
  return Matrix(numbers.data());
}

// Parses the result of group_concat ("3,1,3") to unique ids in ascending order.
std::vector<std::int64_t> ReadIds(const std::string& list) {
  std::vector<std::int64_t> ids;
  std::istringstream text(list);
  for (std::string id; std::getline(text, id, ',');) ids.push_back(std::stoll(id));
  std::ranges::sort(ids);
  const auto repeated = std::ranges::unique(ids);
  ids.erase(repeated.begin(), repeated.end());
  return ids;
}

Expected<Geolocation> ReadPlace(const Statement& row, int first, std::string_view name) {
  Geolocation place{.point = {row.Real(first + 1), row.Real(first + 2), row.Real(first + 3)},
                    .time_s = row.Real(first)};
  VICTORIOUS_ASSIGN_OR_RETURN(place.covariance_enu_m2,
                              ReadNumbers<Eigen::Matrix3d>(row.Blob(first + 4), "a covariance", name));
  place.ce90_m = row.Real(first + 5);
  place.le90_m = row.Real(first + 6);
  if (row.IsNull(first + 7) || row.IsNull(first + 8)) return place;
  VICTORIOUS_ASSIGN_OR_RETURN(place.velocity_enu,
                              ReadNumbers<Eigen::Vector3d>(row.Blob(first + 7), "a velocity", name));
  VICTORIOUS_ASSIGN_OR_RETURN(place.velocity_covariance_enu,
                              ReadNumbers<Eigen::Matrix3d>(row.Blob(first + 8), "a covariance", name));
  return place;
}

BearingObservation ReadSight(const Statement& row, int first, double time_s) {
  return {.line = {.time_s = time_s,
                   .camera = {row.Real(first), row.Real(first + 1), row.Real(first + 2)},
                   .azimuth_rad = row.Real(first + 3),
                   .elevation_rad = row.Real(first + 4),
                   .range_m = row.OptionalReal(first + 6),
                   .sigma_rad = row.OptionalReal(first + 5),
                   .sigma_range_m = row.OptionalReal(first + 7)},
          .heading_rad = row.OptionalReal(first + 8),
          .sigma_position_m = row.OptionalReal(first + 9),
          .sigma_attitude_rad = row.OptionalReal(first + 10)};
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
          .start_utc_us = row.OptionalInteger(8),
          .features_json = row.Text(7)};
}

ModelRecord ReadModel(const Statement& row) {
  return {.id = row.Integer(0), .name = row.Text(1), .model_id = row.Text(2), .kind = row.Text(3)};
}

TrackletRecord ReadTracklet(const Statement& row) {
  return {.id = row.Integer(0),
          .object = row.Integer(1),
          .video = row.Integer(2),
          .model = row.Integer(3),
          .score = row.Real(4),
          .frames = row.Integer(5),
          .first_time_s = row.Real(6),
          .last_time_s = row.Real(7)};
}

Expected<ObjectRecord> ReadObject(const Statement& row, std::string_view name) {
  constexpr int kPlace = 8;
  ObjectRecord object{.id = row.Integer(0),
                      .model = row.Integer(1),
                      .score = row.Real(2),
                      .frames = row.Integer(3),
                      .first_time_s = row.Real(4),
                      .last_time_s = row.Real(5),
                      .videos = ReadIds(row.Text(6)),
                      .tracklets = ReadIds(row.Text(7)),
                      .heading_rad = row.OptionalReal(17),
                      .rejected = row.Text(18)};
  if (!row.IsNull(kPlace)) {
    VICTORIOUS_ASSIGN_OR_RETURN(object.place, ReadPlace(row, kPlace, name));
  }
  return object;
}

Expected<SightingRecord> ReadSighting(const Statement& row, std::string_view name) {
  constexpr int kSight = 18;
  SightingRecord sighting{.object = row.Integer(0),
                          .tracklet = row.Integer(1),
                          .video = row.Integer(2),
                          .model = row.Integer(3),
                          .frame = row.Integer(4),
                          .time_s = row.Real(5),
                          .box = {row.Real(6), row.Real(7), row.Real(8), row.Real(9)},
                          .score = row.Real(11),
                          .source = row.Text(12),
                          .matches = ReadInt(row, 13),
                          .view_index = ReadInt(row, 14),
                          .in_plane_rad = row.Real(17)};
  VICTORIOUS_ASSIGN_OR_RETURN(sighting.outline, ReadItems<Eigen::Vector2d>(row.Blob(10), "an outline", name));
  if (!row.IsNull(15) && !row.IsNull(16)) sighting.view = ViewAngles{row.Real(15), row.Real(16)};
  constexpr int kStance = kSight + 11;
  sighting.sigma_view_rad = row.OptionalReal(kStance);
  sighting.distance_m = row.OptionalReal(kStance + 1);
  sighting.sigma_distance_m = row.OptionalReal(kStance + 2);
  sighting.track = row.OptionalInteger(kStance + 3);
  if (!row.IsNull(kSight)) sighting.observation = ReadSight(row, kSight, sighting.time_s);
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
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: the index is damaged (a kept frame with an invalid keypoint): "
                                                  "restore it from a copy, or index again",
                                                  name));
  }
  return kept;
}

std::span<const std::byte> OutlineBytes(const Polygon& outline) { return std::as_bytes(std::span(outline)); }

}  // namespace victorious::sqlite
