// What the routes read of an index: a snapshot of its lists in memory, sightings by query, reviews. Thread-safe.
//
// The snapshot holds the ranked objects (about 1 KB each), so that a page of the list costs no query. It is read again
// when another process has changed the index, at most once a second. Sightings stay in the database; each query for
// them is bounded and uses an index of the store.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/listed_object.h"

namespace victorious {

/// The lists of an index at one moment.
struct IndexLists {
  std::vector<VideoRecord> videos;                                        ///< by id
  std::vector<ModelRecord> models;                                        ///< by id
  std::vector<SearchRecord> searches;                                     ///< begun or finished, by video
  std::vector<ListedObject> objects;                                      ///< best first, without rejected ones
  std::unordered_map<std::int64_t, std::size_t> object_indices;           ///< id -> index in `objects`
  std::unordered_map<std::int64_t, std::int64_t> objects_of_video;        ///< video id -> number of objects
  std::unordered_map<std::int64_t, std::vector<TrackletRecord>> moments;  ///< object id -> its tracklets, by time

  [[nodiscard]] const VideoRecord* Video(std::int64_t id) const;
  [[nodiscard]] const ModelRecord* Model(std::int64_t id) const;
  [[nodiscard]] const ListedObject* Object(std::int64_t id) const;
};

using ReviewMap = std::map<std::int64_t, Review>;  ///< object id -> review

struct IndexSnapshot {
  std::shared_ptr<const IndexLists> lists;
  std::shared_ptr<const ReviewMap> reviews;
};

class IndexView {
 public:
  /// Opens an index; an index of an older schema is migrated. An index that cannot be written is shown, but takes no
  /// reviews. Errors: those of OpenSqliteStore.
  [[nodiscard]] static Expected<std::unique_ptr<IndexView>> Open(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] bool can_review() const { return writer_ != nullptr; }

  [[nodiscard]] Expected<IndexSnapshot> Snapshot();

  /// As IndexStore::VisitSightings.
  [[nodiscard]] Status VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit);

  /// Stores the review with the present time and returns it. Errors: kPermissionDenied; those of
  /// IndexStore::PutReview.
  [[nodiscard]] Expected<Review> PutReview(std::int64_t object, Review review);

 private:
  IndexView(std::filesystem::path path, std::unique_ptr<IndexStore> writer, std::unique_ptr<IndexStore> lister)
      : path_(std::move(path)), writer_(std::move(writer)), lister_(std::move(lister)) {}

  [[nodiscard]] Status Refresh();
  [[nodiscard]] Expected<std::unique_ptr<IndexStore>> TakeReader();

  std::filesystem::path path_;
  std::mutex mutex_;                    ///< guards all below but readers_
  std::unique_ptr<IndexStore> writer_;  ///< null: the index cannot be written
  std::unique_ptr<IndexStore> lister_;
  IndexSnapshot snapshot_;
  std::int64_t change_number_ = 0;
  std::optional<std::chrono::steady_clock::time_point> checked_;
  std::mutex readers_mutex_;
  std::vector<std::unique_ptr<IndexStore>> readers_;  ///< idle connections
};

}  // namespace victorious
