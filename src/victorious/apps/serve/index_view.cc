#include "victorious/apps/serve/index_view.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/base/utc.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

// The lists are read again after four times as long as it took, so that a large index is not read all the time, and a
// sighting of a live source shows at once in a small one.
constexpr int kRestAfterRefresh = 4;
constexpr std::chrono::milliseconds kMinRefreshInterval{50};
constexpr std::chrono::milliseconds kMaxRefreshInterval{1000};

template <typename Record>
const Record* FindById(const std::vector<Record>& records, std::int64_t id) {
  const auto found = std::ranges::lower_bound(records, id, {}, &Record::id);
  return found != records.end() && found->id == id ? &*found : nullptr;
}

std::unordered_map<std::int64_t, std::int64_t> ById(const std::vector<ObjectNumbers>& numbers) {
  std::unordered_map<std::int64_t, std::int64_t> by_id;
  for (const ObjectNumbers& one : numbers) by_id[one.id] = one.objects;
  return by_id;
}

Expected<IndexLists> ReadLists(const IndexReader& reader) {
  IndexLists lists;
  VICTORIOUS_ASSIGN_OR_RETURN(lists.videos, reader.sightings->Videos());
  VICTORIOUS_ASSIGN_OR_RETURN(lists.models, reader.sightings->Models());
  VICTORIOUS_ASSIGN_OR_RETURN(lists.searches, reader.objects->Searches());
  VICTORIOUS_ASSIGN_OR_RETURN(lists.search_parts, reader.objects->SearchParts());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto of_videos, reader.objects->ObjectsOfVideos());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto of_models, reader.objects->ObjectsOfModels());
  lists.objects_of_video = ById(of_videos);
  lists.objects_of_model = ById(of_models);
  VICTORIOUS_ASSIGN_OR_RETURN(lists.places, reader.objects->PlaceBounds());
  return lists;
}

void LogLine(const std::string& warning) { LogWarning("{}", OneLine(warning)); }

}  // namespace

const VideoRecord* IndexLists::Video(std::int64_t id) const { return FindById(videos, id); }

const ModelRecord* IndexLists::Model(std::int64_t id) const { return FindById(models, id); }

Expected<std::unique_ptr<IndexView>> IndexView::Open(const std::string& name) {
  std::unique_ptr<IndexStore> writer;
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_index, HasIndex(name));
  if (has_index) {
    auto opened = OpenStore(name, StoreMode::kCreate);
    if (!opened && opened.error().code != ErrorCode::kPermissionDenied) return std::unexpected(opened.error());
    if (opened) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool may_serve, MayServe(name));
      if (may_serve) writer = *std::move(opened);
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(IndexReader lister, OpenIndexReader(name));
  std::unique_ptr<IndexView> view(new IndexView(name, std::move(writer), std::move(lister)));
  const std::unique_lock first(view->refresh_mutex_);
  VICTORIOUS_RETURN_IF_ERROR(view->Refresh());
  view->freshness_.Succeeded(ListFreshness::Clock::now());
  return view;
}

Status IndexView::Refresh() {
  const auto now = std::chrono::steady_clock::now();
  if (checked_ && now - *checked_ < refresh_interval_) return {};
  // Read before the lists: a change in between is seen by the next call.
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, lister_.sightings->ChangeNumber());
  if (!checked_ || number != change_number_) {
    VICTORIOUS_ASSIGN_OR_RETURN(IndexLists lists, ReadLists(lister_));
    const std::scoped_lock lock(mutex_);
    lists.version = lists_ ? lists_->version + 1 : 1;
    lists_ = std::make_shared<IndexLists>(std::move(lists));
    change_number_ = number;
    const auto rest = kRestAfterRefresh * (std::chrono::steady_clock::now() - now);
    refresh_interval_ = std::clamp<std::chrono::steady_clock::duration>(rest, kMinRefreshInterval, kMaxRefreshInterval);
  }
  checked_ = std::chrono::steady_clock::now();
  return {};
}

void IndexView::TryRefresh() {
  const auto begun = ListFreshness::Clock::now();
  {
    const std::scoped_lock lock(mutex_);
    if (!freshness_.MayTry(begun)) return;
  }
  const Status status = Refresh();
  const std::scoped_lock lock(mutex_);
  if (status) {
    if (freshness_.Succeeded(begun)) LogInfo("the lists of the index are read again");
  } else if (freshness_.Failed(status.error(), begun, ListFreshness::Clock::now()) && lists_) {
    LogWarning("the lists of the index cannot be read; the former ones are shown for {} s: {}",
               ListFreshness::kMaxFailing.count(), OneLine(status.error().message));
  }
}

Expected<std::shared_ptr<const IndexLists>> IndexView::Lists() {
  if (std::unique_lock refreshing(refresh_mutex_, std::try_to_lock); refreshing) TryRefresh();
  const std::scoped_lock lock(mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const auto age, freshness_.Age(ListFreshness::Clock::now()));
  return lists_;
}

std::chrono::seconds IndexView::ListsAge() {
  const std::scoped_lock lock(mutex_);
  return freshness_.Age(ListFreshness::Clock::now()).value_or(std::chrono::seconds(0));
}

Expected<IndexView::Loan> IndexView::Borrow() {
  {
    std::unique_lock lock(mutex_);
    if (!returned_.wait_for(lock, kMaxWait, [this] { return lent_ < kMaxReaders; })) {
      return Fail(ErrorCode::kUnavailable,
                  fmt::format("{}: {} requests read it and do not end: try again later", StoreName(name_), lent_));
    }
    ++lent_;
    if (!readers_.empty()) {
      std::unique_ptr<IndexReader> reader = std::move(readers_.back());
      readers_.pop_back();
      return Loan(*this, std::move(reader));
    }
  }
  auto reader = OpenIndexReader(name_);
  if (!reader) {
    Return(nullptr);
    Error error = std::move(reader).error();
    // It was there when the server started.
    if (error.code == ErrorCode::kNotFound) error.code = ErrorCode::kUnavailable;
    return std::unexpected(std::move(error));
  }
  return Loan(*this, std::make_unique<IndexReader>(*std::move(reader)));
}

void IndexView::Return(std::unique_ptr<IndexReader> reader) {
  const std::scoped_lock lock(mutex_);
  --lent_;
  if (reader) readers_.push_back(std::move(reader));
  returned_.notify_one();
}

Status IndexView::CheckWriter() const {
  if (writer_) return {};
  return Fail(
      ErrorCode::kPermissionDenied,
      fmt::format("{}: cannot be written, so nothing is kept: allow {}, then start `victorious serve` "
                  "again",
                  StoreName(name_), IsDatabaseUrl(name_) ? "the role to write" : "writing to the file and its folder"));
}

Expected<std::unique_ptr<IndexStore>> IndexView::OpenWriter() const {
  VICTORIOUS_RETURN_IF_ERROR(CheckWriter());
  return OpenStore(name_, StoreMode::kCreate);
}

Expected<RegroupedObjects> IndexView::Regroup(TrackletGroups groups, const CancelToken& cancel) {
  groups.made_utc_us = NowUtcMicroseconds();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenWriter());
  VICTORIOUS_ASSIGN_OR_RETURN(RegroupedObjects regrouped, RegroupObjects(groups, *store, cancel, &LogLine));
  NoteOwnChange();
  return regrouped;
}

Expected<std::vector<std::int64_t>> IndexView::UndoRegroup(std::int64_t correction, TrackletGroups groups,
                                                           const CancelToken& cancel) {
  groups.made_utc_us = NowUtcMicroseconds();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenWriter());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<std::int64_t> objects,
                              UndoRegrouping(correction, groups, *store, cancel, &LogLine));
  NoteOwnChange();
  return objects;
}

Status IndexView::ChangeReview(std::int64_t object, const ReviewChange& change) {
  const std::scoped_lock lock(writer_mutex_);
  VICTORIOUS_RETURN_IF_ERROR(CheckWriter());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Review> decisions, writer_->Decisions(object));
  const auto before = std::ranges::find(decisions, change.reviewer, &Review::reviewer);
  Review review = before == decisions.end() ? Review{.reviewer = change.reviewer} : *before;
  if (change.verdict) review.verdict = *change.verdict;
  if (change.note) review.note = *change.note;
  review.updated_utc_us = NowUtcMicroseconds();
  VICTORIOUS_RETURN_IF_ERROR(writer_->PutReview(object, review));
  NoteOwnChange();
  return {};
}

}  // namespace victorious
