#include "victorious/apps/serve/live_service.h"

#include <chrono>
#include <set>

#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

constexpr std::chrono::milliseconds kWatchInterval{200};
constexpr std::chrono::seconds kTrimInterval{30};
constexpr std::int64_t kEndedJobs = 20;

// Each runner works on one job at a time: a search takes hours, a live source has no end, and a user waits for a file.
constexpr int kMaxLiveSources = 4;  // at once; others wait
std::vector<std::vector<JobKind>> KindsOfRunners() {
  std::vector<std::vector<JobKind>> kinds = {{JobKind::kIndex, JobKind::kModel, JobKind::kSample, JobKind::kRemove},
                                             {JobKind::kCopy, JobKind::kClip, JobKind::kTrack, JobKind::kRefine}};
  kinds.resize(kinds.size() + kMaxLiveSources, {JobKind::kLive});
  return kinds;
}

}  // namespace

Expected<std::unique_ptr<LiveService>> LiveService::Start(IndexView& index, CopyFolder& copies,
                                                          const JobFolders& folders) {
  std::unique_ptr<JobQueue> queue;
  const bool can_run = index.can_review() && !folders.models.empty();
  if (can_run) {
    VICTORIOUS_ASSIGN_OR_RETURN(queue, OpenJobQueue(folders.index));
  }
  std::unique_ptr<LiveService> service(new LiveService(index, copies, RefinedPrefix(folders.index), std::move(queue)));
  if (can_run) {
    for (std::vector<JobKind>& kinds : KindsOfRunners()) {
      VICTORIOUS_ASSIGN_OR_RETURN(auto own, OpenJobQueue(folders.index));
      service->runners_.push_back(std::make_unique<JobRunner>(
          std::move(own), folders, [raw = service.get()] { raw->jobs_changed_ = true; },
          JobRunner::Options{.kinds = std::move(kinds)}));
    }
  }
  service->watcher_ = std::thread([raw = service.get()] { raw->Watch(); });
  return service;
}

LiveService::~LiveService() {
  is_ending_ = true;
  for (const auto& runner : runners_) runner->BeginToEnd();
  runners_.clear();
  if (watcher_.joinable()) watcher_.join();
}

Status LiveService::CheckHasJobs() const {
  if (queue_) return {};
  return Fail(ErrorCode::kUnsupported,
              "this server takes no jobs: start `victorious serve` with --models DIR on an index that can be written");
}

Expected<JobRecord> LiveService::Submit(const NewJob& job) {
  VICTORIOUS_RETURN_IF_ERROR(CheckHasJobs());
  const std::scoped_lock lock(queue_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, queue_->Submit(job));
  jobs_changed_ = true;
  WakeRunners();
  return record;
}

Expected<JobRecord> LiveService::SubmitOnce(const NewJob& job) {
  VICTORIOUS_RETURN_IF_ERROR(CheckHasJobs());
  const std::scoped_lock lock(queue_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(SubmittedJob submitted, queue_->SubmitOnce(job));
  if (submitted.is_new) {
    jobs_changed_ = true;
    WakeRunners();
  }
  return std::move(submitted.job);
}

Expected<JobRecord> LiveService::Cancel(std::int64_t job, const std::string& actor) {
  VICTORIOUS_RETURN_IF_ERROR(CheckHasJobs());
  const std::scoped_lock lock(queue_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, queue_->Cancel(job, NowUtcMicroseconds(), actor));
  jobs_changed_ = true;
  return record;
}

Expected<JobRecord> LiveService::Retry(std::int64_t job, const std::string& actor) {
  VICTORIOUS_RETURN_IF_ERROR(CheckHasJobs());
  const std::scoped_lock lock(queue_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(JobRecord record, queue_->Retry(job, NowUtcMicroseconds(), actor));
  jobs_changed_ = true;
  WakeRunners();
  return record;
}

Status LiveService::Remove(std::int64_t job, const std::string& actor) {
  VICTORIOUS_RETURN_IF_ERROR(CheckHasJobs());
  const std::scoped_lock lock(queue_mutex_);
  VICTORIOUS_RETURN_IF_ERROR(queue_->Remove(job, NowUtcMicroseconds(), actor));
  jobs_changed_ = true;
  return {};
}

Expected<std::vector<JobRecord>> LiveService::Jobs() {
  if (!queue_) return std::vector<JobRecord>{};
  const std::scoped_lock lock(queue_mutex_);
  return queue_->List(kEndedJobs);
}

Expected<std::optional<JobRecord>> LiveService::Find(std::int64_t job) {
  VICTORIOUS_RETURN_IF_ERROR(CheckHasJobs());
  const std::scoped_lock lock(queue_mutex_);
  return queue_->Find(job);
}

void LiveService::WakeRunners() {
  for (const auto& runner : runners_) runner->Wake();
}

void LiveService::Watch() {
  while (!is_ending_) {
    std::this_thread::sleep_for(kWatchInterval);
    PublishIndex();
    if (!queue_) continue;
    const bool has_news = jobs_changed_.exchange(false);
    if (has_news || !trimmed_ || std::chrono::steady_clock::now() - *trimmed_ >= kTrimInterval) TrimCopies();
    if (has_news) PublishJobs();
  }
}

// A job may have made a file, or one that was in use may be so no more.
void LiveService::TrimCopies() {
  copies_.Trim();
  RemoveRefined();
  trimmed_ = std::chrono::steady_clock::now();
}

void LiveService::RemoveRefined() {
  const auto jobs = Jobs();
  if (!jobs) return LogWarning("the queue of jobs: {}", jobs.error().message);
  std::set<std::string> kept;
  for (const JobRecord& job : *jobs) {
    if (const auto made = job.kind == JobKind::kRefine ? MadeFileOf(job) : std::nullopt) kept.insert(made->filename());
  }
  copies_.RemoveOthers(refined_prefix_, kept);
}

void LiveService::PublishIndex() {
  // Without a listener nothing is published: the version stays old, so that the next one gets the event.
  if (hub_->listeners() == 0 && published_version_ != 0) return;
  const Status published = PublishNewIndex();
  const std::string failure = published ? "" : published.error().message;
  // Once for all failures in a row.
  if (!failure.empty() && failure != index_failure_) LogWarning("the index cannot be watched: {}", failure);
  index_failure_ = failure;
}

Status LiveService::PublishNewIndex() {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  if (lists->version == published_version_) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto newest,
                              reader->objects->Objects({}, {.order = ObjectOrder::kNewest, .limit = 1}));
  published_version_ = lists->version;
  hub_->Publish("index", DumpJson(Json({{"version", published_version_},
                                        {"newest_object", newest.empty() ? 0 : newest.front().object.id}})));
  return {};
}

void LiveService::PublishJobs() {
  const auto jobs = Jobs();
  if (!jobs) return LogWarning("the queue of jobs: {}", jobs.error().message);
  const SourceReasons reasons = has_accounts_ ? SourceReasons::kHidden : SourceReasons::kShown;
  hub_->Publish("jobs", DumpJson(JobsToJson(*jobs, NowUtcMicroseconds(), reasons)));
}

}  // namespace victorious
