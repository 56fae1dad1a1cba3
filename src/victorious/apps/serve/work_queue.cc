#include "victorious/apps/serve/work_queue.h"

#include <algorithm>
#include <utility>

namespace victorious {

bool WorkQueue::Add(Work work) {
  {
    const std::scoped_lock lock(mutex_);
    const auto of_client = static_cast<std::size_t>(std::ranges::count(waiting_, work.client, &Work::client));
    if (waiting_.size() >= limits_.waiting || of_client + RunningOf(work.client) >= limits_.a_client) return false;
    waiting_.push_back(std::move(work));
  }
  post_([this] { RunAllowed(); });
  return true;
}

bool WorkQueue::Cancel(const std::shared_ptr<CancelToken>& left) {
  std::list<Work> dropped;  // destroyed without the lock
  const std::scoped_lock lock(mutex_);
  left->Cancel();
  const auto found = std::ranges::find(waiting_, left, &Work::left);
  if (found == waiting_.end()) return false;
  dropped.splice(dropped.begin(), waiting_, found);
  return true;
}

void WorkQueue::CancelAll() {
  std::list<Work> dropped;
  const std::scoped_lock lock(mutex_);
  dropped.swap(waiting_);
  for (const auto& left : running_) left->Cancel();
}

// Posted once for each work: one that finds nothing it may run leaves it to the thread that has the client's other
// work.
void WorkQueue::RunAllowed() {
  while (std::optional<Work> work = Take()) {
    work->run();
    End(*work);
  }
}

std::optional<WorkQueue::Work> WorkQueue::Take() {
  const std::scoped_lock lock(mutex_);
  const auto running = [&](const Work& work) { return RunningOf(work.client); };
  const auto next = std::ranges::min_element(waiting_, {}, running);
  const std::size_t allowed = std::max<std::size_t>(1, limits_.threads - 1);
  if (next == waiting_.end() || running(*next) >= allowed) return std::nullopt;
  std::optional<Work> work(std::move(*next));
  waiting_.erase(next);
  running_.push_back(work->left);
  ++running_of_[work->client];
  return work;
}

void WorkQueue::End(const Work& work) {
  const std::scoped_lock lock(mutex_);
  running_.remove(work.left);
  if (--running_of_[work.client] == 0) running_of_.erase(work.client);
}

std::size_t WorkQueue::RunningOf(const std::string& client) const {
  const auto found = running_of_.find(client);
  return found == running_of_.end() ? 0 : found->second;
}

}  // namespace victorious
