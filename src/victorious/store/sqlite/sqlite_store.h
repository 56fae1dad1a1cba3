// IndexStore in one SQLite file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "victorious/store/index_store.h"
#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

class SqliteStore final : public IndexStore {
 public:
  explicit SqliteStore(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

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
  [[nodiscard]] Expected<std::vector<std::string>> FindFaults() override;
  [[nodiscard]] Expected<std::int64_t> ChangeNumber() override;

 private:
  [[nodiscard]] Status DeleteWithObjects(std::string_view statement, const char* what, std::int64_t id);
  [[nodiscard]] Expected<std::int64_t> PutOptions(const std::string& json);
  [[nodiscard]] Status PutProgress(const IndexBatch::Progress& progress);
  [[nodiscard]] Status JoinTracklets(const IndexBatch::JoinedTracklets& joined);
  [[nodiscard]] Expected<std::int64_t> PutTracklet(const IndexBatch::TrackletUpdate& update);
  [[nodiscard]] Status PutSightings(const IndexBatch& batch, const std::vector<std::int64_t>& tracklet_ids);
  /// PutObjects inside a transaction.
  [[nodiscard]] Status WriteObjects(std::span<const ObjectRecord> objects);
  /// Inside a transaction.
  [[nodiscard]] Status WriteFits(std::span<const KeptFit> fits);
  [[nodiscard]] Status DeleteFits(std::span<const FitKey> fits);
  /// Writes the decision of a person, and what it makes of the object's review. Inside a transaction.
  [[nodiscard]] Status PutDecision(std::int64_t object, const Review& review);
  /// Writes to each object its decisions and its review. Inside a transaction.
  [[nodiscard]] Status AssignAllReviews();
  /// Likewise, to the objects of these tracklets, whose former reviews stay.
  [[nodiscard]] Status AssignReviewsOf(std::span<const std::int64_t> tracklets);
  [[nodiscard]] Status PutKeptFrames(const std::vector<KeptFrame>& frames);
  [[nodiscard]] Status PutSearchParts(const std::vector<SearchPart>& parts);
  [[nodiscard]] Status PutCoveredTimes(const std::vector<CoveredTime>& covered);
  /// Runs a statement that must change exactly one row. Error: kNotFound otherwise.
  [[nodiscard]] Status ExecuteOnRow(Statement& statement, std::string_view what, std::int64_t id);

  std::unique_ptr<Connection> connection_;
};

}  // namespace victorious::sqlite
