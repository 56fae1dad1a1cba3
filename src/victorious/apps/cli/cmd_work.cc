// victorious work --db postgresql://…: a worker
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cluster/content_cache.h"
#include "victorious/apps/cluster/live_gaps.h"
#include "victorious/apps/cluster/worker.h"
#include "victorious/base/count_text.h"
#include "victorious/base/log.h"
#include "victorious/base/program_id.h"
#include "victorious/input/video/trusted_certificates.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/postgres_segment_store.h"

namespace victorious::cli {
namespace {

struct WorkArguments {
  std::string db;
  int threads = 0;
  int lease_s = static_cast<int>(postgres::TaskQueueOptions{}.lease.count());
  int retry_delay_s = static_cast<int>(postgres::TaskQueueOptions{}.retry_delay.count());
  bool until_empty = false;
  bool live = false;
  std::string content;
  std::string cache;
  double cache_size_gb = 100;
};

std::string WorkerName() {
  std::string host(256, '\0');
  if (::gethostname(host.data(), host.size() - 1) != 0) host = "unknown";
  host.resize(host.find('\0'));
  return fmt::format("{}:{}", host, ::getpid());
}

// std::nullopt without --content.
Expected<std::optional<ContentCache>> OpenCache(const WorkArguments& arguments) {
  if (arguments.content.empty() && arguments.cache.empty()) return std::nullopt;
  if (arguments.content.empty() || arguments.cache.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--content and --cache belong together: give where files are fetched from, and a folder of this "
                "machine where they are kept");
  }
  return ContentCache::Open({.place = arguments.content,
                             .folder = arguments.cache,
                             .max_bytes = static_cast<std::int64_t>(arguments.cache_size_gb * 1e9)});
}

// A worker may be started before its database, as both are when a machine starts.
Expected<std::unique_ptr<SegmentStore>> OpenWhenThere(const std::string& db, const CancelToken& interrupt) {
  constexpr std::chrono::seconds kPause{2};
  const auto end = std::chrono::steady_clock::now() + kMaxOutage;
  bool is_said = false;
  while (true) {
    auto segments = OpenPostgresSegmentStore(db, StoreMode::kCreate);
    const bool is_away = !segments && segments.error().code == ErrorCode::kUnavailable;
    if (!is_away || interrupt.IsCancelled() || std::chrono::steady_clock::now() >= end) return segments;
    if (!std::exchange(is_said, true)) LogInfo("{}: waits for it", OneLine(segments.error().message));
    std::this_thread::sleep_for(kPause);
  }
}

postgres::TaskChoice ChoiceOf(const WorkArguments& arguments) {
  if (arguments.live) return postgres::TaskChoice::kLasting;
  return arguments.until_empty ? postgres::TaskChoice::kFinite : postgres::TaskChoice::kAll;
}

Status Run(const WorkArguments& arguments) {
  VICTORIOUS_RETURN_IF_ERROR(CheckSharedDatabase(arguments.db));
  if (arguments.live && arguments.until_empty) {
    return Fail(ErrorCode::kInvalidArgument, "--live and --until-empty: live sources have no end: leave one out");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ContentCache> cache, OpenCache(arguments));
  const CancelToken& interrupt = Interrupt();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<SegmentStore> segments, OpenWhenThere(arguments.db, interrupt));
  const std::string name = WorkerName();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string program, ProgramId());
  const std::chrono::seconds lease(arguments.lease_s);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto queue,
      postgres::TaskQueue::Open(arguments.db, {.worker = name,
                                               .program = program,
                                               .choice = ChoiceOf(arguments),
                                               .lease = lease,
                                               .retry_delay = std::chrono::seconds(arguments.retry_delay_s),
                                               .reply_timeout = std::chrono::milliseconds(lease) / 3}));
  const auto inform = [](const std::string& line) { LogInfo(OneLine(line)); };
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts counts, queue->Count());
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_open, queue->HasOpenTasks());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CoverageGap> gaps_before, segments->Gaps());
  if (counts.queued > 0 && !has_open) {
    LogWarning(
        "the {} in the queue were submitted by another build of the program, whose results may differ: run that "
        "build, or submit them again by this one ({})",
        CountText(counts.queued, "video"), program);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<LiveGaps> gaps, LiveGaps::Open(arguments.db, program));
  // From here on it waits for a database that is away.
  LogInfo("worker {} of {}", name, StoreName(arguments.db));
  const auto queue_gaps = [&]() -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t queued, gaps->Queue());
    if (queued > 0) inform(fmt::format("{} of live sources queued, from recordings", CountText(queued, "gap")));
    return {};
  };
  const auto warn = [](const std::string& warning) { LogWarning(OneLine(warning)); };
  std::vector<std::string> options = {"--db", arguments.db, "--threads", fmt::format("{}", arguments.threads)};
  if (!TrustedCertificates().empty()) options.insert(options.end(), {"--ca", TrustedCertificates().string()});
  if (cache) options.insert(options.end(), {"--cache", arguments.cache + "/templates"});
  RunTask run = RunIndex(std::move(options), warn);
  if (cache) run = RunWithContent(std::move(run), *cache);
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::int64_t done,
      Work(*queue, *segments, run, {.until_empty = arguments.until_empty, .queue_more = queue_gaps, .inform = inform},
           interrupt));
  LogInfo("{} done", CountText(done, "task"));
  if (!arguments.until_empty || interrupt.IsCancelled()) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts ended, queue->Count());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CoverageGap> gaps_after, segments->Gaps());
  const auto is_new = [&](const CoverageGap& gap) { return std::ranges::find(gaps_before, gap) == gaps_before.end(); };
  if (const auto left_out = std::ranges::count_if(gaps_after, is_new); ended.failed <= counts.failed && left_out > 0) {
    return Fail(ErrorCode::kInternal,
                fmt::format("{} left: `victorious cluster status` says which frames and why, `victorious submit "
                            "--redo` queues their videos again",
                            CountText(left_out, "gap")));
  }
  if (ended.failed <= counts.failed) return {};
  return Fail(ErrorCode::kInternal,
              fmt::format("{} failed: `victorious cluster status` says why, `victorious submit` queues them again",
                          CountText(ended.failed - counts.failed, "video")));
}

}  // namespace

Action SetUpWork(ArgumentParser& parser) {
  const auto arguments = std::make_shared<WorkArguments>();
  parser.Add("--db", arguments->db, "The index: postgresql://USER@HOST/DATABASE").Required().TypeName("URL");
  parser.Add("--threads", arguments->threads, "Number of threads; 0: one per processor").Range(0, 1024).TypeName("N");
  parser
      .Add("--lease", arguments->lease_s,
           "Seconds after which another worker takes over from this one if it does not answer")
      .ShowDefault()
      .Range(4, 86'400)
      .TypeName("SECONDS");
  parser
      .Add("--retry-delay", arguments->retry_delay_s,
           "Seconds before a video that failed is tried again; four times as many before the third attempt")
      .ShowDefault()
      .Range(0, 86'400)
      .TypeName("SECONDS");
  parser
      .Add("--content", arguments->content,
           "What `victorious submit --publish` wrote, as a folder or by its address: files that this machine does not "
           "have are fetched from it")
      .TypeName("DIR|URL");
  parser
      .Add("--cache", arguments->cache,
           "Folder of this machine for fetched files and for templates of models; workers may share it")
      .TypeName("DIR");
  parser
      .Add("--cache-size", arguments->cache_size_gb,
           "What they may take, in GB; those not used for the longest time are removed first")
      .ShowDefault()
      .Range(0.001, 1e6)
      .TypeName("GB");
  parser.AddFlag("--live", arguments->live,
                 "Index live sources only: this worker is free when the one of another source is lost");
  parser.AddFlag("--until-empty", arguments->until_empty,
                 "Index no live sources, and end once no video is queued or being indexed: with exit status 1 if more "
                 "have failed than at the start, or parts of videos were left out");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
