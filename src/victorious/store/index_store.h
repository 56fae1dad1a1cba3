// The store interface of an index. Input: the detections, tracklets and kept features of the search of videos (from
// jobs/). Output: the same records, to be listed, exported and searched again. sqlite/ implements the interface in
// one file, postgres/ in a database on a server.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
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

/// A model or a category that was searched for.
struct ModelRecord {
  std::int64_t id = 0;
  std::string name;
  std::string content_id;  ///< identifies the content: ObjectModel::id, or the id of the category model
  ModelKind kind = ModelKind::kPhotos;

  [[nodiscard]] bool IsCategory() const { return kind == ModelKind::kCategory; }
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

/// The results of an interval of frames. Committed in one transaction.
struct IndexBatch {
  /// A new tracklet (no id), which is an object by itself until PutObjects joins it to another, or an update of an
  /// existing one (its id).
  struct TrackletUpdate {
    std::optional<std::int64_t> id;
    TrackletRecord tracklet;
  };
  /// A sighting of the batch's tracklet with index `tracklet_update`, which gives its tracklet, video and model. A
  /// tracklet has at most one sighting per frame.
  struct NewSighting {
    std::size_t tracklet_update = 0;
    SightingRecord sighting;
  };
  struct Progress {
    SearchRecord search;                   ///< the progress after the batch
    std::int64_t expected_next_frame = 0;  ///< the progress before the batch; refused if another process changed it
  };

  /// Two tracklets of one video and model that are one: the sightings of the second become those of the first.
  struct JoinedTracklets {
    std::int64_t into = 0;
    std::int64_t from = 0;  ///< shares no frame with the first; deleted
  };

  std::vector<JoinedTracklets> joined;  ///< before all else
  std::vector<TrackletUpdate> tracklets;
  std::vector<NewSighting> sightings;
  std::vector<KeptFrame> kept_frames;
  std::vector<Progress> progress;
  /// Added, or put in the place of the one of this kind that begins at the same frame. Never kFailed.
  std::vector<SearchPart> parts;
  std::vector<CoveredTime> covered;  ///< added, or put in the place of the one that begins at the same frame
};

/// A circle around a point of the Earth; heights are ignored.
struct GeoCircle {
  GeodeticPoint centre;
  double radius_m = 0;
};

/// A region between parallels and meridians, radians; it does not cross the antimeridian.
struct GeoBox {
  double south_rad = 0;
  double west_rad = 0;
  double north_rad = 0;
  double east_rad = 0;
};

/// Whether the thresholds of models (threshold_store.h) leave out objects that nobody has decided and that score less.
enum class ThresholdUse { kIgnored, kApplied };

/// The texts of the command line and of the API.
inline constexpr auto kThresholdUseTexts =
    std::to_array<EnumText<ThresholdUse>>({{ThresholdUse::kApplied, "applied"}, {ThresholdUse::kIgnored, "ignored"}});

/// Selects objects or sightings. All conditions that are set must hold.
struct SightingFilter {
  std::optional<std::string> model_name;
  std::optional<std::string> category_name;  ///< includes subcategories: "vehicle" matches "vehicle/car"
  std::optional<std::string> video_name;     ///< see FindVideosByName
  std::optional<double> from_s;          ///< inclusive; an object matches if its time interval overlaps [from_s, to_s]
  std::optional<double> to_s;            ///< inclusive
  std::optional<GeoCircle> near;         ///< only objects of known place, and their sightings
  bool include_rejected = false;         ///< include rejected objects
  std::optional<std::int64_t> object;    ///< the object of this id
  std::optional<std::int64_t> video;     ///< the video of this id, or objects seen in it
  std::optional<std::int64_t> tracklet;  ///< the tracklet of this id, or its object
  ThresholdUse thresholds = ThresholdUse::kIgnored;  ///< kApplied: those in force
};

/// What a person says of an object.
enum class Verdict {
  kAccepted,  ///< it is the object that was searched for
  kRejected,  ///< it is not
};

/// The texts in the index and in the API.
inline constexpr auto kVerdictTexts =
    std::to_array<EnumText<Verdict>>({{Verdict::kAccepted, "accepted"}, {Verdict::kRejected, "rejected"}});

constexpr std::string_view ToText(Verdict verdict) { return ToText(kVerdictTexts, verdict); }

/// The review of an object by one person.
struct Review {
  std::optional<Verdict> verdict;  ///< std::nullopt: undecided
  std::string note;
  std::int64_t updated_utc_us = 0;  ///< microseconds since 1970
  std::string reviewer;             ///< who says so; empty: nobody gave a name

  /// True if it says nothing: the same as no review.
  [[nodiscard]] bool IsEmpty() const { return !verdict && note.empty(); }
};

/// A review with the id that its object has at present.
struct ReviewedObject {
  std::int64_t object = 0;
  Review review;
};

/// Returns the videos whose name equals `name`; if there is none, those whose name is shown so (ShownName), or whose
/// path ends in the path components of `name`: "flight/video.mp4" matches "/data/flight/video.mp4", "deo.mp4" does not.
std::vector<VideoRecord> FindVideosByName(const std::vector<VideoRecord>& videos, std::string_view name);

/// The name as every output shows it: that of a live source without its credentials (base/credentials.h).
[[nodiscard]] std::string ShownName(const VideoRecord& video);

/// Where to open a video: its name; if that is relative, in its folder, from whatever folder the program is started. If
/// it is not in its folder any more, the name alone.
std::string FindVideoFile(const VideoRecord& video);

/// Not thread-safe: use from one thread at a time. Other processes may read while one writes.
class IndexStore {
 public:
  virtual ~IndexStore() = default;

  /// Adds the video. If its content is known, updates the name, and start and telemetry if given. Returns the stored
  /// record.
  [[nodiscard]] virtual Expected<VideoRecord> PutVideo(const VideoRecord& video) = 0;
  /// Deletes the videos of this name and folder with other content (the file was changed). An unknown folder equals
  /// any. Returns their number.
  [[nodiscard]] virtual Expected<std::int64_t> DeleteOtherContent(const std::string& name, const std::string& folder,
                                                                  const std::string& content_id) = 0;
  [[nodiscard]] virtual Status SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) = 0;
  /// Replaces what is known of the ground that the video's camera may have shown: the union of the boxes.
  [[nodiscard]] virtual Status PutShownGround(std::int64_t video, std::span<const GeoBox> boxes) = 0;
  [[nodiscard]] virtual Status SetVideoFeatures(std::int64_t video, const std::string& features_json) = 0;
  [[nodiscard]] virtual Expected<std::vector<VideoRecord>> Videos() = 0;
  [[nodiscard]] virtual Expected<std::optional<VideoRecord>> VideoOfContent(const std::string& content_id) = 0;
  /// Those whose name equals `name`, by id.
  [[nodiscard]] virtual Expected<std::vector<VideoRecord>> VideosNamed(const std::string& name) = 0;

  /// Adds the model, or finds it. A model of the same name with other content replaces the old one; sightings, objects
  /// and progress of the old one are deleted in the same transaction. Returns the stored record.
  [[nodiscard]] virtual Expected<ModelRecord> PutModel(const ModelRecord& model) = 0;
  [[nodiscard]] virtual Expected<std::vector<ModelRecord>> Models() = 0;

  [[nodiscard]] virtual Expected<std::optional<SearchRecord>> FindSearch(std::int64_t video, std::int64_t model) = 0;
  /// Returns all searches, in no order.
  [[nodiscard]] virtual Expected<std::vector<SearchRecord>> Searches() = 0;
  /// Returns the parts of a video that were searched, or left out for a known reason, by model and frame.
  [[nodiscard]] virtual Expected<std::vector<SearchPart>> SearchParts(std::int64_t video) = 0;
  /// Deletes the tracklets and sightings of a model in a video, and the progress of the search.
  [[nodiscard]] virtual Status DeleteSearch(std::int64_t video, std::int64_t model) = 0;
  /// Deletes the kept features of a video.
  [[nodiscard]] virtual Status DeleteKeptFrames(std::int64_t video) = 0;

  /// Writes the batch in one transaction. Returns the ids of batch.tracklets, in their order. Does not overwrite kept
  /// frames, and stores their descriptors with 4 bits an element (docs/formats/index.md). Errors: kConflict if another
  /// process changed the progress; kNotFound for a tracklet, video or model that was deleted; kInvalidArgument for a
  /// sighting that exists already.
  [[nodiscard]] virtual Expected<std::vector<std::int64_t>> Commit(const IndexBatch& batch) = 0;

  /// What was searched of a live source, by time.
  [[nodiscard]] virtual Expected<std::vector<CoveredTime>> CoveredTimes(const std::string& source) = 0;

  /// Returns all tracklets, by id.
  [[nodiscard]] virtual Expected<std::vector<TrackletRecord>> Tracklets() = 0;
  /// In one transaction, assigns the tracklets of these objects to them, and deletes objects without a tracklet. Uses
  /// only id, model, tracklets, place, heading, rejection, `object_score`, `against` and `evidence_json` of
  /// ObjectRecord; ignores tracklets that were deleted.
  /// Writes only what differs from what is stored, for which it reads all objects and the objects of all tracklets.
  [[nodiscard]] virtual Status PutObjects(std::span<const ObjectRecord> objects) = 0;
  /// Stores the objects that `make` computes from the content of the store, as PutObjects does, and the fits that it
  /// keeps, in one transaction; ignores fits of tracklets that were deleted. Of processes that do so at once, the last
  /// one to store has seen what the others had stored before: `make` may be called again. Errors: those of `make`;
  /// kCancelled, or kUnavailable that names who holds it, if another process does not let go of the objects.
  /// @param cancel  does not stop `make` or the storing, only long waiting for another process
  [[nodiscard]] virtual Status UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make,
                                             const CancelToken& cancel) = 0;
  /// Stores fits alone, while `make` of UpdateObjects goes on: one that is killed leaves them to the next. As
  /// ObjectUpdate::put_fits.
  [[nodiscard]] virtual Status PutFits(std::span<const KeptFit> fits) = 0;
  /// Visits the kept fits without their paths, in no order; `visit` returns false to stop.
  [[nodiscard]] virtual Status VisitKeptFits(const std::function<bool(KeptFit&&)>& visit) = 0;
  /// Returns the path of a kept fit; empty if there is none.
  [[nodiscard]] virtual Expected<std::vector<std::byte>> FindKeptPath(const FitKey& key) = 0;

  /// Returns the matching objects, best first: by score, then by number of frames, then by id.
  [[nodiscard]] virtual Expected<std::vector<ObjectRecord>> Objects(const SightingFilter& filter) = 0;
  /// Visits the matching sightings one at a time, by video (in the order they were added), frame, then object. `visit`
  /// returns false to stop.
  [[nodiscard]] virtual Status VisitSightings(const SightingFilter& filter,
                                              const std::function<bool(SightingRecord&&)>& visit) = 0;
  /// Returns all matching sightings; about 300 bytes each.
  [[nodiscard]] Expected<std::vector<SightingRecord>> Sightings(const SightingFilter& filter);
  /// Visits the kept frames one at a time, by video and frame; `visit` returns false to stop. Ignores the filter's
  /// model.
  [[nodiscard]] virtual Status VisitKeptFrames(const SightingFilter& filter,
                                               const std::function<bool(KeptFrame&&)>& visit) = 0;

  /// Replaces the review of an object by Review::reviewer; an empty one deletes it; those of others stay. A review is
  /// stored with the first sighting of each tracklet of the object (video by content, model by name, frame, box), not
  /// with ids: it survives a new search, and follows the object if its tracklets are joined or parted. Error:
  /// kNotFound.
  [[nodiscard]] virtual Status PutReview(std::int64_t object, const Review& review) = 0;
  /// Returns the team's reviews of the present objects, by object id: of all persons' the latest with a verdict, else
  /// the latest. A stored review belongs to the object of its model with a sighting in its frame that overlaps its box
  /// by half or more (intersection over union). Commit and PutObjects assign them; PutObjects at a cost proportional to
  /// the number of reviews.
  [[nodiscard]] virtual Expected<std::vector<ReviewedObject>> Reviews() = 0;
  /// Returns the latest review of each person that belongs to an object, latest first.
  [[nodiscard]] virtual Expected<std::vector<Review>> Decisions(std::int64_t object) = 0;

  /// Reads everything and returns the faults that it finds, one line each: damaged pages, rows that refer to missing
  /// rows, values that cannot be read; empty for a sound index. Cost: that of reading the whole file.
  [[nodiscard]] virtual Expected<std::vector<std::string>> FindFaults() = 0;

  /// Returns a number that changes whenever another connection has changed the index. Cheap.
  [[nodiscard]] virtual Expected<std::int64_t> ChangeNumber() = 0;
};

enum class StoreMode {
  kCreate,  ///< read and write; created if it does not exist
  kRead,    ///< read only; must exist
};

/// Opens a SQLite index. Reading leaves no file behind, and works without write permission. Errors: kNotFound;
/// kDataLoss (not a database, or damaged); kUnsupported (another program's database, or one of a newer version);
/// kPermissionDenied; kNoSpace.
[[nodiscard]] Expected<std::unique_ptr<IndexStore>> OpenSqliteStore(const std::filesystem::path& path, StoreMode mode);

}  // namespace victorious
