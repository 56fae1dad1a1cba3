// The store interface of an index. Input: the detections, tracklets and kept features of the search of videos (from
// jobs/). Output: the same records, to be listed, exported and searched again. sqlite/ implements the interface in
// one file, postgres/ in a database on a server.
#pragma once

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
#include "victorious/base/error.h"
#include "victorious/types/index_records.h"
#include "victorious/types/review.h"
#include "victorious/types/sighting_filter.h"
#include "victorious/types/tracklet_link.h"

namespace victorious {

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
  /// Deletes a video, or a model, with its searches, tracklets and sightings, with the objects of which nothing is
  /// left, and with what people said of these. Objects that other videos show keep their place until data association
  /// runs. Error: kNotFound.
  [[nodiscard]] virtual Status DeleteVideo(std::int64_t video) = 0;
  [[nodiscard]] virtual Status DeleteModel(std::int64_t model) = 0;
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
  /// The parameters by which the present objects were made (ObjectUpdate::options_json); empty: unknown.
  [[nodiscard]] virtual Expected<std::string> AssociationOptions() = 0;
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

  /// Stores what a person says of the identity of tracklets. As a review it is bound to the first sighting of each. The
  /// objects follow when data association runs. Returns the number of the correction. Error: kNotFound for a tracklet
  /// that is not in the index.
  [[nodiscard]] virtual Expected<std::int64_t> PutTrackletGroups(const TrackletGroups& groups) = 0;
  /// Deletes a correction, as if it had never been said. Error: kNotFound.
  /// @param author, made_utc_us  for the log
  [[nodiscard]] virtual Status DeleteTrackletGroups(std::int64_t correction, const std::string& author,
                                                    std::int64_t made_utc_us) = 0;
  /// What people said of tracklets, in the order in which they said it; of each group only so many pairs that the
  /// others follow. An end belongs to the tracklet of its model whose sighting in its frame overlaps its box most, by
  /// half or more (intersection over union).
  [[nodiscard]] virtual Expected<std::vector<TrackletLink>> TrackletLinks() = 0;

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
