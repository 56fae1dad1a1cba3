// The ceiling of the queue of tasks: workers that do nothing, or sleep, between claim and completion.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/benchmarks.h"
#include "testing/scratch_postgres.h"
#include "victorious/base/median.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/connection.h"
#include "victorious/store/postgres/task_queue.h"

namespace victorious::bench {
namespace {

using postgres::Connection;
using postgres::NewTask;
using postgres::Task;
using postgres::TaskQueue;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::string_view kProgram = "bench";

// As Debian's server, but on a socket; a connection for each worker, its peer and the bench.
const std::vector<std::string> kServerSettings = {
    "fsync=on",      "synchronous_commit=on", "full_page_writes=on", "wal_level=replica",
    "autovacuum=on", "shared_buffers=128MB",  "max_connections=1100"};

// How much is measured.
struct Extent {
  std::vector<int> workers;   ///< at once, without a pause between claim and completion
  std::vector<int> sleepers;  ///< at once, that hold each task
  milliseconds hold;          ///< by sleepers; the warm-up is longer
  std::int64_t backlog;       ///< queued tasks at the start of each round
  int rounds;
  milliseconds warm_up;
  milliseconds time;  ///< of a round, after the warm-up

  static Extent Full() {
    return {{1, 8, 64, 512}, {64, 512}, milliseconds(500), 20'000, 3, milliseconds(600), milliseconds(1000)};
  }
  static Extent Quick() { return {{1, 4}, {4}, milliseconds(10), 2'000, 1, milliseconds(20), milliseconds(100)}; }
};

/// What one worker does again and again, on a connection of its own.
using Turn = std::function<Status()>;

// Runs the turns of all workers at once, which begin one after the other within `spread`. Returns the turns a second,
// of all together, after the warm-up.
Expected<double> TurnsPerSecond(const std::vector<Turn>& turns, milliseconds spread, const Extent& extent) {
  constexpr std::chrono::minutes kMaxTime(1);
  std::atomic<std::int64_t> done = 0;
  std::atomic<bool> is_over = false;
  std::vector<Status> ends(turns.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    threads.emplace_back([&, i] {
      std::this_thread::sleep_for(spread * i / turns.size());
      while (!is_over && ends[i]) {
        ends[i] = turns[i]();
        ++done;
      }
    });
  }
  std::this_thread::sleep_for(extent.warm_up);
  const Clock::time_point start = Clock::now();
  const std::int64_t before = done;
  do {
    std::this_thread::sleep_for(extent.time);
  } while (done == before && Clock::now() - start < kMaxTime);  // on a busy machine, until one is done
  const std::int64_t after = done;
  const std::chrono::duration<double> elapsed = Clock::now() - start;
  is_over = true;
  for (std::thread& thread : threads) thread.join();
  for (const Status& end : ends) VICTORIOUS_RETURN_IF_ERROR(end);
  return static_cast<double>(after - before) / elapsed.count();
}

// Submits tasks until `backlog` are queued; `made` were before.
Status FillQueue(TaskQueue& queue, std::int64_t backlog, std::int64_t& made) {
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts counts, queue.Count());
  std::vector<NewTask> tasks;
  for (std::int64_t missing = backlog - counts.queued; missing > 0; --missing) {
    // As long as those of videos (apps/cluster/index_task.h).
    const std::string key = fmt::format("{:032} {:032}", ++made, 0);
    const std::string payload = fmt::format(
        R"({{"video":"/archive/{:08}.mp4","options":["--models","/archive/models"],"program":"{}"}})", made, kProgram);
    tasks.push_back({.kind = "index", .key = key, .payload = payload, .program = std::string(kProgram)});
  }
  const Expected<postgres::Submission> added = queue.Submit(tasks);
  if (!added) return std::unexpected(added.error());
  return {};
}

// A worker that claims a task, holds it, and ends it.
Expected<Turn> MakeWorker(const std::string& url, int number, milliseconds hold) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      std::shared_ptr<TaskQueue> queue,
      TaskQueue::Open(url, {.worker = fmt::format("host:{}", number), .program = std::string(kProgram)}));
  return [queue = std::move(queue), hold]() -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Task> task, queue->Claim());
    if (!task) return Fail(ErrorCode::kInternal, "the queue ran empty: the bench needs a larger backlog");
    std::this_thread::sleep_for(hold);
    return queue->Complete(*task);
  };
}

// A client that commits two rows, one after the other.
Expected<Turn> MakePeer(const std::string& url) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<Connection> connection, Connection::Open(url, false));
  return [connection = std::move(connection)]() -> Status {
    for (int commit = 0; commit < 2; ++commit) {
      VICTORIOUS_RETURN_IF_ERROR(connection->Execute("INSERT INTO public.commits (content) VALUES ('claimed')"));
    }
    return {};
  };
}

template <typename Make>
Expected<std::vector<Turn>> MakeTurns(int count, const Make& make) {
  std::vector<Turn> turns;
  for (int number = 0; number < count; ++number) {
    VICTORIOUS_ASSIGN_OR_RETURN(Turn turn, make(number));
    turns.push_back(std::move(turn));
  }
  return turns;
}

// Whether the log has each task that is done claimed once and done once, and no task is left running.
Status CheckLog(const std::string& url, TaskQueue& queue) {
  VICTORIOUS_ASSIGN_OR_RETURN(const postgres::TaskCounts counts, queue.Count());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto connection, Connection::Open(url, true));
  VICTORIOUS_ASSIGN_OR_RETURN(
      postgres::Result row,
      connection->Query("SELECT count(*) FILTER (WHERE event = 'claimed'), count(*) FILTER (WHERE event = 'done'), "
                        "count(DISTINCT task_id), count(*) FROM task_log"));
  const bool is_right = row.Next() && row.Integer(0) == counts.done && row.Integer(1) == counts.done &&
                        row.Integer(2) == counts.done && row.Integer(3) == 2 * counts.done && counts.running == 0;
  if (is_right) return {};
  return Fail(ErrorCode::kInternal, "the log does not have every task claimed once and done once");
}

class QueueBench {
 public:
  QueueBench(std::string url, std::unique_ptr<TaskQueue> queue, Extent extent)
      : url_(std::move(url)), queue_(std::move(queue)), extent_(std::move(extent)) {}

  Expected<std::vector<Result>> Run() {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto connection, Connection::Open(url_, false));
    VICTORIOUS_RETURN_IF_ERROR(
        connection->Execute("CREATE TABLE public.commits (id bigint GENERATED ALWAYS AS "
                            "IDENTITY PRIMARY KEY, content text)"));
    std::vector<Result> results;
    for (const int workers : extent_.workers) {
      VICTORIOUS_ASSIGN_OR_RETURN(Result result, MeasureCeiling(workers));
      results.push_back(std::move(result));
    }
    for (const int workers : extent_.sleepers) {
      VICTORIOUS_ASSIGN_OR_RETURN(Result result, MeasureSleepers(workers));
      results.push_back(std::move(result));
    }
    VICTORIOUS_RETURN_IF_ERROR(CheckLog(url_, *queue_));
    return results;
  }

 private:
  Expected<double> TasksPerSecond(const std::vector<Turn>& workers, milliseconds spread) {
    VICTORIOUS_RETURN_IF_ERROR(FillQueue(*queue_, extent_.backlog, made_));
    return TurnsPerSecond(workers, spread, extent_);
  }

  Expected<Result> MeasureCeiling(int workers) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Turn> ours, MakeTurns(workers, [&](int number) {
                                  return MakeWorker(url_, number, milliseconds(0));
                                }));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Turn> peers, MakeTurns(workers, [&](int) { return MakePeer(url_); }));
    std::vector<double> rates;
    std::vector<double> peer_rates;
    for (int round = 0; round < extent_.rounds; ++round) {
      VICTORIOUS_ASSIGN_OR_RETURN(rates.emplace_back(), TasksPerSecond(ours, {}));
      VICTORIOUS_ASSIGN_OR_RETURN(peer_rates.emplace_back(), TurnsPerSecond(peers, {}, extent_));
    }
    const double per_s = Median(rates);
    return Result{.name = fmt::format("queue_{}", workers),
                  .median_ms = 1000 / per_s,
                  .peer_median_ms = {{"commits", 1000 / Median(peer_rates)}},
                  .figures = {{"tasks_per_s", per_s}}};
  }

  Expected<Result> MeasureSleepers(int workers) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Turn> sleepers,
                                MakeTurns(workers, [&](int number) { return MakeWorker(url_, number, extent_.hold); }));
    std::vector<double> rates;
    for (int round = 0; round < extent_.rounds; ++round) {
      VICTORIOUS_ASSIGN_OR_RETURN(rates.emplace_back(), TasksPerSecond(sleepers, extent_.hold));
    }
    const double per_s = Median(rates);
    const double hold_s = std::chrono::duration<double>(extent_.hold).count();
    return Result{.name = fmt::format("queue_sleep_{}", workers),
                  .median_ms = 1000 / per_s,
                  .peer_median_ms = {},
                  .figures = {{"tasks_per_s", per_s},
                              {"hold_ms", static_cast<double>(extent_.hold.count())},
                              {"efficiency", per_s * hold_s / workers}}};
  }

  std::string url_;
  std::unique_ptr<TaskQueue> queue_;
  Extent extent_;
  std::int64_t made_ = 0;  ///< tasks
};

}  // namespace

Expected<std::vector<Result>> BenchQueue(const Settings& settings) {
  const testing::ScratchPostgres server(kServerSettings);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string url, server.url());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(url, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(auto queue, TaskQueue::Open(url, {.worker = "submit", .program = std::string(kProgram)}));
  return QueueBench(url, std::move(queue), settings.quick ? Extent::Quick() : Extent::Full()).Run();
}

}  // namespace victorious::bench
