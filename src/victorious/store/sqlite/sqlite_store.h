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

  Expected<VideoRecord> PutVideo(const VideoRecord& video) override;
  Expected<std::int64_t> DeleteOtherContent(const std::string& name, const std::string& content_id) override;
  Status SetVideoLength(std::int64_t video, std::int64_t frame_count, double duration_s) override;
  Status SetVideoFeatures(std::int64_t video, const std::string& features_json) override;
  Expected<std::vector<VideoRecord>> Videos() override;

  Expected<ModelRecord> PutModel(const ModelRecord& model) override;
  Expected<std::vector<ModelRecord>> Models() override;

  Expected<std::optional<SearchRecord>> FindSearch(std::int64_t video, std::int64_t model) override;
  Status DeleteSearch(std::int64_t video, std::int64_t model) override;
  Status DeleteKeptFrames(std::int64_t video) override;

  Expected<std::vector<std::int64_t>> Commit(const IndexBatch& batch) override;

  Expected<std::vector<TrackletRecord>> Tracklets() override;
  Status PutObjects(std::span<const ObjectRecord> objects) override;

  Expected<std::vector<ObjectRecord>> Objects(const SightingFilter& filter) override;
  Status VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) override;
  Status VisitKeptFrames(const SightingFilter& filter, const std::function<bool(KeptFrame&&)>& visit) override;

  Status PutReview(std::int64_t object, const Review& review) override;
  Expected<std::vector<ReviewedObject>> Reviews() override;
  Expected<std::int64_t> ChangeNumber() override;

 private:
  Expected<std::int64_t> PutOptions(const std::string& json);
  Status PutProgress(const IndexBatch::Progress& progress);
  Expected<std::int64_t> PutTracklet(const IndexBatch::TrackletUpdate& update);
  Status PutSightings(const IndexBatch& batch, const std::vector<std::int64_t>& tracklet_ids);
  Status PutKeptFrames(const std::vector<KeptFrame>& frames);
  /// Runs a statement that must change exactly one row. Error: kNotFound otherwise.
  Status ExecuteOnRow(Statement& statement, std::string_view what, std::int64_t id);

  std::unique_ptr<Connection> connection_;
};

}  // namespace victorious::sqlite
