// An index store that can fail or interrupt, for the tests of jobs.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "victorious/store/index_store.h"

namespace victorious::testing {

// Forwards all calls; calls `before_commit` before each commit, `before_sightings` before sightings are read.
class FaultInjectingStore : public IndexStore {
 public:
  FaultInjectingStore(
      IndexStore& store, std::function<Status()> before_commit,
      std::function<Status()> before_sightings = [] { return Status(); })
      : store_(store), before_commit_(std::move(before_commit)), before_sightings_(std::move(before_sightings)) {}

  [[nodiscard]] Expected<std::int64_t> DeleteOtherContent(const std::string& name, const std::string& folder,
                                                          const std::string& content_id) override {
    return store_.DeleteOtherContent(name, folder, content_id);
  }
  [[nodiscard]] Status DeleteVideo(std::int64_t video) override { return store_.DeleteVideo(video); }
  [[nodiscard]] Status DeleteModel(std::int64_t model) override { return store_.DeleteModel(model); }
  [[nodiscard]] Expected<VideoRecord> PutVideo(const VideoRecord& video) override { return store_.PutVideo(video); }
  [[nodiscard]] Status SetVideoLength(std::int64_t video, std::int64_t frames, double duration_s) override {
    return store_.SetVideoLength(video, frames, duration_s);
  }
  [[nodiscard]] Status PutShownGround(std::int64_t video, std::span<const GeoBox> boxes) override {
    return store_.PutShownGround(video, boxes);
  }
  [[nodiscard]] Status SetVideoFeatures(std::int64_t video, const std::string& json) override {
    return store_.SetVideoFeatures(video, json);
  }
  [[nodiscard]] Expected<std::vector<VideoRecord>> Videos() override { return store_.Videos(); }
  [[nodiscard]] Expected<std::optional<VideoRecord>> VideoOfContent(const std::string& content_id) override {
    return store_.VideoOfContent(content_id);
  }
  [[nodiscard]] Expected<std::vector<VideoRecord>> VideosNamed(const std::string& name) override {
    return store_.VideosNamed(name);
  }
  [[nodiscard]] Expected<ModelRecord> PutModel(const ModelRecord& model) override { return store_.PutModel(model); }
  [[nodiscard]] Expected<std::vector<ModelRecord>> Models() override { return store_.Models(); }
  [[nodiscard]] Expected<std::optional<SearchRecord>> FindSearch(std::int64_t video, std::int64_t model) override {
    return store_.FindSearch(video, model);
  }
  [[nodiscard]] Expected<std::vector<SearchRecord>> Searches() override { return store_.Searches(); }
  [[nodiscard]] Expected<std::vector<SearchPart>> SearchParts(std::int64_t video) override {
    return store_.SearchParts(video);
  }
  [[nodiscard]] Status DeleteSearch(std::int64_t video, std::int64_t model) override {
    return store_.DeleteSearch(video, model);
  }
  [[nodiscard]] Status DeleteKeptFrames(std::int64_t video) override { return store_.DeleteKeptFrames(video); }
  [[nodiscard]] Expected<std::vector<std::int64_t>> Commit(const IndexBatch& batch) override {
    VICTORIOUS_RETURN_IF_ERROR(before_commit_());
    return store_.Commit(batch);
  }
  [[nodiscard]] Expected<std::vector<CoveredTime>> CoveredTimes(const std::string& source) override {
    return store_.CoveredTimes(source);
  }
  [[nodiscard]] Expected<std::vector<TrackletRecord>> Tracklets() override { return store_.Tracklets(); }
  [[nodiscard]] Status PutObjects(std::span<const ObjectRecord> objects) override { return store_.PutObjects(objects); }
  [[nodiscard]] Status UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make,
                                     const CancelToken& cancel) override {
    return store_.UpdateObjects(make, cancel);
  }
  [[nodiscard]] Expected<std::string> AssociationOptions() override { return store_.AssociationOptions(); }
  [[nodiscard]] Status PutFits(std::span<const KeptFit> fits) override { return store_.PutFits(fits); }
  [[nodiscard]] Status VisitKeptFits(const std::function<bool(KeptFit&&)>& visit) override {
    return store_.VisitKeptFits(visit);
  }
  [[nodiscard]] Expected<std::vector<std::byte>> FindKeptPath(const FitKey& key) override {
    return store_.FindKeptPath(key);
  }
  [[nodiscard]] Expected<std::vector<ObjectRecord>> Objects(const SightingFilter& filter) override {
    return store_.Objects(filter);
  }
  [[nodiscard]] Status VisitSightings(const SightingFilter& filter,
                                      const std::function<bool(SightingRecord&&)>& visit) override {
    VICTORIOUS_RETURN_IF_ERROR(before_sightings_());
    return store_.VisitSightings(filter, visit);
  }
  [[nodiscard]] Status VisitKeptFrames(const SightingFilter& filter,
                                       const std::function<bool(KeptFrame&&)>& visit) override {
    return store_.VisitKeptFrames(filter, visit);
  }
  [[nodiscard]] Status PutReview(std::int64_t object, const Review& review) override {
    return store_.PutReview(object, review);
  }
  [[nodiscard]] Expected<std::vector<ReviewedObject>> Reviews() override { return store_.Reviews(); }
  [[nodiscard]] Expected<std::vector<Review>> Decisions(std::int64_t object) override {
    return store_.Decisions(object);
  }
  [[nodiscard]] Expected<std::int64_t> PutTrackletGroups(const TrackletGroups& groups) override {
    return store_.PutTrackletGroups(groups);
  }
  [[nodiscard]] Status DeleteTrackletGroups(std::int64_t correction, const std::string& author,
                                            std::int64_t made_utc_us) override {
    return store_.DeleteTrackletGroups(correction, author, made_utc_us);
  }
  [[nodiscard]] Expected<std::vector<TrackletLink>> TrackletLinks() override { return store_.TrackletLinks(); }
  [[nodiscard]] Expected<std::vector<std::string>> FindFaults() override { return store_.FindFaults(); }
  [[nodiscard]] Expected<std::int64_t> ChangeNumber() override { return store_.ChangeNumber(); }

 private:
  IndexStore& store_;
  std::function<Status()> before_commit_;
  std::function<Status()> before_sightings_;
};

}  // namespace victorious::testing
