#include "victorious/serve/index_view.h"

#include <algorithm>
#include <utility>

#include "victorious/store/catalogue.h"

namespace victorious {
namespace {

constexpr std::chrono::seconds kMinRefreshInterval{1};
constexpr std::size_t kMaxIdleReaders = 8;

template <typename Record>
const Record* FindById(const std::vector<Record>& records, std::int64_t id) {
  const auto found = std::ranges::lower_bound(records, id, {}, &Record::id);
  return found != records.end() && found->id == id ? &*found : nullptr;
}

Expected<IndexLists> ReadLists(IndexStore& store) {
  IndexLists lists;
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, {}));
  lists.videos = catalogue.videos();
  lists.models = catalogue.models();
  VICTORIOUS_ASSIGN_OR_RETURN(lists.objects, ListObjects(store, catalogue, {}));
  for (std::size_t i = 0; i < lists.objects.size(); ++i) {
    lists.object_indices[lists.objects[i].object.id] = i;
    for (const std::int64_t video : lists.objects[i].object.videos) ++lists.objects_of_video[video];
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TrackletRecord> tracklets, store.Tracklets());
  for (TrackletRecord& tracklet : tracklets) {
    if (lists.object_indices.contains(tracklet.object)) lists.moments[tracklet.object].push_back(tracklet);
  }
  for (auto& [object, moments] : lists.moments) {
    std::ranges::sort(moments, {}, [](const TrackletRecord& one) { return std::pair(one.video, one.first_time_s); });
  }
  for (const VideoRecord& video : lists.videos) {
    for (const ModelRecord& model : lists.models) {
      VICTORIOUS_ASSIGN_OR_RETURN(std::optional<SearchRecord> search, store.FindSearch(video.id, model.id));
      if (search) lists.searches.push_back(*std::move(search));
    }
  }
  return lists;
}

}  // namespace

const VideoRecord* IndexLists::Video(std::int64_t id) const { return FindById(videos, id); }

const ModelRecord* IndexLists::Model(std::int64_t id) const { return FindById(models, id); }

const ListedObject* IndexLists::Object(std::int64_t id) const {
  const auto found = object_indices.find(id);
  return found == object_indices.end() ? nullptr : &objects[found->second];
}

Expected<std::unique_ptr<IndexView>> IndexView::Open(const std::filesystem::path& path) {
  std::error_code error;
  std::unique_ptr<IndexStore> writer;
  if (std::filesystem::exists(path, error)) {
    auto opened = OpenSqliteStore(path, StoreMode::kCreate);
    if (!opened && opened.error().code != ErrorCode::kPermissionDenied) return std::unexpected(opened.error());
    if (opened) writer = *std::move(opened);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(auto lister, OpenSqliteStore(path, StoreMode::kRead));
  std::unique_ptr<IndexView> view(new IndexView(path, std::move(writer), std::move(lister)));
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const IndexSnapshot first, view->Snapshot());
  return view;
}

Status IndexView::Refresh() {
  const auto now = std::chrono::steady_clock::now();
  if (checked_ && now - *checked_ < kMinRefreshInterval) return {};
  // Read before the lists: a change in between is seen by the next call.
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, lister_->ChangeNumber());
  if (!checked_ || number != change_number_) {
    VICTORIOUS_ASSIGN_OR_RETURN(IndexLists lists, ReadLists(*lister_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ReviewedObject> reviews, lister_->Reviews());
    ReviewMap by_object;
    for (const ReviewedObject& one : reviews) by_object.emplace(one.object, one.review);
    snapshot_ = {std::make_shared<IndexLists>(std::move(lists)), std::make_shared<ReviewMap>(std::move(by_object))};
    change_number_ = number;
  }
  checked_ = std::chrono::steady_clock::now();
  return {};
}

Expected<IndexSnapshot> IndexView::Snapshot() {
  const std::scoped_lock lock(mutex_);
  VICTORIOUS_RETURN_IF_ERROR(Refresh());
  return snapshot_;
}

Expected<std::unique_ptr<IndexStore>> IndexView::TakeReader() {
  {
    const std::scoped_lock lock(readers_mutex_);
    if (!readers_.empty()) {
      std::unique_ptr<IndexStore> reader = std::move(readers_.back());
      readers_.pop_back();
      return reader;
    }
  }
  return OpenSqliteStore(path_, StoreMode::kRead);
}

Status IndexView::VisitSightings(const SightingFilter& filter, const std::function<bool(SightingRecord&&)>& visit) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::unique_ptr<IndexStore> reader, TakeReader());
  Status status = reader->VisitSightings(filter, visit);
  const std::scoped_lock lock(readers_mutex_);
  if (status && readers_.size() < kMaxIdleReaders) readers_.push_back(std::move(reader));
  return status;
}

Expected<Review> IndexView::PutReview(std::int64_t object, Review review) {
  const std::scoped_lock lock(mutex_);
  if (!writer_) {
    return Fail(ErrorCode::kPermissionDenied,
                path_.string() +
                    ": cannot be written, so reviews are not kept: allow writing to the file and its "
                    "folder, then start `victorious serve` again");
  }
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  review.updated_utc_us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t before, lister_->ChangeNumber());
  VICTORIOUS_RETURN_IF_ERROR(writer_->PutReview(object, review));
  // The snapshot follows its own write without reading everything again, unless another process wrote, too.
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t after, lister_->ChangeNumber());
  if (before == change_number_) change_number_ = after;
  ReviewMap reviews = *snapshot_.reviews;
  if (review.IsEmpty()) {
    reviews.erase(object);
  } else {
    reviews[object] = review;
  }
  snapshot_.reviews = std::make_shared<ReviewMap>(std::move(reviews));
  return review;
}

}  // namespace victorious
