// IndexStore in a PostgreSQL database with PostGIS.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "victorious/store/index_store.h"
#include "victorious/store/postgres/connection.h"
#include "victorious/store/sql/filter_conditions.h"

namespace victorious::postgres {

/// The advisory lock of UpdateObjects: "OBJS" in ASCII.
inline constexpr std::int64_t kObjectsLockKey = 0x4F424A53;

/// How long UpdateObjects waits for another process that updates objects.
struct ObjectsPatience {
  /// The server ends a session that stands still with the lock for this long.
  std::chrono::milliseconds others = std::chrono::minutes(30);
  std::chrono::milliseconds cancelled = std::chrono::seconds(10);  ///< in all, once cancelled
};

/// Visits return false or end before the store writes: VisitSightings and VisitKeptFrames hold a transaction that
/// reads.
class PostgresStore final : public IndexStore {
 public:
  /// @param connection  of a database with an index of this version
  explicit PostgresStore(std::shared_ptr<Connection> connection, ObjectsPatience patience = {})
      : connection_(std::move(connection)), patience_(patience) {}

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
  [[nodiscard]] Status UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make,
                                     const CancelToken& cancel) override;
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
  /// The faults are those of kDataLoss, and rows without those that they refer to. Errors: others of reading.
  [[nodiscard]] Expected<std::vector<std::string>> FindFaults() override;
  [[nodiscard]] Expected<std::int64_t> ChangeNumber() override;

 private:
  [[nodiscard]] Status DeleteWithObjects(std::string_view statement, const char* what, std::int64_t id);
  /// Returns the id of the text of options. Inside a transaction.
  [[nodiscard]] Expected<std::int64_t> PutOptions(const std::string& json);
  [[nodiscard]] Status PutProgress(const IndexBatch::Progress& progress);
  /// Returns the ids, in the order of `updates`.
  [[nodiscard]] Expected<std::vector<std::int64_t>> PutTracklets(
      const std::vector<IndexBatch::TrackletUpdate>& updates);
  [[nodiscard]] Status PutSightings(const IndexBatch& batch, const std::vector<std::int64_t>& tracklet_ids);
  [[nodiscard]] Status PutKeptFrames(const std::vector<KeptFrame>& frames);
  /// Inside a transaction.
  [[nodiscard]] Status JoinTracklets(const IndexBatch::JoinedTracklets& joined);
  /// Locks the objects of the tracklets that a batch adds to, in the order of their ids, so that two batches that add
  /// to the same objects wait for each other, but not in a circle. Inside a transaction.
  [[nodiscard]] Status LockObjectsOf(const std::vector<IndexBatch::TrackletUpdate>& updates);
  /// Writes to each object its decisions and its review. Inside a transaction.
  [[nodiscard]] Status AssignAllReviews();
  /// Likewise, to the objects of these tracklets, whose former reviews stay.
  [[nodiscard]] Status AssignReviewsOf(std::span<const std::int64_t> tracklets);
  /// PutObjects inside a transaction.
  [[nodiscard]] Status WriteObjects(std::span<const ObjectRecord> objects);
  /// Inside a transaction.
  [[nodiscard]] Status WriteFits(std::span<const KeptFit> fits);
  [[nodiscard]] Status DeleteFits(std::span<const FitKey> fits);
  /// Stores an update in one transaction.
  [[nodiscard]] Status Write(const ObjectUpdate& update);
  /// The number of the server's process for this connection.
  [[nodiscard]] Expected<std::int64_t> Session();
  /// Waits for the lock of UpdateObjects. Returns the session that holds it. Errors: kCancelled, kInternal: another
  /// process has held it for too long.
  [[nodiscard]] Expected<std::int64_t> LockObjects(const CancelToken& cancel);
  /// Says who holds the lock of UpdateObjects, as far as the server tells this role.
  [[nodiscard]] Expected<std::string> DescribeHolder();
  [[nodiscard]] Status UnlockObjects();
  /// The error of a statement that had to change one row, and did not.
  [[nodiscard]] Error Missing(std::string_view what, std::int64_t id) const;

  std::shared_ptr<Connection> connection_;
  ObjectsPatience patience_;
};

}  // namespace victorious::postgres

namespace victorious {

/// Opens an index in a PostgreSQL database; kCreate makes its tables if there are none. Errors: those of
/// Connection::Open; kNotFound (no index in the database, to read); kUnsupported (a schema of another program, or of
/// another version; no PostGIS on the server).
/// @param url, task  see Connection::Open
[[nodiscard]] Expected<std::unique_ptr<IndexStore>> OpenPostgresStore(const std::string& url, StoreMode mode,
                                                                      std::optional<TaskAttempt> task = {});

}  // namespace victorious
