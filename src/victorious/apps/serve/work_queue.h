// The queue of answers that take long (decoding): how many are made at once and wait, and whose turn it is. A client
// who asks for much waits for its own answers, and never takes the last thread. Thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "victorious/base/cancel.h"

namespace victorious {

struct WorkLimits {
  std::size_t threads = 4;    ///< that `post` runs
  std::size_t waiting = 240;  ///< of all clients
  std::size_t a_client = 24;  ///< of one client, those that are made included: a browser asks for 6 at once
};

class WorkQueue {
 public:
  struct Work {
    std::string client;
    std::shared_ptr<CancelToken> left;  ///< cancelled when nobody wants the answer any more; also the name of the work
    std::function<void()> run;          ///< must not throw
  };
  /// Runs a function on one of the threads.
  using Post = std::function<void(std::function<void()>)>;

  WorkQueue(const WorkLimits& limits, Post post) : limits_(limits), post_(std::move(post)) {}

  /// False if the queue is full, or holds too much of the client.
  [[nodiscard]] bool Add(Work work);

  /// Cancels a work. Returns whether it was waiting, and is then not run.
  bool Cancel(const std::shared_ptr<CancelToken>& left);

  /// Cancels all that run, and drops all that wait.
  void CancelAll();

 private:
  void RunAllowed();
  /// The first work of the client who has least running.
  [[nodiscard]] std::optional<Work> Take();
  void End(const Work& work);
  [[nodiscard]] std::size_t RunningOf(const std::string& client) const;

  const WorkLimits limits_;
  const Post post_;
  std::mutex mutex_;
  std::list<Work> waiting_;  ///< the oldest first
  std::list<std::shared_ptr<CancelToken>> running_;
  std::map<std::string, std::size_t> running_of_;
};

}  // namespace victorious
