// Conversion between records and rows of a SQL database. docs/formats/index.md describes the tables and their binary
// columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sql/column_list.h"
#include "victorious/store/sql/dialect.h"
#include "victorious/store/sql/row.h"

namespace victorious::sql {

/// Deletes the objects of which nothing is left.
inline constexpr std::string_view kDeleteEmptyObjects =
    "DELETE FROM objects WHERE NOT EXISTS (SELECT 1 FROM tracklets WHERE object_id = objects.id)";

inline constexpr ColumnList kTrackletColumns({"video_id", "model_id", "score", "frames", "first_time_s",
                                              "last_time_s"});

inline constexpr ColumnList kObjectColumns({"id", "model_id", "place_time_s", "latitude_rad", "longitude_rad",
                                            "altitude_m", "covariance_enu_m2", "ce90_m", "le90_m", "velocity_enu_m_s",
                                            "velocity_covariance", "heading_rad", "rejection_reason", "object_score",
                                            "against", "evidence"});

/// Starts a rejection_reason that applies to the place only: the object is not rejected.
inline constexpr std::string_view kPlaceReason = "place: ";

inline constexpr ColumnList kSightingColumns({"video_id",
                                              "frame",
                                              "tracklet_id",
                                              "time_s",
                                              "box_x_px",
                                              "box_y_px",
                                              "box_width_px",
                                              "box_height_px",
                                              "outline",
                                              "score",
                                              "source",
                                              "matches",
                                              "view_index",
                                              "in_plane_rad",
                                              "azimuth_rad",
                                              "off_nadir_rad",
                                              "camera_latitude_rad",
                                              "camera_longitude_rad",
                                              "camera_altitude_m",
                                              "camera_sigma_m",
                                              "camera_sigma_rad",
                                              "bearing_azimuth_rad",
                                              "bearing_elevation_rad",
                                              "bearing_sigma_rad",
                                              "range_m",
                                              "range_sigma_m",
                                              "heading_rad",
                                              "clock_shift",
                                              "focal_shift",
                                              "view_sigma_rad",
                                              "distance_m",
                                              "distance_sigma_m",
                                              "track_id",
                                              "is_missed"});

inline constexpr ColumnList kKeptFrameColumns({"video_id", "frame", "time_s", "image_width_px", "image_height_px",
                                               "keypoints", "descriptors"});

inline constexpr ColumnList kKeptFitColumns({"tracklet_id", "key", "fit", "path"});

// The beginnings of queries, to be followed by conditions. ReadVideo to ReadKeptFrame convert their rows.
std::string SelectVideos();
std::string SelectModels();
std::string SelectTracklets();
/// To be followed by conditions and kGroupObjects. Aliases: o for the object, t for its tracklets.
std::string SelectObjects(Dialect dialect);
inline constexpr std::string_view kGroupObjects = "GROUP BY o.id ORDER BY score DESC, frames DESC, o.id";
/// Aliases: s for the search, o for its options.
std::string SelectSearches();
/// To be followed by conditions and kOrderSearchParts.
std::string SelectSearchParts(Dialect dialect);
inline constexpr std::string_view kOrderSearchParts = "ORDER BY video_id, model_id, from_frame, kind";
/// To be followed by conditions and kOrderSightings. Aliases: s for the sighting, t for its tracklet, o for its object.
std::string SelectSightings();
inline constexpr std::string_view kOrderSightings = "ORDER BY s.video_id, s.frame, s.tracklet_id";
/// To be followed by conditions and kOrderKeptFrames.
std::string SelectKeptFrames();
inline constexpr std::string_view kOrderKeptFrames = "ORDER BY video_id, frame";

/// Binds all parameters of an INSERT of kObjectColumns.
void BindObject(const ObjectRecord& object, Parameters& insert);
/// Binds all parameters of an INSERT of kKeptFitColumns.
void BindKeptFit(const KeptFit& kept, Parameters& insert);
/// Binds all parameters of an INSERT of kSightingColumns.
/// @param video_id, tracklet_id  of the sighting; those in `sighting` are ignored
void BindSighting(const SightingRecord& sighting, std::int64_t video_id, std::int64_t tracklet_id, Parameters& insert);

VideoRecord ReadVideo(const Row& row);
/// Error: kDataLoss for an unknown kind. `name`: the index's, for the message.
[[nodiscard]] Expected<ModelRecord> ReadModel(const Row& row, std::string_view name);
SearchRecord ReadSearch(const Row& row);
TrackletRecord ReadTracklet(const Row& row);
CoveredTime ReadCoveredTime(const Row& row);
/// Error: kDataLoss for an unknown kind. @param name  of the index, for messages
[[nodiscard]] Expected<SearchPart> ReadSearchPart(const Row& row, std::string_view name);
/// Columns: its tracklet, its key, the fit.
KeptFit ReadKeptFit(const Row& row);
/// Error: kDataLoss if a binary column has the wrong size. `name`: the index's, for the message.
[[nodiscard]] Expected<ObjectRecord> ReadObject(const Row& row, std::string_view name);
/// Columns from `first` on: verdict, note, reviewer, time; all NULL: no review. Error: kDataLoss for an unknown
/// verdict.
[[nodiscard]] Expected<Review> ReadReview(const Row& row, int first, std::string_view name);
/// Columns: kObjectColumns, then score, frames, first and last time. Returns the object without its videos and
/// tracklets.
[[nodiscard]] Expected<ObjectRecord> ReadObjectRow(const Row& row, std::string_view name);
/// Error: kDataLoss, as for ReadObject, and for an unknown source.
[[nodiscard]] Expected<SightingRecord> ReadSighting(const Row& row, std::string_view name);
/// Descriptors as stored: 4 bits an element, the lower half of a byte first. Level n of 0 to 15 stands for the value
/// 255 (n / 15)^2: the levels are dense where elements are frequent. An element changes by at most 17 of 255.
inline constexpr std::size_t kPackedDescriptorSize = kDescriptorSize / 2;
std::vector<std::uint8_t> PackDescriptors(std::span<const std::uint8_t> descriptors);
std::vector<std::uint8_t> UnpackDescriptors(std::span<const std::uint8_t> packed);

/// Error: kDataLoss, as for ReadObject, and for an invalid keypoint.
[[nodiscard]] Expected<KeptFrame> ReadKeptFrame(const Row& row, std::string_view name);

}  // namespace victorious::sql
