// IndexStore on a SQL database: what SQLite and PostgreSQL do by the same statements. SqliteStore and PostgresStore add
// what differs.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/store/index_store.h"
#include "victorious/store/sql/database.h"

namespace victorious::sql {

/// More than 30 methods: those of IndexStore. What they share is in functions of the files.
class SqlIndexStore : public IndexStore {
 public:
  [[nodiscard]] Expected<VideoRecord> PutVideo(const VideoRecord& video) override;
  [[nodiscard]] Status DeleteVideo(std::int64_t video) override;
  [[nodiscard]] Status DeleteModel(std::int64_t model) override;
  [[nodiscard]] Expected<std::int64_t> DeleteOtherContent(const std::string& name, const std::string& folder,
                                                          const std::string& content_id) override;
  [[nodiscard]] Status SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) override;
  [[nodiscard]] Status PutShownGround(std::int64_t video, std::span<const GeoBox> boxes) override;
  [[nodiscard]] Status SetVideoFeatures(std::int64_t video, const std::string& features_json) override;
  [[nodiscard]] Expected<std::vector<VideoRecord>> Videos() override;
  [[nodiscard]] Expected<std::optional<VideoRecord>> VideoOfContent(const std::string& content_id) override;
  [[nodiscard]] Expected<std::vector<VideoRecord>> VideosNamed(const std::string& name) override;

  [[nodiscard]] Expected<ModelRecord> PutModel(const ModelRecord& model) override;
  [[nodiscard]] Expected<std::vector<ModelRecord>> Models() override;

  [[nodiscard]] Expected<std::optional<SearchRecord>> FindSearch(std::int64_t video, std::int64_t model) override;
  [[nodiscard]] Expected<std::vector<SearchRecord>> Searches() override;
  [[nodiscard]] Expected<std::vector<SearchPart>> SearchParts(std::int64_t video) override;
  [[nodiscard]] Status DeleteSearch(std::int64_t video, std::int64_t model) override;
  [[nodiscard]] Status DeleteKeptFrames(std::int64_t video) override;

  [[nodiscard]] Expected<std::vector<std::int64_t>> Commit(const IndexBatch& batch) override;

  [[nodiscard]] Expected<std::vector<CoveredTime>> CoveredTimes(const std::string& source) override;
  [[nodiscard]] Expected<std::vector<TrackletRecord>> Tracklets() override;
  [[nodiscard]] Status PutObjects(std::span<const ObjectRecord> objects) override;
  [[nodiscard]] Expected<std::string> AssociationOptions() override;
  [[nodiscard]] Status PutFits(std::span<const KeptFit> fits) override;
  [[nodiscard]] Status VisitKeptFits(const std::function<bool(KeptFit&&)>& visit) override;
  [[nodiscard]] Expected<std::vector<std::byte>> FindKeptPath(const FitKey& key) override;

  [[nodiscard]] Expected<std::vector<ObjectRecord>> Objects(const SightingFilter& filter) override;
  [[nodiscard]] Status VisitSightings(const SightingFilter& filter,
                                      const std::function<bool(SightingRecord&&)>& visit) override;
  [[nodiscard]] Status VisitKeptFrames(const SightingFilter& filter,
                                       const std::function<bool(KeptFrame&&)>& visit) override;

  [[nodiscard]] Status PutReview(std::int64_t object, const Review& review) override;
  [[nodiscard]] Expected<std::vector<ReviewedObject>> Reviews() override;
  [[nodiscard]] Expected<std::vector<Review>> Decisions(std::int64_t object) override;
  [[nodiscard]] Expected<std::int64_t> PutTrackletGroups(const TrackletGroups& groups) override;
  [[nodiscard]] Status DeleteTrackletGroups(std::int64_t correction, const std::string& author,
                                            std::int64_t made_utc_us) override;
  [[nodiscard]] Expected<std::vector<TrackletLink>> TrackletLinks() override;
  [[nodiscard]] Expected<std::int64_t> ChangeNumber() override;

 protected:
  explicit SqlIndexStore(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  [[nodiscard]] Database& database() { return *database_; }
  /// Another text after each correction of what tracklets are one object.
  [[nodiscard]] Expected<std::string> CorrectionsMark();
  /// Stores an update in one transaction, or in the present one.
  [[nodiscard]] Status WriteUpdate(const ObjectUpdate& update);
  /// Reads every value. `add` is given what each part of it ended with, and returns an error to stop.
  [[nodiscard]] Status ReadEverything(const std::function<Status(const Status&)>& add);

 private:
  /// Reserves ids of new tracklets, so many that follow one another for each video, and puts the first one in the place
  /// of the number. Inside a transaction.
  [[nodiscard]] virtual Status ReserveTrackletIds(std::map<std::int64_t, std::int64_t>& by_video) = 0;
  /// Writes to each object its decisions and its review. Inside a transaction.
  [[nodiscard]] virtual Status AssignAllReviews() = 0;
  /// Likewise, to the objects of these tracklets, whose former reviews stay.
  [[nodiscard]] virtual Status AssignReviewsOf(std::span<const std::int64_t> tracklets) = 0;
  /// Writes to an object the review that follows from its decisions. Inside a transaction.
  [[nodiscard]] virtual Status SummariseDecisions(std::int64_t object) = 0;

  /// Returns the ids, in the order of `updates`.
  [[nodiscard]] Expected<std::vector<std::int64_t>> PutTracklets(
      const std::vector<IndexBatch::TrackletUpdate>& updates);

  std::unique_ptr<Database> database_;
};

/// The error of a statement that had to change one row, and did not: kNotFound.
/// @param name  of the index  @param what, id  of the row
[[nodiscard]] Error MissingRow(std::string_view name, std::string_view what, std::int64_t id);

/// Runs a statement that must change exactly one row. Error: that of MissingRow otherwise.
[[nodiscard]] Status WriteOne(Database& database, const std::string& sql, const ValueList& values,
                              std::string_view what, std::int64_t id);

/// Returns the id of a text of options, which is added if need be. Inside a transaction.
[[nodiscard]] Expected<std::int64_t> PutOptions(Database& database, const std::string& json);

/// From tracklets on, the tables of a query of their first sightings. Aliases: t for the tracklet, v for its video, m
/// for its model, s for the sighting.
[[nodiscard]] std::string FromFirstSightings(Dialect dialect);
/// The tables of a query of reviews with the sightings that they may belong to, from tracklets on. Aliases: t for the
/// tracklet, v for its video, m for its model, r for the review, s for the tracklet's sighting in the review's frame.
[[nodiscard]] std::string FromReviewedTracklets(Dialect dialect);
/// The condition that the review r, or another row with a box, belongs to the sighting s.
[[nodiscard]] std::string IsReviewOfSighting(Dialect dialect);

}  // namespace victorious::sql
