#include "victorious/store/sql/records.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/text.h"

namespace victorious::sql {
namespace {

// The binary columns have the memory layout of the structs.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Eigen::Vector2d) == 2 * sizeof(double));

int ReadInt(const Row& row, int column) { return static_cast<int>(row.Integer(column)); }

// Converts a blob to items of T; an error if its size is not a multiple of the item's.
template <typename T>
Expected<std::vector<T>> ReadItems(std::span<const std::byte> blob, std::string_view column, std::string_view name) {
  if (blob.size() % sizeof(T) != 0) {
    return std::unexpected(
        DamagedIndex(name, fmt::format("{} of {} bytes, expected a multiple of {}", column, blob.size(), sizeof(T))));
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
    return std::unexpected(DamagedIndex(name, fmt::format("{} of {} numbers, expected {}", column, numbers.size(),
                                                          static_cast<int>(Matrix::SizeAtCompileTime))));
  }
  return Matrix(numbers.data());
}

// Parses a list of ids ("3,1,3") to unique ids in ascending order.
Expected<std::vector<std::int64_t>> ReadIds(std::string_view list, std::string_view name) {
  std::vector<std::int64_t> ids;
  if (list.empty()) return ids;
  for (const std::string& text : SplitRow(list)) {
    const auto id = ParseInteger(text);
    if (!id) return std::unexpected(DamagedIndex(name, fmt::format("a list of ids with \"{}\"", text)));
    ids.push_back(*id);
  }
  std::ranges::sort(ids);
  const auto repeated = std::ranges::unique(ids);
  ids.erase(repeated.begin(), repeated.end());
  return ids;
}

// The elements of a vector or of a symmetric matrix as little-endian doubles. Points into `numbers`.
template <typename Matrix>
std::span<const std::byte> NumberBytes(const Matrix& numbers) {
  return std::as_bytes(std::span(numbers.data(), static_cast<std::size_t>(numbers.size())));
}

constexpr unsigned kMaxLevel = 15;  // of an element of a packed descriptor: 4 bits

constexpr const auto& kObject = kObjectColumns;
constexpr const auto& kSighting = kSightingColumns;

Expected<Geolocation> ReadPlace(const Row& row, std::string_view name) {
  Geolocation place{.point = {row.Real(kObject.Index("latitude_rad")), row.Real(kObject.Index("longitude_rad")),
                              row.Real(kObject.Index("altitude_m"))},
                    .time_s = row.Real(kObject.Index("place_time_s"))};
  VICTORIOUS_ASSIGN_OR_RETURN(
      place.covariance_enu_m2,
      ReadNumbers<Eigen::Matrix3d>(row.Blob(kObject.Index("covariance_enu_m2")), "a covariance", name));
  place.ce90_m = row.Real(kObject.Index("ce90_m"));
  place.le90_m = row.Real(kObject.Index("le90_m"));
  constexpr int kVelocity = kObject.Index("velocity_enu_m_s");
  constexpr int kVelocityCovariance = kObject.Index("velocity_covariance");
  if (row.IsNull(kVelocity) || row.IsNull(kVelocityCovariance)) return place;
  VICTORIOUS_ASSIGN_OR_RETURN(place.velocity_enu,
                              ReadNumbers<Eigen::Vector3d>(row.Blob(kVelocity), "a velocity", name));
  VICTORIOUS_ASSIGN_OR_RETURN(place.velocity_covariance_enu,
                              ReadNumbers<Eigen::Matrix3d>(row.Blob(kVelocityCovariance), "a covariance", name));
  return place;
}

using ClockNumbers = Eigen::Matrix<double, 5, 1>;  // camera east, north, up; azimuth, elevation

Expected<BearingObservation> ReadObservation(const Row& row, double time_s, std::string_view name) {
  BearingObservation observation = {.line = {.time_s = time_s,
                                             .camera = {row.Real(kSighting.Index("camera_latitude_rad")),
                                                        row.Real(kSighting.Index("camera_longitude_rad")),
                                                        row.Real(kSighting.Index("camera_altitude_m"))},
                                             .azimuth_rad = row.Real(kSighting.Index("bearing_azimuth_rad")),
                                             .elevation_rad = row.Real(kSighting.Index("bearing_elevation_rad")),
                                             .range_m = row.OptionalReal(kSighting.Index("range_m")),
                                             .sigma_rad = row.OptionalReal(kSighting.Index("bearing_sigma_rad")),
                                             .sigma_range_m = row.OptionalReal(kSighting.Index("range_sigma_m"))},
                                    .heading_rad = row.OptionalReal(kSighting.Index("heading_rad")),
                                    .sigma_position_m = row.OptionalReal(kSighting.Index("camera_sigma_m")),
                                    .sigma_attitude_rad = row.OptionalReal(kSighting.Index("camera_sigma_rad"))};
  constexpr int kClockShift = kSighting.Index("clock_shift");
  if (!row.IsNull(kClockShift)) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto shift,
                                ReadNumbers<ClockNumbers>(row.Blob(kClockShift), "a shift by the clock", name));
    observation.line.clock_shift =
        ClockShift{.camera_enu_m = shift.head<3>(), .azimuth_rad = shift[3], .elevation_rad = shift[4]};
  }
  constexpr int kFocalShift = kSighting.Index("focal_shift");
  if (!row.IsNull(kFocalShift)) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const auto shift, ReadNumbers<Eigen::Vector3d>(row.Blob(kFocalShift), "a shift by the focal length", name));
    observation.line.focal_shift = FocalShift{.sigma = shift[0], .azimuth_rad = shift[1], .elevation_rad = shift[2]};
  }
  return observation;
}

void BindObservation(const BearingObservation& observation, Parameters& insert) {
  const LineOfSight& line = observation.line;
  insert.BindAt(kSighting.Parameter("camera_latitude_rad"), line.camera.latitude_rad);
  insert.BindAt(kSighting.Parameter("camera_longitude_rad"), line.camera.longitude_rad);
  insert.BindAt(kSighting.Parameter("camera_altitude_m"), line.camera.altitude_m);
  insert.BindAt(kSighting.Parameter("camera_sigma_m"), observation.sigma_position_m);
  insert.BindAt(kSighting.Parameter("camera_sigma_rad"), observation.sigma_attitude_rad);
  insert.BindAt(kSighting.Parameter("bearing_azimuth_rad"), line.azimuth_rad);
  insert.BindAt(kSighting.Parameter("bearing_elevation_rad"), line.elevation_rad);
  insert.BindAt(kSighting.Parameter("bearing_sigma_rad"), line.sigma_rad);
  insert.BindAt(kSighting.Parameter("range_m"), line.range_m);
  insert.BindAt(kSighting.Parameter("range_sigma_m"), line.sigma_range_m);
  insert.BindAt(kSighting.Parameter("heading_rad"), observation.heading_rad);
  if (line.clock_shift) {
    ClockNumbers shift;
    shift << line.clock_shift->camera_enu_m, line.clock_shift->azimuth_rad, line.clock_shift->elevation_rad;
    insert.BindAt(kSighting.Parameter("clock_shift"), NumberBytes(shift));
  }
  if (line.focal_shift) {
    const Eigen::Vector3d shift(line.focal_shift->sigma, line.focal_shift->azimuth_rad,
                                line.focal_shift->elevation_rad);
    insert.BindAt(kSighting.Parameter("focal_shift"), NumberBytes(shift));
  }
}

void BindPlace(const Geolocation& place, Parameters& insert) {
  insert.BindAt(kObject.Parameter("place_time_s"), place.time_s);
  insert.BindAt(kObject.Parameter("latitude_rad"), place.point.latitude_rad);
  insert.BindAt(kObject.Parameter("longitude_rad"), place.point.longitude_rad);
  insert.BindAt(kObject.Parameter("altitude_m"), place.point.altitude_m);
  insert.BindAt(kObject.Parameter("covariance_enu_m2"), NumberBytes(place.covariance_enu_m2));
  insert.BindAt(kObject.Parameter("ce90_m"), place.ce90_m);
  insert.BindAt(kObject.Parameter("le90_m"), place.le90_m);
  if (place.velocity_enu) insert.BindAt(kObject.Parameter("velocity_enu_m_s"), NumberBytes(*place.velocity_enu));
  if (place.velocity_covariance_enu) {
    insert.BindAt(kObject.Parameter("velocity_covariance"), NumberBytes(*place.velocity_covariance_enu));
  }
}

}  // namespace

Error DamagedIndex(std::string_view name, std::string_view fault) {
  return {ErrorCode::kDataLoss,
          fmt::format("{}: the index is damaged ({}): restore it from a copy, or index again", name, fault)};
}

Status CheckSchemaVersion(std::string_view name, std::int64_t version, std::int64_t newest) {
  if (version > newest) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: written by a newer version (schema {}; this program reads up to {}): use that version",
                            name, version, newest));
  }
  if (version < 1) {
    return std::unexpected(DamagedIndex(name, fmt::format("schema {}, expected 1 to {}", version, newest)));
  }
  return {};
}

std::string SelectVideos() {
  return "SELECT v.id, v.content_id, v.name, v.width_px, v.height_px, v.frame_count, v.duration_s, "
         "coalesce(o.json, ''), v.start_utc_us, v.folder, v.is_of_photos, v.telemetry FROM videos v LEFT JOIN options "
         "o ON o.id = "
         "v.features_options_id ";
}

std::string SelectModels() { return "SELECT id, name, content_id, kind FROM models "; }

std::string SelectTracklets() {
  return "SELECT " + kTrackletColumns.Names() + ", id, object_id, revision FROM tracklets ";
}

std::string SelectObjects(Dialect dialect) {
  return fmt::format(
      "SELECT {}, coalesce(o.object_score, max(t.score)) AS score, CAST(sum(t.frames) AS bigint) AS frames, "
      "min(t.first_time_s), max(t.last_time_s), {}, {} FROM objects o JOIN tracklets t ON t.object_id = o.id ",
      kObjectColumns.Names("o"), ListOf(dialect, "t.video_id"), ListOf(dialect, "t.id"));
}

std::string SelectSearches() {
  return "SELECT s.video_id, s.model_id, s.next_frame, s.finished, o.json, s.program_version FROM searches s "
         "JOIN options o ON o.id = s.options_id ";
}

std::string SelectSightings() {
  return "SELECT " + kSightingColumns.Names("s") +
         ", t.object_id, t.model_id FROM sightings s JOIN tracklets t ON t.id = s.tracklet_id "
         "JOIN objects o ON o.id = t.object_id ";
}

std::string SelectKeptFrames() { return "SELECT " + kKeptFrameColumns.Names() + " FROM kept_frames "; }

void BindObject(const ObjectRecord& object, Parameters& insert) {
  for (int parameter = 1; parameter <= kObject.Size(); ++parameter) insert.BindAt(parameter, std::nullopt);
  insert.BindAt(kObject.Parameter("id"), object.id);
  insert.BindAt(kObject.Parameter("model_id"), object.model);
  if (object.place) BindPlace(*object.place, insert);
  insert.BindAt(kObject.Parameter("heading_rad"), object.heading_rad);
  const std::string reason = object.rejected.empty() && !object.place_rejected.empty()
                                 ? std::string(kPlaceReason) + object.place_rejected
                                 : object.rejected;
  if (!reason.empty()) insert.BindAt(kObject.Parameter("rejection_reason"), reason);
  insert.BindAt(kObject.Parameter("object_score"), object.object_score);
  if (!object.against.empty())
    insert.BindAt(kObject.Parameter("against"), fmt::format("{}", fmt::join(object.against, "\n")));
  if (!object.evidence_json.empty()) insert.BindAt(kObject.Parameter("evidence"), object.evidence_json);
}

void BindKeptFit(const KeptFit& kept, Parameters& insert) {
  insert.BindAt(kKeptFitColumns.Parameter("tracklet_id"), kept.key.tracklet);
  insert.BindAt(kKeptFitColumns.Parameter("key"), kept.key.key);
  insert.BindAt(kKeptFitColumns.Parameter("fit"), std::span<const std::byte>(kept.fit));
  if (kept.path.empty()) {
    insert.BindAt(kKeptFitColumns.Parameter("path"), std::nullopt);
  } else {
    insert.BindAt(kKeptFitColumns.Parameter("path"), std::span<const std::byte>(kept.path));
  }
}

void BindSighting(const SightingRecord& sighting, std::int64_t video_id, std::int64_t tracklet_id, Parameters& insert) {
  for (int parameter = 1; parameter <= kSighting.Size(); ++parameter) insert.BindAt(parameter, std::nullopt);
  insert.BindAt(kSighting.Parameter("video_id"), video_id);
  insert.BindAt(kSighting.Parameter("frame"), sighting.frame);
  insert.BindAt(kSighting.Parameter("tracklet_id"), tracklet_id);
  insert.BindAt(kSighting.Parameter("time_s"), sighting.time_s);
  insert.BindAt(kSighting.Parameter("box_x_px"), sighting.box.x);
  insert.BindAt(kSighting.Parameter("box_y_px"), sighting.box.y);
  insert.BindAt(kSighting.Parameter("box_width_px"), sighting.box.width);
  insert.BindAt(kSighting.Parameter("box_height_px"), sighting.box.height);
  insert.BindAt(kSighting.Parameter("outline"), std::as_bytes(std::span(sighting.outline)));
  insert.BindAt(kSighting.Parameter("score"), sighting.score);
  insert.BindAt(kSighting.Parameter("source"), ToText(sighting.source));
  insert.BindAt(kSighting.Parameter("matches"), sighting.matches);
  insert.BindAt(kSighting.Parameter("view_index"), sighting.view_index);
  insert.BindAt(kSighting.Parameter("in_plane_rad"), sighting.in_plane_rad);
  if (sighting.view) {
    insert.BindAt(kSighting.Parameter("azimuth_rad"), sighting.view->azimuth_rad);
    insert.BindAt(kSighting.Parameter("off_nadir_rad"), sighting.view->off_nadir_rad);
  }
  if (sighting.observation) BindObservation(*sighting.observation, insert);
  insert.BindAt(kSighting.Parameter("view_sigma_rad"), sighting.sigma_view_rad);
  insert.BindAt(kSighting.Parameter("distance_m"), sighting.distance_m);
  insert.BindAt(kSighting.Parameter("distance_sigma_m"), sighting.sigma_distance_m);
  insert.BindAt(kSighting.Parameter("track_id"), sighting.track);
  insert.BindAt(kSighting.Parameter("is_missed"), std::int64_t{sighting.is_missed});
}

VideoRecord ReadVideo(const Row& row) {
  return {.id = row.Integer(0),
          .content_id = row.Text(1),
          .name = row.Text(2),
          .folder = row.Text(9),
          .width = ReadInt(row, 3),
          .height = ReadInt(row, 4),
          .frame_count = row.OptionalInteger(5),
          .duration_s = row.OptionalReal(6),
          .start_utc_us = row.OptionalInteger(8),
          .is_of_photos = row.Integer(10) != 0,
          .telemetry = row.Text(11),
          .features_json = row.Text(7)};
}

Expected<ModelRecord> ReadModel(const Row& row, std::string_view name) {
  const std::optional<ModelKind> kind = FromText(kModelKindTexts, row.Text(3));
  if (!kind) return std::unexpected(DamagedIndex(name, "a model of an unknown kind"));
  return ModelRecord{.id = row.Integer(0), .name = row.Text(1), .content_id = row.Text(2), .kind = *kind};
}

SearchRecord ReadSearch(const Row& row) {
  return {.video = row.Integer(0),
          .model = row.Integer(1),
          .next_frame = row.Integer(2),
          .finished = row.Integer(3) != 0,
          .options_json = row.Text(4),
          .program_version = row.Text(5)};
}

CoveredTime ReadCoveredTime(const Row& row) {
  return {.video = row.Integer(0),
          .from_frame = row.Integer(1),
          .source = row.Text(2),
          .from_utc_us = row.Integer(3),
          .to_utc_us = row.Integer(4)};
}

// In PostgreSQL, segments that failed are gaps of a search.
std::string SelectSearchParts(Dialect dialect) {
  constexpr std::string_view kSelect = "SELECT video_id, model_id, {}, from_frame, to_frame, from_s, to_s FROM {} ";
  std::string sql = fmt::format(kSelect, "kind", "search_parts");
  if (dialect == Dialect::kSqlite) return sql;
  sql += "UNION ALL " + fmt::format(kSelect, fmt::format("'{}'", ToText(SearchPartKind::kFailed)), "gaps");
  return fmt::format("SELECT * FROM ({}) AS parts ", sql);
}

Expected<SearchPart> ReadSearchPart(const Row& row, std::string_view name) {
  const std::optional<SearchPartKind> kind = FromText(kSearchPartKindTexts, row.Text(2));
  if (!kind) return std::unexpected(DamagedIndex(name, "a part of a search of an unknown kind"));
  return SearchPart{.video = row.Integer(0),
                    .model = row.Integer(1),
                    .kind = *kind,
                    .from_frame = row.Integer(3),
                    .to_frame = row.Integer(4),
                    .from_s = row.Real(5),
                    .to_s = row.Real(6)};
}

TrackletRecord ReadTracklet(const Row& row) {
  constexpr const auto& kTracklet = kTrackletColumns;
  return {.id = row.Integer(kTracklet.Size()),
          .object = row.Integer(kTracklet.Size() + 1),
          .video = row.Integer(kTracklet.Index("video_id")),
          .model = row.Integer(kTracklet.Index("model_id")),
          .score = row.Real(kTracklet.Index("score")),
          .frames = row.Integer(kTracklet.Index("frames")),
          .first_time_s = row.Real(kTracklet.Index("first_time_s")),
          .last_time_s = row.Real(kTracklet.Index("last_time_s")),
          .revision = row.Integer(kTracklet.Size() + 2)};
}

KeptFit ReadKeptFit(const Row& row) {
  KeptFit kept{.key = {.tracklet = row.Integer(0), .key = row.Integer(1)}, .fit = {}, .path = {}};
  const std::span<const std::byte> fit = row.Blob(2);
  kept.fit.assign(fit.begin(), fit.end());
  return kept;
}

Expected<Review> ReadReview(const Row& row, int first, std::string_view name) {
  Review review{.note = row.Text(first + 1), .updated_utc_us = row.Integer(first + 3), .reviewer = row.Text(first + 2)};
  if (row.IsNull(first)) return review;
  const std::string text = row.Text(first);
  review.verdict = FromText(kVerdictTexts, text);
  if (review.verdict) return review;
  return std::unexpected(DamagedIndex(name, fmt::format("a review with the verdict \"{}\"", text)));
}

Expected<ObjectRecord> ReadObject(const Row& row, std::string_view name) {
  constexpr int kTracklets = kObject.Size();  // the aggregates over its tracklets
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectRecord object, ReadObjectRow(row, name));
  VICTORIOUS_ASSIGN_OR_RETURN(object.videos, ReadIds(row.Text(kTracklets + 4), name));
  VICTORIOUS_ASSIGN_OR_RETURN(object.tracklets, ReadIds(row.Text(kTracklets + 5), name));
  return object;
}

Expected<ObjectRecord> ReadObjectRow(const Row& row, std::string_view name) {
  constexpr int kTracklets = kObject.Size();
  ObjectRecord object{.id = row.Integer(kObject.Index("id")),
                      .model = row.Integer(kObject.Index("model_id")),
                      .score = row.Real(kTracklets),
                      .frames = row.Integer(kTracklets + 1),
                      .first_time_s = row.Real(kTracklets + 2),
                      .last_time_s = row.Real(kTracklets + 3),
                      .videos = {},
                      .tracklets = {},
                      .heading_rad = row.OptionalReal(kObject.Index("heading_rad")),
                      .object_score = row.OptionalReal(kObject.Index("object_score"))};
  const std::string reason = row.Text(kObject.Index("rejection_reason"));
  if (reason.starts_with(kPlaceReason)) {
    object.place_rejected = reason.substr(kPlaceReason.size());
  } else {
    object.rejected = reason;
  }
  object.evidence_json = row.Text(kObject.Index("evidence"));
  std::istringstream against(row.Text(kObject.Index("against")));
  for (std::string line; std::getline(against, line);) object.against.push_back(line);
  if (!row.IsNull(kObject.Index("place_time_s"))) {
    VICTORIOUS_ASSIGN_OR_RETURN(object.place, ReadPlace(row, name));
  }
  return object;
}

Expected<SightingRecord> ReadSighting(const Row& row, std::string_view name) {
  SightingRecord sighting{
      .object = row.Integer(kSighting.Size()),
      .tracklet = row.Integer(kSighting.Index("tracklet_id")),
      .video = row.Integer(kSighting.Index("video_id")),
      .model = row.Integer(kSighting.Size() + 1),
      .frame = row.Integer(kSighting.Index("frame")),
      .time_s = row.Real(kSighting.Index("time_s")),
      .box = {row.Real(kSighting.Index("box_x_px")), row.Real(kSighting.Index("box_y_px")),
              row.Real(kSighting.Index("box_width_px")), row.Real(kSighting.Index("box_height_px"))},
      .score = row.Real(kSighting.Index("score")),
      .is_missed = row.Integer(kSighting.Index("is_missed")) != 0,
      .matches = ReadInt(row, kSighting.Index("matches")),
      .view_index = ReadInt(row, kSighting.Index("view_index")),
      .in_plane_rad = row.Real(kSighting.Index("in_plane_rad")),
      .sigma_view_rad = row.OptionalReal(kSighting.Index("view_sigma_rad")),
      .distance_m = row.OptionalReal(kSighting.Index("distance_m")),
      .sigma_distance_m = row.OptionalReal(kSighting.Index("distance_sigma_m")),
      .track = row.OptionalInteger(kSighting.Index("track_id"))};
  VICTORIOUS_ASSIGN_OR_RETURN(sighting.outline,
                              ReadItems<Eigen::Vector2d>(row.Blob(kSighting.Index("outline")), "an outline", name));
  const std::optional<SightingSource> source = FromText(kSightingSourceTexts, row.Text(kSighting.Index("source")));
  if (!source) return std::unexpected(DamagedIndex(name, "a sighting of an unknown source"));
  sighting.source = *source;
  constexpr int kAzimuth = kSighting.Index("azimuth_rad");
  constexpr int kOffNadir = kSighting.Index("off_nadir_rad");
  if (!row.IsNull(kAzimuth) && !row.IsNull(kOffNadir)) sighting.view = {row.Real(kAzimuth), row.Real(kOffNadir)};
  if (!row.IsNull(kSighting.Index("camera_latitude_rad"))) {
    VICTORIOUS_ASSIGN_OR_RETURN(sighting.observation, ReadObservation(row, sighting.time_s, name));
  }
  return sighting;
}

std::vector<std::uint8_t> PackDescriptors(std::span<const std::uint8_t> descriptors) {
  static const auto kLevelOf = [] {
    std::array<std::uint8_t, 256> levels{};
    for (std::size_t value = 0; value < levels.size(); ++value) {
      levels[value] = static_cast<std::uint8_t>(std::lround(kMaxLevel * std::sqrt(static_cast<double>(value) / 255)));
    }
    return levels;
  }();
  std::vector<std::uint8_t> packed(descriptors.size() / 2);
  for (std::size_t i = 0; i < packed.size(); ++i) {
    packed[i] = static_cast<std::uint8_t>(kLevelOf[descriptors[2 * i]] | (kLevelOf[descriptors[2 * i + 1]] << 4));
  }
  return packed;
}

std::vector<std::uint8_t> UnpackDescriptors(std::span<const std::uint8_t> packed) {
  static const auto kValueOf = [] {
    std::array<std::uint8_t, kMaxLevel + 1> values{};
    for (std::size_t level = 0; level < values.size(); ++level) {
      const double root = static_cast<double>(level) / kMaxLevel;
      values[level] = static_cast<std::uint8_t>(std::lround(255 * root * root));
    }
    return values;
  }();
  std::vector<std::uint8_t> descriptors(packed.size() * 2);
  for (std::size_t i = 0; i < packed.size(); ++i) {
    descriptors[2 * i] = kValueOf[packed[i] & kMaxLevel];
    descriptors[2 * i + 1] = kValueOf[packed[i] >> 4];
  }
  return descriptors;
}

Expected<KeptFrame> ReadKeptFrame(const Row& row, std::string_view name) {
  constexpr const auto& kKept = kKeptFrameColumns;
  KeptFrame kept{.video = row.Integer(kKept.Index("video_id")),
                 .frame = row.Integer(kKept.Index("frame")),
                 .time_s = row.Real(kKept.Index("time_s"))};
  FeatureSet& features = kept.features;
  features.image_width = ReadInt(row, kKept.Index("image_width_px"));
  features.image_height = ReadInt(row, kKept.Index("image_height_px"));
  VICTORIOUS_ASSIGN_OR_RETURN(features.keypoints,
                              ReadItems<Keypoint>(row.Blob(kKept.Index("keypoints")), "keypoints", name));
  VICTORIOUS_ASSIGN_OR_RETURN(features.descriptors,
                              ReadItems<std::uint8_t>(row.Blob(kKept.Index("descriptors")), "descriptors", name));
  if (!features.descriptors.empty() && features.descriptors.size() == features.size() * kPackedDescriptorSize) {
    features.descriptors = UnpackDescriptors(features.descriptors);
  }
  if (features.descriptors.size() != features.size() * kDescriptorSize) {
    return std::unexpected(
        DamagedIndex(name, fmt::format("{} keypoints with {} bytes of descriptors, expected {} each", features.size(),
                                       features.descriptors.size(), kDescriptorSize)));
  }
  const bool has_size = features.keypoints.empty() || (features.image_width > 0 && features.image_height > 0);
  if (!has_size || !std::ranges::all_of(features.keypoints, IsUsable)) {
    return std::unexpected(DamagedIndex(name, "a kept frame with an invalid keypoint"));
  }
  return kept;
}

}  // namespace victorious::sql
