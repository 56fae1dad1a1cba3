// What the routes read of an index: its short lists (videos, models, searches) in memory, objects and sightings by
// queries, reviews. Thread-safe.
//
// The lists are read again when another process has changed the index, within a second and in at most a fifth of the
// time; meanwhile the former ones are given out, as they are for a short time if they cannot be read
// (list_freshness.h). Objects and sightings stay in the database: each query for them is bounded and uses an index of
// the store.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "victorious/apps/serve/list_freshness.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/jobs/regroup_objects.h"
#include "victorious/store/index_store.h"
#include "victorious/store/triage_store.h"

namespace victorious {

/// The short lists of an index at one moment.
struct IndexLists {
  std::vector<VideoRecord> videos;                                  ///< by id
  std::vector<ModelRecord> models;                                  ///< by id
  std::vector<SearchRecord> searches;                               ///< begun or finished, by video
  std::vector<SearchPart> search_parts;                             ///< by video, model and frame
  std::unordered_map<std::int64_t, std::int64_t> objects_of_video;  ///< video id -> number of objects
  std::unordered_map<std::int64_t, std::int64_t> objects_of_model;  ///< model id -> number of objects
  std::optional<GeoBox> places;                                     ///< where the objects of known place lie
  std::int64_t version = 0;                                         ///< another one: the index has changed

  [[nodiscard]] const VideoRecord* Video(std::int64_t id) const;
  [[nodiscard]] const ModelRecord* Model(std::int64_t id) const;
};

/// What a person changes of a review.
struct ReviewChange {
  std::optional<std::optional<Verdict>> verdict;  ///< std::nullopt: stays as it is
  std::optional<std::string> note;                ///< likewise
  std::string reviewer;                           ///< whose review
};

class IndexView {
 public:
  /// An IndexReader that returns to the view when it is destroyed.
  class Loan {
   public:
    Loan(IndexView& view, std::unique_ptr<IndexReader> reader) : view_(&view), reader_(std::move(reader)) {}
    Loan(Loan&&) = default;
    Loan& operator=(Loan&&) = delete;
    ~Loan() {
      if (reader_) view_->Return(std::move(reader_));
    }
    IndexReader* operator->() const { return reader_.get(); }
    IndexReader& operator*() const { return *reader_; }

   private:
    IndexView* view_;
    std::unique_ptr<IndexReader> reader_;
  };

  /// Opens an index, by the name that OpenStore takes; an index of an older schema is migrated. An index that cannot be
  /// written is shown, but takes no reviews. Errors: those of OpenStore; kNotFound if there is none.
  [[nodiscard]] static Expected<std::unique_ptr<IndexView>> Open(const std::string& name);

  [[nodiscard]] bool can_review() const { return writer_ != nullptr; }

  /// Errors: those of reading at the first call; kUnavailable if the lists could not be read for too long.
  [[nodiscard]] Expected<std::shared_ptr<const IndexLists>> Lists();

  /// How old the lists are that are given out because newer ones cannot be read; 0 if that did not fail.
  [[nodiscard]] std::chrono::seconds ListsAge();

  /// At most kMaxReaders are lent at once; waits for one that comes back. Borrow one at a time: two requests that each
  /// wait for a second one would wait for each other. Errors: those of OpenStore; kUnavailable after kMaxWait,
  /// and if the index is not there any more.
  [[nodiscard]] Expected<Loan> Borrow();

  /// Stores the changed review with the present time. Errors: kPermissionDenied; those of IndexStore::PutReview.
  [[nodiscard]] Status ChangeReview(std::int64_t object, const ReviewChange& change);

  /// RegroupObjects at the present time, by a store of its own, so that reviews are stored meanwhile. Errors:
  /// kPermissionDenied; those of RegroupObjects and of OpenStore.
  [[nodiscard]] Expected<RegroupedObjects> Regroup(TrackletGroups groups, const CancelToken& cancel);
  /// UndoRegrouping likewise.
  [[nodiscard]] Expected<std::vector<std::int64_t>> UndoRegroup(std::int64_t correction, TrackletGroups groups,
                                                                const CancelToken& cancel);

  /// How often this server has changed what the lists show a little later: reviews, and those of NoteOwnChange.
  [[nodiscard]] std::int64_t own_changes() const { return own_changes_; }
  void NoteOwnChange() { ++own_changes_; }

 private:
  IndexView(std::string name, std::unique_ptr<IndexStore> writer, IndexReader lister)
      : name_(std::move(name)), writer_(std::move(writer)), lister_(std::move(lister)) {}

  /// Error: kPermissionDenied for an index that cannot be written.
  [[nodiscard]] Status CheckWriter() const;
  /// A store that writes. Errors: those of CheckWriter and of OpenStore.
  [[nodiscard]] Expected<std::unique_ptr<IndexStore>> OpenWriter() const;
  [[nodiscard]] Status Refresh();
  /// Reads the lists again if that is due. A failure is logged once.
  void TryRefresh();
  /// @param reader  null: it could not be opened
  void Return(std::unique_ptr<IndexReader> reader);

  static constexpr int kMaxReaders = 9;  ///< the threads that answer (http_server.h), and the one that watches
  static constexpr std::chrono::seconds kMaxWait{10};

  std::string name_;
  std::atomic<std::int64_t> own_changes_ = 0;
  std::mutex writer_mutex_;
  std::unique_ptr<IndexStore> writer_;  ///< null: the index cannot be written
  std::mutex refresh_mutex_;            ///< guards the next three; held while lists are read
  IndexReader lister_;
  std::int64_t change_number_ = 0;
  std::optional<std::chrono::steady_clock::time_point> checked_;
  std::chrono::steady_clock::duration refresh_interval_{};  ///< by how long the last one took
  std::mutex mutex_;                                        ///< guards the rest; held for moments
  std::shared_ptr<const IndexLists> lists_;
  ListFreshness freshness_;
  std::vector<std::unique_ptr<IndexReader>> readers_;  ///< idle
  int lent_ = 0;                                       ///< readers
  std::condition_variable returned_;
};

}  // namespace victorious
