// What a worker does with a task, by how the task's process ends. The process is a function here;
// tests/e2e/test_cluster.py has the real one.
#include "victorious/cluster/worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/scratch_postgres.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using postgres::NewTask;
using postgres::TaskCounts;
using postgres::TaskPriority;
using postgres::TaskQueue;
using ::testing::Contains;
using ::testing::HasSubstr;

class PostgresWorkerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(url_, testing::EmptyPostgresDatabase());
    auto store = OpenStore(url_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
    auto queue = TaskQueue::Open(url_, {.worker = "worker", .program = "this", .retry_delay = {}});
    ASSERT_TRUE(queue) << queue.error().message;
    queue_ = *std::move(queue);
  }

  void Submit(const std::string& video, const std::string& program = "this") {
    const NewTask task =
        ToQueue({.video = video, .options = {}, .program = program}, video, TaskPriority::kBatch).value();
    ASSERT_EQ(queue_->Submit(std::span(&task, 1)).value(), 1);
  }

  Expected<std::int64_t> WorkUntilEmpty(const RunTask& run) {
    return Work(*queue_, *store_, run,
                {.until_empty = true,
                 .poll = std::chrono::milliseconds(1),
                 .left_delay = {},
                 .inform = [&](const std::string& line) { lines_.push_back(line); }},
                cancel_);
  }

  static RunTask EndWith(TaskEnd end) {
    return [end](const IndexTask&, const std::function<ChildControl()>&) { return end; };
  }

  std::string url_;
  std::unique_ptr<IndexStore> store_;
  std::unique_ptr<TaskQueue> queue_;
  std::vector<std::string> lines_;
  CancelToken cancel_;
};

TEST_F(PostgresWorkerTest, DoesWhatIsQueued) {
  Submit("/a.mp4");
  Submit("/b.mp4");
  std::vector<std::string> videos;
  const auto done =
      WorkUntilEmpty([&](const IndexTask& task, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
        EXPECT_EQ(keep_lease(), ChildControl::kContinue);
        videos.push_back(task.video);
        return TaskEnd{};
      });
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(*done, 2);
  EXPECT_EQ(videos, (std::vector<std::string>{"/a.mp4", "/b.mp4"}));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 2}));
}

TEST_F(PostgresWorkerTest, TaskThatKeepsFailingHasFailedAndTheRestGoesOn) {
  Submit("/broken.mp4");
  Submit("/good.mp4");
  const auto done =
      WorkUntilEmpty([&](const IndexTask& task, const std::function<ChildControl()>&) -> Expected<TaskEnd> {
        return task.video == "/good.mp4" ? TaskEnd{} : TaskEnd{.child = {.status = 128 + 11}};
      });
  EXPECT_EQ(done.value_or(0), 1);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1, .failed = 1}));
  const auto listed = queue_->List(10);
  ASSERT_EQ(listed->size(), 1U);
  EXPECT_THAT(listed->front().reason, HasSubstr("signal 11"));
}

TEST_F(PostgresWorkerTest, VideoOfAnotherProcessWaitsAgain) {
  Submit("/a.mp4");
  int runs = 0;
  const auto done = WorkUntilEmpty([&](const IndexTask&, const std::function<ChildControl()>&) -> Expected<TaskEnd> {
    return TaskEnd{.child = {}, .is_left = ++runs < 3};
  });
  EXPECT_EQ(done.value_or(0), 1);
  EXPECT_EQ(runs, 3);
  EXPECT_THAT(lines_, Contains(HasSubstr("another process")));
}

// This worker stood still past its lease, while another one did the task.
TEST_F(PostgresWorkerTest, LostLeaseKillsTheProcess) {
  auto queue = TaskQueue::Open(url_, {.worker = "slow", .program = "this", .lease = std::chrono::seconds(0)});
  auto other = TaskQueue::Open(url_, {.worker = "other", .program = "this"});
  Submit("/a.mp4");
  ChildControl control = ChildControl::kContinue;
  const auto run = [&](const IndexTask&, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    const auto task = (*other)->Claim();
    EXPECT_TRUE(task && *task);
    EXPECT_TRUE((*other)->Complete(**task));
    control = keep_lease();
    return TaskEnd{};
  };
  WorkerOptions options;
  options.until_empty = true;
  options.poll = std::chrono::milliseconds(1);
  const auto done = Work(**queue, *store_, run, options, cancel_);
  EXPECT_EQ(control, ChildControl::kKill);
  EXPECT_EQ(done.value_or(-1), 0) << "done by the other";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
}

TEST_F(PostgresWorkerTest, InterruptedTaskIsReleasedForTheNextWorker) {
  Submit("/a.mp4");
  const auto done =
      WorkUntilEmpty([&](const IndexTask&, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
        cancel_.Cancel();
        EXPECT_EQ(keep_lease(), ChildControl::kInterrupt);
        return TaskEnd{.child = {.status = 130}};
      });
  EXPECT_EQ(done.value_or(-1), 0);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
}

TEST_F(PostgresWorkerTest, TaskOfAnotherBuildIsNotTouched) {
  Submit("/a.mp4", "another");
  EXPECT_EQ(WorkUntilEmpty(EndWith({})).value_or(-1), 0);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
}

TEST_F(PostgresWorkerTest, InvalidTaskIsRejected) {
  const NewTask task{.kind = "stitch", .key = "a", .payload = "{}", .program = "this"};
  ASSERT_TRUE(queue_->Submit(std::span(&task, 1)));
  EXPECT_EQ(WorkUntilEmpty(EndWith({})).value_or(-1), 0);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.failed = 1}));
}

}  // namespace
}  // namespace victorious
