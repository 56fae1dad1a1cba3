// victorious record URL --to DIR [--db postgresql://…]: a live source into files, as it comes
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cluster/live_gaps.h"
#include "victorious/base/log.h"
#include "victorious/input/video/stream_recorder.h"

namespace victorious::cli {
namespace {

struct RecordArguments {
  std::string url;
  std::string folder;
  std::string db;
  double segment_s = 60;
  double max_size_gb = 100;
};

// Enters the files in the database, on a thread of its own: recording goes on while the database does not answer.
class Announcer {
 public:
  explicit Announcer(const RecordArguments& arguments) : arguments_(arguments) {
    if (!arguments.db.empty()) thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  }
  ~Announcer() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
  }
  Announcer(const Announcer&) = delete;
  Announcer& operator=(const Announcer&) = delete;

  /// Files were added or removed.
  void Announce() {
    const std::scoped_lock lock(mutex_);
    has_news_ = true;
    wakes_.notify_one();
  }

 private:
  static constexpr std::chrono::seconds kRetry{10};

  void Run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (true) {
      if (has_news_) {
        has_news_ = false;
        lock.unlock();
        const bool is_entered = Enter();
        lock.lock();
        has_news_ = has_news_ || !is_entered;
        if (!is_entered) wakes_.wait_for(lock, stop, kRetry, [] { return false; });
      }
      if (stop.stop_requested()) return;
      wakes_.wait(lock, stop, [this] { return has_news_; });
    }
  }

  bool Enter() {
    const auto enter = [&]() -> Status {
      VICTORIOUS_ASSIGN_OR_RETURN(const auto store, postgres::RecordingStore::Open(arguments_.db));
      return EnterRecordings(arguments_.folder, arguments_.url, *store, CancelToken());
    };
    const Status entered = enter();
    // Once for all failures in a row.
    if (!entered && !has_failed_) LogWarning("recorded, but not entered: {}", OneLine(entered.error().message));
    has_failed_ = !entered;
    return entered.has_value();
  }

  const RecordArguments& arguments_;
  std::mutex mutex_;
  std::condition_variable_any wakes_;
  bool has_news_ = false;
  bool has_failed_ = false;  ///< of the thread
  std::jthread thread_;      ///< the last member: it uses the others
};

Status Run(const RecordArguments& arguments) {
  if (!arguments.db.empty()) VICTORIOUS_RETURN_IF_ERROR(CheckSharedDatabase(arguments.db));
  Announcer announcer(arguments);
  const RecordOptions options{.folder = arguments.folder,
                              .segment_s = arguments.segment_s,
                              .max_bytes = static_cast<std::int64_t>(arguments.max_size_gb * 1e9)};
  const auto inform = [&](const RecordedFile& file) {
    LogInfo("{}: {:.1f} MB", OneLine(file.path.string()), static_cast<double>(file.bytes) / 1e6);
    announcer.Announce();
  };
  const auto warn = [](const std::string& warning) { LogWarning("{}", OneLine(warning)); };
  return RecordStream(arguments.url, options, Interrupt(), inform, warn);
}

}  // namespace

Action SetUpRecord(ArgumentParser& parser) {
  const auto arguments = std::make_shared<RecordArguments>();
  parser.Add("URL", arguments->url, "A live source: rtsp://…, udp://…, srt://…, …").Required();
  parser.Add("--to", arguments->folder, "Folder for the files, one for each source; created if it does not exist")
      .Required()
      .TypeName("DIR");
  parser
      .Add("--db", arguments->db,
           "Where the source is indexed, postgresql://USER@HOST/DATABASE: workers, which have the folder at the same "
           "path, search the files for times that none of them searched as they came")
      .TypeName("URL");
  parser
      .Add("--segment", arguments->segment_s,
           "Seconds of video in a file: it ends before the next key frame after them")
      .ShowDefault()
      .Range(1.0, 86'400.0)
      .TypeName("SECONDS");
  parser.Add("--max-size", arguments->max_size_gb, "What the files may take, in GB; the oldest are removed first")
      .ShowDefault()
      .Range(0.001, 1e6)
      .TypeName("GB");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
