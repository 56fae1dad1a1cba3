// What an index holds: videos, models, searches, tracklets, objects, sightings. store/ keeps them, place/associate/
// makes objects of tracklets.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/geolocation.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// An indexed video. It is identified by its content; its name is the path given last.
struct VideoRecord {
  std::int64_t id = 0;     ///< assigned by the store
  std::string content_id;  ///< see base/file.h: ContentId
  std::string name;
  std::string folder;  ///< that a relative name is relative to; empty: the name is absolute or a URL, or not known
  int width = 0;       ///< px
  int height = 0;      ///< px
  std::optional<std::int64_t> frame_count;   ///< set once the video was read to its end
  std::optional<double> duration_s;          ///< presentation time of the last frame; set together with frame_count
  std::optional<std::int64_t> start_utc_us;  ///< UTC of the first frame, microseconds since 1970, if telemetry gives it
  bool is_of_photos = false;                 ///< its telemetry is that of photos: the times of its frames are invented
  std::string telemetry;                     ///< path of the telemetry file given last for it; empty: none was given
  std::string features_json;                 ///< the feature options of the kept features; empty: none are kept yet
};

/// The content id of categories that nothing searches for: their objects were boxed by a person and followed
/// (jobs/track/keep_boxes.h).
inline constexpr std::string_view kBoxedContentId = "boxed";

/// A model or a category that was searched for, or a category of what people boxed.
struct ModelRecord {
  std::int64_t id = 0;
  std::string name;
  std::string content_id;  ///< identifies the content: ObjectModel::id, or the id of the category model
  ModelKind kind = ModelKind::kPhotos;

  [[nodiscard]] bool IsCategory() const { return kind == ModelKind::kCategory; }
  [[nodiscard]] bool IsBoxed() const { return IsCategory() && content_id == kBoxedContentId; }
};

/// The progress of the search for one model in one video.
struct SearchRecord {
  std::int64_t video = 0;
  std::int64_t model = 0;
  std::int64_t next_frame = 0;  ///< frames before this one are searched
  bool finished = false;        ///< ended: at the end of the video, or at that of the time that was to be searched
  std::string options_json;     ///< the options of the search
  std::string program_version;
};

/// A tracklet: sightings of one model in one video that were tracked or overlap from frame to frame. Data association
/// joins tracklets to objects.
struct TrackletRecord {
  std::int64_t id = 0;
  std::int64_t object = 0;  ///< the object it belongs to
  std::int64_t video = 0;
  std::int64_t model = 0;
  double score = 0;
  std::int64_t frames = 0;  ///< with a sighting
  double first_time_s = 0;
  double last_time_s = 0;
  std::int64_t revision = 0;  ///< set by the store: changes whenever a batch adds to the tracklet
};

/// An object: one or more tracklets, in one or more videos, joined by data association.
struct ObjectRecord {
  std::int64_t id = 0;  ///< the id of its first tracklet
  std::int64_t model = 0;
  double score = 0;                     ///< `object_score`, without one the maximum over its tracklets
  std::int64_t frames = 0;              ///< with a sighting
  double first_time_s = 0;              ///< of its sightings; presentation time in their own video
  double last_time_s = 0;               ///< likewise
  std::vector<std::int64_t> videos;     ///< ids of the videos that show it, in the order they were added
  std::vector<std::int64_t> tracklets;  ///< ids of its tracklets, ascending
  std::optional<Geolocation> place;
  std::optional<double> heading_rad;  ///< direction of its front, clockwise from north
  std::string rejected;               ///< the reason for its rejection; empty: not rejected
  std::string place_rejected;         ///< the reason why an estimated place was rejected, if that is why it has none
  std::optional<double>
      object_score;                  ///< by all sightings (place/associate/object_score.h); std::nullopt for a category
  std::vector<std::string> against;  ///< what speaks against it, one reason each
  std::string evidence_json;         ///< the numbers behind `object_score`, a JSON object; empty: none are known
};

/// Identifies a kept fit: the first of its tracklets, and a number that its maker computes of all else that it depends
/// on.
struct FitKey {
  std::int64_t tracklet = 0;
  std::int64_t key = 0;

  auto operator<=>(const FitKey&) const = default;
};

/// What data association keeps of one run for the next, in its own bytes (associate/). Deleted with its tracklet.
struct KeptFit {
  FitKey key;
  std::vector<std::byte> fit;
  std::vector<std::byte> path;  ///< a part of it that is read by FindKeptPath() alone; may be empty
};

/// What data association changes.
struct ObjectUpdate {
  std::vector<ObjectRecord> objects;  ///< all of them
  std::vector<KeptFit> put_fits;      ///< added, or replaced; without a path, the stored one stays
  std::vector<FitKey> deleted_fits;
  std::string options_json;  ///< by which they are made, IndexStore::AssociationOptions; empty: the stored text stays
};

/// How a sighting was found.
enum class SightingSource {
  kRecognised,  ///< by a search of the frame
  kTracked,     ///< by the tracker, from a sighting in an earlier or later frame
};

/// The texts in the index and in the exports.
inline constexpr auto kSightingSourceTexts = std::to_array<EnumText<SightingSource>>(
    {{SightingSource::kRecognised, "recognised"}, {SightingSource::kTracked, "tracked"}});

constexpr std::string_view ToText(SightingSource source) { return ToText(kSightingSourceTexts, source); }

/// One object in one frame.
struct SightingRecord {
  std::int64_t object = 0;
  std::int64_t tracklet = 0;
  std::int64_t video = 0;
  std::int64_t model = 0;
  std::int64_t frame = 0;
  double time_s = 0;
  Box box;
  Polygon outline;
  double score = 0;
  SightingSource source = SightingSource::kRecognised;
  bool is_missed = false;  ///< tracked, though a search for its shape did not find it in this frame
  int matches = 0;
  int view_index = 0;                 ///< the best-matching view of the model
  std::optional<ViewDirection> view;  ///< direction of view; estimated between views if the object pose was estimated
  double in_plane_rad = 0;            ///< clockwise rotation from a template at that direction of view to the scene
  std::optional<double> sigma_view_rad;    ///< standard deviation of the direction of view, per axis; std::nullopt:
                                           ///< `view` is the matched view's
  std::optional<double> distance_m;        ///< from the camera; std::nullopt if the field of view is unknown
  std::optional<double> sigma_distance_m;  ///< standard deviation; set together with distance_m
  std::optional<std::int64_t> track;  ///< sightings of one video and model with the same value were tracked: one object
  std::optional<BearingObservation> observation;  ///< set if there is telemetry
};

/// The features of a frame, kept for the search by image.
struct KeptFrame {
  std::int64_t video = 0;
  std::int64_t frame = 0;
  double time_s = 0;
  FeatureSet features;
};

/// A time of a live source whose frames were searched without an interruption. Times are those at which frames come to
/// the machine that searches or records them, microseconds since 1970, UTC.
struct CoveredTime {
  std::int64_t video = 0;
  std::int64_t from_frame = 0;   ///< the first frame; identifies it in the video
  std::string source;            ///< address of the live source
  std::int64_t from_utc_us = 0;  ///< of the first frame
  std::int64_t to_utc_us = 0;    ///< of the last one

  bool operator==(const CoveredTime&) const = default;
};

/// What a search did with a part of a video.
enum class SearchPartKind {
  kSearched,
  kThinned,  ///< to keep a pace, whole frames were searched less often than the options say
  kDamaged,  ///< no frame could be read
  kFailed,   ///< left out: it killed who searched it (CoverageGap)
};

/// The texts in the index and in the API.
inline constexpr auto kSearchPartKindTexts =
    std::to_array<EnumText<SearchPartKind>>({{SearchPartKind::kSearched, "searched"},
                                             {SearchPartKind::kThinned, "thinned"},
                                             {SearchPartKind::kDamaged, "damaged"},
                                             {SearchPartKind::kFailed, "failed"}});

constexpr std::string_view ToText(SearchPartKind kind) { return ToText(kSearchPartKindTexts, kind); }

/// A part of a video as a search for one model went through it. What no part holds was not searched. Deleted with the
/// search.
struct SearchPart {
  std::int64_t video = 0;
  std::int64_t model = 0;
  SearchPartKind kind = SearchPartKind::kSearched;
  std::int64_t from_frame = 0;
  std::int64_t to_frame = 0;  ///< the frame after the last one; kDamaged: from_frame, it has none
  double from_s = 0;          ///< presentation time of the first frame; kDamaged: of the last frame before the part
  double to_s = 0;            ///< of the last frame; kDamaged: of the first one after it, or the end of the video

  bool operator==(const SearchPart&) const = default;
};

}  // namespace victorious
