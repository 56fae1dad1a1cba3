// The queue of tasks: order, leases, what a dead or a frozen worker leaves, exactly one effect of each task.
#include "victorious/store/postgres/task_queue.h"

#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/scratch_postgres.h"
#include "victorious/store/open_store.h"

namespace victorious::postgres {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class PostgresTaskQueueTest : public ::testing::Test {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(url_, testing::EmptyPostgresDatabase());
    const auto store = OpenStore(url_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    queue_ = OpenOrDie("first");
  }

  std::unique_ptr<TaskQueue> OpenOrDie(const std::string& worker) const {
    auto queue = TaskQueue::Open(url_, {.worker = worker, .program = {}, .retry_delay = {}});
    if (!queue) ADD_FAILURE() << queue.error().message;
    return queue ? *std::move(queue) : nullptr;
  }

  void Submit(const std::vector<NewTask>& tasks) const {
    const auto added = queue_->Submit(tasks);
    EXPECT_TRUE(added) << added.error().message;
    EXPECT_EQ(added->added, std::ssize(tasks));
  }

  static Task ClaimOrDie(TaskQueue& queue) {
    const auto task = queue.Claim();
    EXPECT_TRUE(task) << task.error().message;
    EXPECT_TRUE(task && *task) << "none is queued";
    return task && *task ? **task : Task{};
  }

  void Run(const std::string& sql) const {
    const auto connection = Connection::Open(url_, false);
    const Status status = (*connection)->Execute(sql);
    EXPECT_TRUE(status) << status.error().message;
  }

  // All leases end now, as after a minute of silence.
  void EndLeases() const { Run("UPDATE tasks SET leased_until = now() - interval '1 s' WHERE state = 'running'"); }

  // The events of the log, in order: "1 claimed first" for the first attempt.
  std::vector<std::string> Log() const {
    const auto connection = Connection::Open(url_, true);
    auto rows = (*connection)->Query("SELECT attempt || ' ' || event || ' ' || worker FROM task_log ORDER BY id");
    std::vector<std::string> events;
    while (rows->Next()) events.push_back(rows->Text(0));
    return events;
  }

  std::string url_;
  std::unique_ptr<TaskQueue> queue_;
};

TEST_F(PostgresTaskQueueTest, ClaimsByPriorityThenByAge) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""},
          {"index", "b", TaskPriority::kPerson, R"({"frame":1})", ""},
          {"index", "c", TaskPriority::kLive, "{}", ""},
          {"index", "d", TaskPriority::kPerson, "{}", ""}});
  EXPECT_EQ(queue_
                ->Submit(std::vector<NewTask>{{"index", "a", TaskPriority::kBatch, "{}", ""},
                                              {"stitch", "a", TaskPriority::kBatch, "{}", ""}})
                ->added,
            1)
      << "a task is added once";
  std::vector<std::string> order;
  for (int i = 0; i < 5; ++i) {
    const Task task = ClaimOrDie(*queue_);
    order.push_back(task.kind + " " + task.key);
    if (task.key == "b") {
      EXPECT_EQ(task.payload, R"({"frame":1})");
    }
    EXPECT_EQ(task.attempt, 1);
  }
  EXPECT_THAT(order, ElementsAre("index c", "index b", "index d", "index a", "stitch a"));
  EXPECT_FALSE(queue_->Claim()->has_value());
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.running = 5}));
}

TEST_F(PostgresTaskQueueTest, TaskWaitsForItsParts) {
  Submit({{"index", "a", TaskPriority::kPerson, "{}", ""}, {"index", "b", TaskPriority::kPerson, "{}", ""}});
  const Task task = ClaimOrDie(*queue_);
  const std::vector<NewTask> parts = {{"segment", "a 0", TaskPriority::kBatch, "{}", ""},
                                      {"segment", "a 1", TaskPriority::kBatch, "{}", ""}};
  ASSERT_TRUE(queue_->Wait(task, parts));
  EXPECT_EQ(queue_->Wait(task, parts).error().code, ErrorCode::kConflict) << "it does not run any more";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1, .waiting = 1}));
  EXPECT_EQ(*queue_->CountParts(), (TaskCounts{.queued = 2}));
  const Task first = ClaimOrDie(*queue_);
  const auto other = OpenOrDie("other");
  const Task second = ClaimOrDie(*other);
  EXPECT_EQ(first.key + second.key, "a 0a 1") << "before the next task, with the priority of theirs";
  EXPECT_EQ(first.parent, task.id);
  ASSERT_TRUE(queue_->Complete(first));
  EXPECT_EQ(queue_->Count()->waiting, 1);
  ASSERT_TRUE(other->Complete(second));
  const Task again = ClaimOrDie(*queue_);
  EXPECT_EQ(again.id, task.id);
  EXPECT_EQ(again.attempt, 2);
  EXPECT_FALSE(again.parent);
  ASSERT_TRUE(queue_->Wait(again, {})) << "nothing left to wait for";
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1, .done = 1}));
}

// Its worker died between the end of the last part and the waking of the task.
TEST_F(PostgresTaskQueueTest, WaitingTaskIsNotForgotten) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  ASSERT_TRUE(
      queue_->Wait(ClaimOrDie(*queue_), std::vector<NewTask>{{"segment", "a 0", TaskPriority::kBatch, "{}", ""}}));
  Run("UPDATE tasks SET state = 'done' WHERE kind = 'segment'");
  EXPECT_TRUE(*queue_->HasOpenTasks());
  EXPECT_FALSE(queue_->Claim()->has_value()) << "it wakes the task";
  EXPECT_EQ(ClaimOrDie(*queue_).key, "a");
}

TEST_F(PostgresTaskQueueTest, FatalPartsAreLeftToTheirTask) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const Task task = ClaimOrDie(*queue_);
  ASSERT_TRUE(queue_->Wait(task, std::vector<NewTask>{{"segment", "a 0", TaskPriority::kBatch, "{}", ""},
                                                      {"segment", "a 1", TaskPriority::kBatch, "{}", ""}}));
  for (int attempt = 1; attempt <= kMaxAttempts; ++attempt) {
    const Task part = ClaimOrDie(*queue_);
    EXPECT_EQ(part.failures, attempt - 1);
    EXPECT_EQ(part.key, "a 0");
    ASSERT_TRUE(queue_->Fail(part, "signal 11", FailureKind::kCrash));
  }
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  const Task again = ClaimOrDie(*queue_);
  ASSERT_EQ(again.key, "a");
  const auto fatal = queue_->FatalParts(again);
  ASSERT_EQ(fatal->size(), 1U);
  EXPECT_THAT(fatal->front().reason, HasSubstr("signal 11"));
  ASSERT_TRUE(queue_->CloseFailed(fatal->front().id));
  EXPECT_TRUE(queue_->FatalParts(again)->empty());
  EXPECT_EQ(*queue_->CountParts(), (TaskCounts{.done = 2}));
}

TEST_F(PostgresTaskQueueTest, FailedPartFailsItsTaskUntilItIsSubmittedAgain) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const std::vector<NewTask> parts = {{"segment", "a 0", TaskPriority::kBatch, "{}", ""}};
  ASSERT_TRUE(queue_->Wait(ClaimOrDie(*queue_), parts));
  ASSERT_TRUE(queue_->Reject(ClaimOrDie(*queue_), "no such file"));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.failed = 1}));
  EXPECT_EQ(queue_->List(10)->front().reason, "no such file");
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  ASSERT_TRUE(queue_->Wait(ClaimOrDie(*queue_), parts));
  EXPECT_EQ(*queue_->CountParts(), (TaskCounts{.queued = 1})) << "it is tried again";
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
}

TEST_F(PostgresTaskQueueTest, QueuedTaskIsDoneAsItWasSubmittedLast) {
  const auto submit = [&](const char* payload) {
    return queue_->Submit(std::vector<NewTask>{{"index", "a", TaskPriority::kBatch, payload, ""}})->added;
  };
  EXPECT_EQ(submit("{}"), 1);
  EXPECT_EQ(submit("{}"), 0);
  EXPECT_EQ(submit(R"({"redo_other":true})"), 1);
  const Task task = ClaimOrDie(*queue_);
  EXPECT_EQ(task.payload, R"({"redo_other":true})");
  EXPECT_EQ(submit("{}"), 0) << "it runs";
}

TEST_F(PostgresTaskQueueTest, FindsOpenTasksByTheFirstWordOfTheirKey) {
  Submit({{"index", "a1 x", TaskPriority::kBatch, "{}", ""},
          {"index", "a1 y", TaskPriority::kBatch, "{}", ""},
          {"index", "a12 x", TaskPriority::kBatch, "{}", ""},
          {"live", "a1 z", TaskPriority::kBatch, "{}", ""}});
  const auto keys = [&](std::vector<std::string> words) {
    std::vector<std::string> found;
    const auto open = queue_->FindOpen("index", words);
    for (const TaskRecord& one : *open) found.push_back(one.key);
    return found;
  };
  EXPECT_THAT(keys({"a1", "b"}), ElementsAre("a1 x", "a1 y"));
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  EXPECT_THAT(keys({"a1", "a12"}), ElementsAre("a1 y", "a12 x"));
  EXPECT_THAT(keys({}), ElementsAre());
}

// The program was updated while a video was cut.
TEST_F(PostgresTaskQueueTest, AnotherBuildTakesOverAWaitingTask) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  ASSERT_TRUE(
      queue_->Wait(ClaimOrDie(*queue_), std::vector<NewTask>{{"segment", "a 0", TaskPriority::kBatch, "{}", ""}}));
  Submit({{"index", "a", TaskPriority::kBatch, "{}", "new"}});
  EXPECT_FALSE(queue_->Claim()->has_value()) << "nothing of the old build";
  auto updated = TaskQueue::Open(url_, {.worker = "new", .program = "new"});
  const Task task = ClaimOrDie(**updated);
  EXPECT_EQ(task.key, "a");
  ASSERT_TRUE((*updated)->Complete(task));
  EXPECT_EQ(*queue_->CountParts(), (TaskCounts{.done = 1}));
}

TEST_F(PostgresTaskQueueTest, EachTaskEndsOnce) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const Task task = ClaimOrDie(*queue_);
  ASSERT_TRUE(queue_->Renew(task, false));
  ASSERT_TRUE(queue_->Complete(task));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
  EXPECT_EQ(queue_->Complete(task).error().code, ErrorCode::kConflict) << "once";
  EXPECT_THAT(Log(), ElementsAre("1 claimed first", "1 done first"));
  EXPECT_EQ(queue_->Submit(std::vector<NewTask>{{"index", "a", TaskPriority::kBatch, "{}", ""}})->added, 0)
      << "it is done";
}

// As when the server was restarted: what a session had prepared is gone with it.
TEST_F(PostgresTaskQueueTest, EndedSessionIsOpenedAgain) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}, {"index", "b", TaskPriority::kBatch, "{}", ""}});
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  Run("SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity WHERE datname = current_database() AND "
      "pid <> pg_backend_pid()");
  const Task task = ClaimOrDie(*queue_);
  EXPECT_EQ(task.key, "b");
  EXPECT_TRUE(queue_->Complete(task));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 2}));
}

// A worker that stood still past its lease, while another did its task.
TEST_F(PostgresTaskQueueTest, LateWorkerIsRefused) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const Task late = ClaimOrDie(*queue_);
  const auto second = OpenOrDie("second");
  EXPECT_FALSE(second->Claim()->has_value()) << "leased";
  EndLeases();
  const Task task = ClaimOrDie(*second);
  EXPECT_EQ(task.id, late.id);
  EXPECT_EQ(task.attempt, 2);
  const Status refused = queue_->Complete(late);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().message, HasSubstr("does not run any more"));
  EXPECT_EQ(queue_->Renew(late, false).error().code, ErrorCode::kConflict);
  EXPECT_EQ(queue_->Release(late).error().code, ErrorCode::kConflict);
  EXPECT_EQ(queue_->Reject(late, "").error().code, ErrorCode::kConflict);
  EXPECT_EQ(queue_->Fail(late, "").error().code, ErrorCode::kConflict);
  ASSERT_TRUE(second->Complete(task));
  EXPECT_THAT(Log(), ElementsAre("1 claimed first", "1 lost first", "2 claimed second", "2 done second"));
}

// What a task's process writes is written while its attempt runs, or not at all.
TEST_F(PostgresTaskQueueTest, LateProcessWritesNothing) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const Task task = ClaimOrDie(*queue_);
  const TaskAttempt attempt{.task = task.id, .attempt = task.attempt};
  const auto writer = Connection::Open(url_, false, {}, attempt);
  const auto other = OpenOrDie("other");
  {
    auto transaction = Transaction::Begin(**writer, Exclusion::kShared);
    ASSERT_TRUE(transaction) << transaction.error().message;
    EXPECT_TRUE(queue_->Renew(task, true)) << "does not wait for the transaction";
    EndLeases();
    EXPECT_FALSE(other->Claim()->has_value()) << "not before the transaction has ended";
    EXPECT_TRUE(transaction->Commit());
  }
  const Task next = ClaimOrDie(*other);
  EXPECT_EQ(next.attempt, 2);
  const auto refused = Transaction::Begin(**writer, Exclusion::kAll);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().message, HasSubstr("attempt 1 of task"));
  const auto store = OpenStore(url_, StoreMode::kCreate, attempt);
  EXPECT_EQ((*store)->PutVideo({.content_id = "c", .name = "a"}).error().code, ErrorCode::kConflict);
  const auto of_next = OpenStore(url_, StoreMode::kCreate, TaskAttempt{.task = next.id, .attempt = next.attempt});
  EXPECT_TRUE((*of_next)->PutVideo({.content_id = "c", .name = "a"}));
}

TEST_F(PostgresTaskQueueTest, RenewedLeaseIsKept) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const Task task = ClaimOrDie(*queue_);
  EndLeases();
  ASSERT_TRUE(queue_->Renew(task, false)) << "late, but nobody took it";
  EXPECT_FALSE(OpenOrDie("second")->Claim()->has_value());
  EXPECT_TRUE(queue_->Complete(task));
}

// The server was down for longer than a lease, so that no worker could renew one: no fault of the tasks.
TEST_F(PostgresTaskQueueTest, RestartOfTheServerIsNoFailedAttempt) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  for (int outage = 0; outage < 2 * kMaxAttempts; ++outage) {
    ClaimOrDie(*queue_);
    EndLeases();
    Run("UPDATE tasks SET renewed_at = pg_postmaster_start_time() - interval '1 s'");
  }
  EXPECT_EQ(ClaimOrDie(*queue_).failures, 0);
}

// The network was cut for longer than a lease: the worker says so when it is back.
TEST_F(PostgresTaskQueueTest, ExcusedLossIsNoFailedAttempt) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  const auto other = OpenOrDie("other");
  for (int outage = 0; outage < 2 * kMaxAttempts; ++outage) {
    const Task task = ClaimOrDie(*queue_);
    EXPECT_EQ(task.kills, 0);
    EndLeases();
    const Task taken = ClaimOrDie(*other);
    EXPECT_EQ(taken.kills, 1);
    ASSERT_TRUE(queue_->Excuse(task));
    EXPECT_TRUE(other->Renew(taken, false)) << "who has it now, keeps it";
    ASSERT_TRUE(other->Release(taken));
  }
  const Task task = ClaimOrDie(*queue_);
  ASSERT_TRUE(queue_->Excuse(task)) << "nobody took it";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  ASSERT_TRUE(queue_->Excuse(task)) << "of a task that is done";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
}

// The answer to a claim was lost with the connection.
TEST_F(PostgresTaskQueueTest, WorkerGivesBackWhatItDoesNotKnowOf) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}, {"index", "b", TaskPriority::kBatch, "{}", ""}});
  ClaimOrDie(*queue_);
  ClaimOrDie(*OpenOrDie("other"));
  ASSERT_TRUE(queue_->ReleaseOwn());
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1, .running = 1}));
  EXPECT_EQ(ClaimOrDie(*queue_).key, "a");
}

// Done for a model whose results were deleted since, because another one of its name was searched for.
TEST_F(PostgresTaskQueueTest, UndoneTaskIsQueuedAgain) {
  NewTask task{"index", "a", TaskPriority::kBatch, "{}", ""};
  Submit({task});
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  auto again = queue_->Submit(std::span(&task, 1));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->added, 0);
  EXPECT_EQ(again->done, 1);
  task.is_undone = true;
  again = queue_->Submit(std::span(&task, 1));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->added, 1);
  EXPECT_EQ(again->done, 0);
  EXPECT_EQ(ClaimOrDie(*queue_).attempt, 2);
}

TEST_F(PostgresTaskQueueTest, WaitingTaskAndItsPartsBecomeUrgent) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""},
          {"index", "b", TaskPriority::kBatch, "{}", ""},
          {"index", "c", TaskPriority::kBatch, "{}", ""}});
  ASSERT_EQ(ClaimOrDie(*queue_).key, "a");
  const Task task = ClaimOrDie(*queue_);
  ASSERT_TRUE(queue_->Wait(task, std::vector<NewTask>{{"segment", "b 0", TaskPriority::kBatch, "{}", ""},
                                                      {"segment", "b 1", TaskPriority::kBatch, "{}", ""}}));
  ASSERT_EQ(ClaimOrDie(*queue_).key, "b 0");
  Submit({{"index", "c", TaskPriority::kPerson, "{}", ""}});
  Submit({{"index", "a", TaskPriority::kLive, "{}", ""}, {"index", "b", TaskPriority::kLive, "{}", ""}});
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1, .waiting = 1, .running = 1}));
  EXPECT_EQ(ClaimOrDie(*queue_).key, "b 1") << "before c";
}

TEST_F(PostgresTaskQueueTest, TaskWhoseWorkersAreLostAgainAndAgainFails) {
  Submit({{"index", "poison", TaskPriority::kBatch, "{}", ""}, {"index", "good", TaskPriority::kBatch, "{}", ""}});
  for (int attempt = 1; attempt <= kMaxKills; ++attempt) {
    const Task task = ClaimOrDie(*queue_);
    EXPECT_EQ(task.key, "poison");
    EXPECT_EQ(task.attempt, attempt);
    EXPECT_EQ(task.kills, attempt - 1);
    EXPECT_EQ(task.failures, 0) << "nothing says that the task did it";
    EndLeases();
  }
  EXPECT_EQ(ClaimOrDie(*queue_).key, "good");
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.running = 1, .failed = 1}));
}

TEST_F(PostgresTaskQueueTest, ReleasedAndRejectedTasks) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  for (int i = 0; i < 2 * kMaxAttempts; ++i) {
    ASSERT_TRUE(queue_->Release(ClaimOrDie(*queue_))) << "a worker that stops in order kills nothing";
  }
  ASSERT_TRUE(queue_->Reject(ClaimOrDie(*queue_), "not a video"));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.failed = 1}));
  EXPECT_FALSE(queue_->Claim()->has_value());
}

TEST_F(PostgresTaskQueueTest, TaskIsTriedAgainThenItHasFailed) {
  const std::vector<NewTask> tasks = {{"index", "a", TaskPriority::kBatch, R"({"program":"1"})", ""}};
  Submit(tasks);
  for (int attempt = 1; attempt < kMaxAttempts; ++attempt) {
    ASSERT_TRUE(queue_->Fail(ClaimOrDie(*queue_), "no space"));
    EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
  }
  ASSERT_TRUE(queue_->Fail(ClaimOrDie(*queue_), "not a video"));
  auto listed = queue_->List(10);
  ASSERT_EQ(listed->size(), 1U);
  EXPECT_EQ(listed->front().state, WorkState::kFailed);
  EXPECT_EQ(listed->front().reason, "not a video");
  EXPECT_EQ(listed->front().payload, tasks[0].payload);
  EXPECT_EQ(listed->front().attempt, kMaxAttempts);
  EXPECT_FALSE(queue_->Claim()->has_value());

  EXPECT_EQ(queue_->Submit(tasks)->added, 1) << "submitted again, it is queued again";
  const Task again = ClaimOrDie(*queue_);
  EXPECT_EQ(again.attempt, kMaxAttempts + 1);
  ASSERT_TRUE(queue_->Fail(again, "again")) << "its failures are forgotten";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
}

TEST_F(PostgresTaskQueueTest, ListsWhatRunsAndHowFastItGoes) {
  EXPECT_FALSE(queue_->MeanSeconds()->has_value());
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}, {"index", "b", TaskPriority::kBatch, "{}", ""}});
  ASSERT_TRUE(queue_->Complete(ClaimOrDie(*queue_)));
  const Task task = ClaimOrDie(*queue_);
  auto listed = queue_->List(10);
  ASSERT_EQ(listed->size(), 1U);
  EXPECT_EQ(listed->front().id, task.id);
  EXPECT_EQ(listed->front().worker, "first");
  EXPECT_EQ(listed->front().program, "");
  EXPECT_GT(listed->front().lease_left_s.value_or(0), 0);
  EXPECT_LE(listed->front().lease_left_s.value_or(99), TaskQueueOptions{}.lease.count());
  Run("UPDATE task_log SET at = at - interval '30 minutes' WHERE task_id = 1 AND event = 'claimed'");
  EXPECT_NEAR(queue_->MeanSeconds()->value_or(0), 1800, 60);
}

TEST_F(PostgresTaskQueueTest, FailingTaskWaitsLongerEachTime) {
  const auto queue = TaskQueue::Open(url_, {.worker = "patient", .program = "this build"}).value();
  Submit({{"index", "a", TaskPriority::kBatch, "{}", "this build"}});
  double delay_s = static_cast<double>(TaskQueueOptions{}.retry_delay.count());
  for (int attempt = 1; attempt < kMaxAttempts; ++attempt, delay_s *= 4) {
    const Task task = ClaimOrDie(*queue);
    EXPECT_EQ(queue->List(10)->front().program, "this build");
    ASSERT_TRUE(queue->Fail(task, "the disk is away"));
    EXPECT_FALSE(queue->Claim()->has_value()) << "not at once";
    EXPECT_TRUE(*queue->HasOpenTasks());
    Run(fmt::format("UPDATE tasks SET not_before = not_before - {} * interval '1 s'", delay_s - 100));
    EXPECT_FALSE(queue->Claim()->has_value()) << "not before the delay is over";
    Run("UPDATE tasks SET not_before = not_before - interval '100 s'");
  }
  EXPECT_EQ(ClaimOrDie(*queue).attempt, kMaxAttempts);
}

TEST_F(PostgresTaskQueueTest, ProgressForgetsFailures) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  for (int attempt = 0; attempt < 2 * kMaxAttempts; ++attempt) {
    const Task task = ClaimOrDie(*queue_);
    ASSERT_TRUE(queue_->Renew(task, true));
    ASSERT_TRUE(queue_->Fail(task, "the server was restarted"));
  }
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
}

TEST_F(PostgresTaskQueueTest, TaskOfAnotherBuildIsNotClaimed) {
  const std::vector<NewTask> tasks = {{"index", "a", TaskPriority::kBatch, "{}", "old"}};
  ASSERT_EQ(queue_->Submit(tasks)->added, 1);
  EXPECT_FALSE(queue_->Claim()->has_value());
  EXPECT_FALSE(*queue_->HasOpenTasks());
  const std::vector<NewTask> again = {{"index", "a", TaskPriority::kPerson, "{}", ""}};
  ASSERT_EQ(queue_->Submit(again)->added, 1) << "submitted by this build";
  EXPECT_TRUE(*queue_->HasOpenTasks());
  EXPECT_EQ(ClaimOrDie(*queue_).key, "a");
}

// 100,000 queued tasks of another build cost 26 ms a claim when they were read.
TEST_F(PostgresTaskQueueTest, TasksOfAnotherBuildAreNotRead) {
  const auto connection = Connection::Open(url_, true, "-c enable_seqscan=off -c enable_sort=off");
  auto plan = (*connection)
                  ->Query(
                      "EXPLAIN SELECT id FROM tasks WHERE state = 'queued' AND program = 'this' ORDER BY priority, "
                      "coalesce(parent, id), id LIMIT 1");
  ASSERT_TRUE(plan) << plan.error().message;
  std::string text;
  while (plan->Next()) text += plan->Text(0) + "\n";
  EXPECT_THAT(text, HasSubstr("Index Cond: (program = 'this'"));
}

TEST_F(PostgresTaskQueueTest, SubmittedTwiceAtOnceItIsOneTask) {
  const NewTask task{"index", "a", TaskPriority::kBatch, "{}", ""};
  EXPECT_EQ(queue_->Submit(std::vector{task, task})->added, 1);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1}));
}

TEST_F(PostgresTaskQueueTest, ReleasedWithDelayItWaits) {
  Submit({{"index", "a", TaskPriority::kBatch, "{}", ""}});
  ASSERT_TRUE(queue_->Release(ClaimOrDie(*queue_), std::chrono::hours(1)));
  EXPECT_FALSE(queue_->Claim()->has_value());
  Run("UPDATE tasks SET not_before = now()");
  EXPECT_EQ(ClaimOrDie(*queue_).key, "a");
}

TEST_F(PostgresTaskQueueTest, LastingTaskOutlivesItsWorkers) {
  Submit({{.kind = "live", .key = "a", .priority = TaskPriority::kLive, .payload = "{}", .is_lasting = true},
          {"index", "b", TaskPriority::kBatch, "{}", ""}});
  for (int lost = 0; lost < 2 * kMaxAttempts; ++lost) {
    EXPECT_EQ(ClaimOrDie(*queue_).key, "a") << "before all others";
    EndLeases();
  }
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.queued = 1})) << "counts those with an end";
  const auto listed = queue_->ListLasting().value();
  ASSERT_EQ(listed.size(), 1U);
  const Task task = ClaimOrDie(*queue_);
  EXPECT_EQ(queue_->ListLasting()->front().worker, "first");
  ASSERT_TRUE(queue_->Release(task, {}, "the source ended"));
  EXPECT_EQ(queue_->ListLasting()->front().reason, "the source ended");
  EXPECT_TRUE(queue_->List(10)->empty());
}

TEST_F(PostgresTaskQueueTest, LastingTaskEndsWhenItIsEnded) {
  const std::vector<NewTask> tasks = {{.kind = "live",
                                       .key = "a",
                                       .priority = TaskPriority::kLive,
                                       .payload = "{}",
                                       .is_undone = true,
                                       .is_lasting = true}};
  Submit(tasks);
  const Task task = ClaimOrDie(*queue_);
  EXPECT_EQ(queue_->Renew(task, true), true);
  ASSERT_TRUE(queue_->End(task.id));
  EXPECT_EQ(queue_->Renew(task, true), false);
  ASSERT_TRUE(queue_->Release(task)) << "as by a worker that is interrupted at that moment";
  EXPECT_TRUE(queue_->ListLasting()->empty());
  EXPECT_FALSE(queue_->Claim()->has_value());

  EXPECT_EQ(queue_->Submit(tasks)->added, 1) << "submitted again, it begins again";
  const Task again = ClaimOrDie(*queue_);
  ASSERT_TRUE(queue_->End(again.id));
  EndLeases();
  EXPECT_FALSE(queue_->Claim()->has_value()) << "its worker is lost: nobody goes on";
  EXPECT_EQ(queue_->Submit(tasks)->added, 1);
  const Task last = ClaimOrDie(*queue_);
  ASSERT_TRUE(queue_->End(last.id));
  ASSERT_TRUE(queue_->Submit(tasks));
  EXPECT_EQ(queue_->Renew(last, true), true) << "submitted again before it has ended, it goes on";
}

TEST_F(PostgresTaskQueueTest, WorkersChooseWhetherTasksHaveAnEnd) {
  Submit({{.kind = "live", .key = "a", .priority = TaskPriority::kLive, .payload = "{}", .is_lasting = true},
          {"index", "b", TaskPriority::kBatch, "{}", ""}});
  const auto open = [&](TaskChoice choice) {
    return TaskQueue::Open(url_, {.worker = "w", .program = {}, .choice = choice}).value();
  };
  const auto finite = open(TaskChoice::kFinite);
  ASSERT_TRUE(finite->Complete(ClaimOrDie(*finite)));
  EXPECT_FALSE(finite->Claim()->has_value());
  EXPECT_FALSE(*finite->HasOpenTasks());
  const auto lasting = open(TaskChoice::kLasting);
  EXPECT_TRUE(*lasting->HasOpenTasks());
  EXPECT_EQ(ClaimOrDie(*lasting).key, "a");
  ASSERT_TRUE(lasting->End(2)) << "without effect on others";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
}

// Law: whatever workers do at once, each task is claimed and done once.
TEST_F(PostgresTaskQueueTest, ConcurrentWorkersDoEachTaskOnce) {
  constexpr int kTasks = 60;
  constexpr int kWorkers = 4;
  std::vector<NewTask> tasks;
  for (int i = 0; i < kTasks; ++i) tasks.push_back({"index", std::to_string(i), TaskPriority::kBatch, "{}", ""});
  Submit(tasks);
  std::array<std::string, kWorkers> faults;
  std::vector<std::thread> threads;
  const auto work = [&](const std::string& name) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto queue, TaskQueue::Open(url_, {.worker = name, .program = {}}));
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Task> task, queue->Claim());
      if (!task) return {};
      VICTORIOUS_RETURN_IF_ERROR(queue->Complete(*task));
    }
  };
  for (std::string& fault : faults) {
    threads.emplace_back([&] {
      const Status status = work("worker");
      fault = status ? "" : status.error().message;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(faults, Each(""));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = kTasks}));
  const std::vector<std::string> log = Log();
  EXPECT_EQ(std::ranges::count(log, "1 claimed worker"), kTasks);
  EXPECT_EQ(std::ranges::count(log, "1 done worker"), kTasks);
}

}  // namespace
}  // namespace victorious::postgres
