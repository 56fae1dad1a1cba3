#include "victorious/apps/serve/work_queue.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A queue whose threads are started by hand.
class WorkQueueTest : public ::testing::Test {
 protected:
  std::shared_ptr<CancelToken> Add(const std::string& client, std::function<void()> also = [] {}) {
    auto left = std::make_shared<CancelToken>();
    const std::string name = client + std::to_string(++added_[client]);
    const bool is_added = queue_.Add({.client = client, .left = left, .run = [this, name, also] {
                                        done_.push_back(name);
                                        also();
                                      }});
    return is_added ? left : nullptr;
  }

  // One thread, until it finds nothing.
  void RunThread() {
    if (posted_.empty()) return;
    const auto next = posted_.front();
    posted_.erase(posted_.begin());
    next();
  }

  std::vector<std::function<void()>> posted_;
  WorkQueue queue_{{.threads = 3, .waiting = 5, .a_client = 3}, [this](auto run) { posted_.push_back(run); }};
  std::map<std::string, int> added_;
  std::vector<std::string> done_;
};

TEST_F(WorkQueueTest, RefusesWhatIsTooMuch) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Add("a"));
  EXPECT_FALSE(Add("a")) << "the client's share is full";
  EXPECT_TRUE(Add("b"));
  EXPECT_TRUE(Add("c"));
  EXPECT_FALSE(Add("d")) << "the queue is full";
  RunThread();
  EXPECT_THAT(done_, ElementsAre("a1", "a2", "a3", "b1", "c1"));
  EXPECT_TRUE(Add("a"));
}

TEST_F(WorkQueueTest, ClientWithLeastRunningIsNextAndNobodyTakesTheLastThread) {
  // While a1 is made, two more threads look for work: one makes a2, the other may not make a3, but b1.
  Add("a", [this] { RunThread(); });
  Add("a", [this] { RunThread(); });
  Add("a");
  Add("b");
  RunThread();
  EXPECT_THAT(done_, ElementsAre("a1", "b1", "a2", "a3"));
}

TEST_F(WorkQueueTest, WorkThatMayNotRunIsRunByTheThreadThatEnds) {
  std::vector<std::string> done_before_end;
  Add("a", [&] {
    RunThread();
    done_before_end = done_;
  });
  Add("a", [this] { RunThread(); });
  Add("a");
  RunThread();
  EXPECT_THAT(done_before_end, ElementsAre("a1", "a2", "a3"));
  EXPECT_THAT(done_, ElementsAre("a1", "a2", "a3"));
}

TEST_F(WorkQueueTest, CancelledWorkIsNotRun) {
  const auto first = Add("a");
  const auto second = Add("a");
  EXPECT_TRUE(queue_.Cancel(first));
  EXPECT_TRUE(first->IsCancelled());
  RunThread();
  EXPECT_THAT(done_, ElementsAre("a2"));
  EXPECT_FALSE(queue_.Cancel(second)) << "it has run";
}

TEST_F(WorkQueueTest, CancelAllEndsWhatRunsAndDropsWhatWaits) {
  std::shared_ptr<CancelToken> running;
  running = Add("a", [&] {
    queue_.CancelAll();
    EXPECT_TRUE(running->IsCancelled());
  });
  Add("b");
  RunThread();
  RunThread();
  EXPECT_THAT(done_, ElementsAre("a1"));
  EXPECT_THAT(posted_, IsEmpty());
}

}  // namespace
}  // namespace victorious
