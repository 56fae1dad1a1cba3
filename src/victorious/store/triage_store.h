// What a person who reviews an index asks of it: pages of the list of objects, filtered and sorted, their counts, their
// places on a map. Input: an index (index_store.h writes it). Output: bounded answers, each read by an index of the
// store, so that an archive of 50,000 objects answers in milliseconds.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/store/index_store.h"
#include "victorious/store/threshold_store.h"

namespace victorious {

/// A region of the ground: a simple polygon whose edges are straight in latitude and longitude, at most half the globe
/// wide; it may cross the antimeridian.
struct GeoPolygon {
  std::vector<GeodeticPoint> corners;  ///< at least 3; heights are not read
};

/// A model's name and the least score that is asked of its objects.
struct ModelMinScore {
  std::string model;
  double min_score = 0;
};

/// Selects objects. All conditions that are set must hold. Rejected objects (ObjectRecord::rejected) never match.
struct ObjectQuery {
  /// kNone to kRejected: of the team's review. kOwn: `reviewer` has decided; kNotOwn: `reviewer` has not, whether
  /// others have or not; kDisputed: some accepted it, some rejected it.
  enum class ReviewState { kAny, kNone, kAccepted, kRejected, kOwn, kNotOwn, kDisputed };

  std::vector<std::string> models;              ///< names; empty: all
  std::optional<std::int64_t> video;            ///< seen in this video
  std::optional<double> min_score;              ///< inclusive
  std::vector<ModelMinScore> model_min_scores;  ///< inclusive; asked only of objects without a verdict of the team
  std::optional<double> from_s;                 ///< seen at or after this time
  std::optional<double> to_s;                   ///< seen at or before this time
  std::optional<GeoCircle> near;                ///< only objects of known place
  std::optional<GeoPolygon> area;               ///< only objects of known place
  std::vector<std::string> words;  ///< each is part of the model's name, of the id or of the note; ASCII ignores case
  ReviewState review = ReviewState::kAny;
  std::string reviewer;  ///< for kOwn and kNotOwn

  [[nodiscard]] bool IsEmpty() const;  ///< selects all objects
};

enum class ObjectOrder {
  kRank,    ///< best first: by score, number of frames, id
  kQueue,   ///< what was not reviewed before a time, then what was; each best first
  kNewest,  ///< latest id first
};

/// Where an object stands in an order. Remains usable when the object is gone.
struct ObjectSortKey {
  bool is_done = false;  ///< kQueue: in the second part
  double score = 0;
  std::int64_t frames = 0;
  std::int64_t id = 0;
};

/// A part of the list. `after` and `before` exclude each other and `offset`.
struct ObjectSlice {
  ObjectOrder order = ObjectOrder::kRank;
  std::int64_t queue_utc_us = INT64_MAX;  ///< kQueue: an object reviewed before is in the second part
  std::optional<ObjectSortKey> after;     ///< what follows this position
  std::optional<ObjectSortKey> before;    ///< what precedes it, the nearest first
  std::int64_t offset = 0;                ///< rows to leave out; cost grows with it, in index entries only
  std::int64_t limit = 100;
};

/// An object as listed.
struct TriageObject {
  ObjectRecord object;                  ///< `videos` and `tracklets` are empty: see `moments`
  Review review;                        ///< the team's (IndexStore::Reviews)
  std::vector<Review> decisions;        ///< of persons: the kMaxDecisions latest, latest first
  bool is_disputed = false;             ///< persons disagree about its verdict
  std::vector<TrackletRecord> moments;  ///< its tracklets, by video and time

  static constexpr int kMaxDecisions = 10;
};

/// Numbers of the objects that match a query.
struct ObjectCounts {
  static constexpr int kBins = 100;

  std::int64_t objects = 0;
  std::int64_t accepted = 0;
  std::int64_t rejected = 0;
  std::array<std::int64_t, kBins> scores{};  ///< objects with a score in [i, i + 1) hundredths; 1 is in the last
  std::array<std::int64_t, kBins> accepted_scores{};  ///< the accepted ones of them
  std::array<std::int64_t, kBins> rejected_scores{};  ///< the rejected ones of them
};

/// An object on a map.
struct PlacedObject {
  std::int64_t id = 0;
  std::int64_t model = 0;
  double score = 0;
  double latitude_rad = 0;
  double longitude_rad = 0;
  std::optional<Verdict> verdict;
  bool matches = true;  ///< the query of the call
};

/// A square of the world in Web Mercator (geometry/web_mercator.h), in equal cells.
struct MapGrid {
  double west = 0;   ///< 0 to 1
  double north = 0;  ///< likewise
  double side = 1;   ///< likewise
  int cells = 1;     ///< on a side
};

/// The objects in a cell of a grid.
struct PlaceCell {
  int column = 0;  ///< from the west
  int row = 0;     ///< from the north
  std::int64_t count = 0;
  std::int64_t matches = 0;  ///< that match the query of the call
  double sum_x = 0;          ///< of their positions in the grid, whose sides are 1 long, from its north-western corner
  double sum_y = 0;
  double best = 0;  ///< score
};

/// What a map draws of an object besides its point.
struct PlacedShape {
  std::int64_t id = 0;
  Geolocation place;
  std::optional<double> heading_rad;  ///< of its front, clockwise from north
};

/// Objects of each video and each model, without rejected ones.
struct ObjectNumbers {
  std::int64_t id = 0;  ///< of the video or model
  std::int64_t objects = 0;
};

/// Reads an index. Not thread-safe: use from one thread at a time.
class TriageStore {
 public:
  virtual ~TriageStore() = default;

  /// Runs `read`: what it reads of this store is the index as it is at one moment, while others write. Error: that of
  /// `read`, or of the store.
  [[nodiscard]] virtual Status AtOneMoment(const std::function<Status()>& read) = 0;

  /// By id.
  [[nodiscard]] virtual Expected<std::vector<VideoRecord>> Videos() = 0;
  /// By id.
  [[nodiscard]] virtual Expected<std::vector<ModelRecord>> Models() = 0;

  [[nodiscard]] virtual Expected<std::vector<TriageObject>> Objects(const ObjectQuery& query,
                                                                    const ObjectSlice& slice) = 0;
  /// Returns these objects, by id; without those that are not in the index or rejected. At most 1000 ids.
  [[nodiscard]] virtual Expected<std::vector<TriageObject>> ObjectsById(std::span<const std::int64_t> ids) = 0;
  /// The key of an object in the orders of `slice`; std::nullopt if it is not in the index.
  [[nodiscard]] virtual Expected<std::optional<ObjectSortKey>> FindKey(std::int64_t object,
                                                                       const ObjectSlice& slice) = 0;
  /// The number of objects that match and precede a key.
  [[nodiscard]] virtual Expected<std::int64_t> CountBefore(const ObjectQuery& query, const ObjectSlice& slice,
                                                           const ObjectSortKey& key) = 0;
  [[nodiscard]] virtual Expected<std::int64_t> CountObjects(const ObjectQuery& query) = 0;
  [[nodiscard]] virtual Expected<ObjectCounts> Count(const ObjectQuery& query) = 0;

  /// Visits the objects of known place in a region; `matches` says which of them match the query. `visit` returns false
  /// to stop.
  [[nodiscard]] virtual Status VisitPlaces(const GeoBox& region, const ObjectQuery& query,
                                           const std::function<bool(const PlacedObject&)>& visit) = 0;
  /// Sums the objects of known place in a grid; without empty cells, by row, then column. Takes a third of the time of
  /// visiting them in a database, which would send each.
  [[nodiscard]] virtual Expected<std::vector<PlaceCell>> SumPlaces(const MapGrid& grid, const ObjectQuery& query) = 0;
  /// Returns the shapes of these objects, by id; without those that have no place. At most 1000 ids.
  [[nodiscard]] virtual Expected<std::vector<PlacedShape>> PlaceShapes(std::span<const std::int64_t> ids) = 0;
  /// The smallest region that holds all objects of known place; std::nullopt if there is none.
  [[nodiscard]] virtual Expected<std::optional<GeoBox>> PlaceBounds() = 0;
  /// The videos whose camera may have shown a place of the ground (IndexStore::PutShownGround), and those of which
  /// that is not known; by id. Cost: the boxes of half of the videos are compared, in an index.
  [[nodiscard]] virtual Expected<std::vector<std::int64_t>> VideosShowing(double latitude_rad,
                                                                          double longitude_rad) = 0;
  /// Heights above the ellipsoid of at most 1000 objects of known place that a video shows, metres.
  [[nodiscard]] virtual Expected<std::vector<double>> PlaceHeights(std::int64_t video) = 0;

  /// The sighting of an object with most matches, of equal ones the one with the best score.
  [[nodiscard]] virtual Expected<std::optional<SightingRecord>> BestSighting(std::int64_t object) = 0;

  [[nodiscard]] virtual Expected<std::vector<ObjectNumbers>> ObjectsOfVideos() = 0;
  [[nodiscard]] virtual Expected<std::vector<ObjectNumbers>> ObjectsOfModels() = 0;
  /// All searches, by video and model; without their options.
  [[nodiscard]] virtual Expected<std::vector<SearchRecord>> Searches() = 0;
  /// IndexStore::SearchParts of all videos, by video, model and frame.
  [[nodiscard]] virtual Expected<std::vector<SearchPart>> SearchParts() = 0;
};

/// Opens the index that OpenStore opens under this name, for reading. Errors: those of OpenStore.
[[nodiscard]] Expected<std::unique_ptr<TriageStore>> OpenTriageStore(const std::string& name);

/// What one request reads of an index. Use all of it from one thread at a time.
struct IndexReader {
  std::unique_ptr<IndexStore> sightings;
  std::unique_ptr<TriageStore> objects;
  std::unique_ptr<ThresholdStore> thresholds;
};

/// Opens them; of a database they share one connection, on which no statement runs longer than 30 s. Errors: those of
/// OpenStore.
[[nodiscard]] Expected<IndexReader> OpenIndexReader(const std::string& name);

}  // namespace victorious
