// What a worker does with a task, by how the task's process ends. The process is a function here;
// tests/e2e/test_cluster.py has the real one.
#include "victorious/apps/cluster/worker.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/apps/cluster/cluster_test.h"

namespace victorious {
namespace {

using postgres::NewTask;
using postgres::TaskCounts;
using postgres::TaskQueue;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;

class PostgresWorkerTest : public PostgresClusterTest {
 protected:
  void SubmitCut() { Submit(IndexTask{.video = "/a.mp4", .options = {}, .program = "this", .segment_s = 60}, "c"); }

  Expected<std::int64_t> WorkUntilEmpty(const RunTask& run, std::size_t max_segments = 120) {
    return Work(*queue_, *segments_, run,
                {.until_empty = true,
                 .poll = std::chrono::milliseconds(1),
                 .max_segments = max_segments,
                 .left_delay = {},
                 .inform = [&](const std::string& line) { lines_.push_back(line); }},
                cancel_);
  }

  static RunTask EndWith(TaskEnd end) {
    return [end](const IndexTask&, const std::function<ChildControl()>&) { return end; };
  }

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

TEST_F(PostgresWorkerTest, LiveSourceIsOpenedAgainUntilItIsEnded) {
  SubmitLive("udp://a:1");
  const std::vector<TaskEnd> ends = {
      {},  // it ended
      {.child = {.status = 2, .error = Error{ErrorCode::kNotFound, "no answer within 10 s"}}},
      {.child = {.status = 0}}};
  std::size_t runs = 0;
  const auto run = [&](const IndexTask& task, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    EXPECT_TRUE(task.is_live);
    EXPECT_EQ(queue_->ListLasting()->size(), 1U);
    if (++runs < ends.size()) return ends[runs - 1];
    const auto other = TaskQueue::Open(url_, {.worker = "end", .program = {}}).value();
    EXPECT_TRUE(other->End(other->ListLasting()->front().id));
    ChildControl control = ChildControl::kContinue;
    while ((control = keep_lease()) == ChildControl::kContinue)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(control, ChildControl::kInterrupt);
    return ends.back();
  };
  const auto queue =
      TaskQueue::Open(url_, {.worker = kWorker, .program = "this", .lease = std::chrono::seconds(4)}).value();
  const auto done = Work(*queue, *segments_, run,
                         {.until_empty = true,
                          .poll = std::chrono::milliseconds(1),
                          .live_delay = {},
                          .inform = [&](const std::string& line) { lines_.push_back(line); }},
                         cancel_);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(*done, 1);
  EXPECT_EQ(runs, ends.size());
  EXPECT_THAT(lines_, Contains("udp://a:1: waits again: the source ended"));
  EXPECT_THAT(lines_, Contains(HasSubstr("waits again: no answer within 10 s")));
  EXPECT_THAT(lines_, Contains("udp://a:1: ended"));
  EXPECT_TRUE(queue->ListLasting()->empty());
}

TEST_F(PostgresWorkerTest, LiveSourceOfAnInterruptedWorkerGoesOn) {
  SubmitLive("udp://a:1");
  const auto run = [&](const IndexTask&, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    cancel_.Cancel();
    EXPECT_EQ(keep_lease(), ChildControl::kInterrupt);
    return TaskEnd{};
  };
  EXPECT_EQ(WorkUntilEmpty(run).value_or(-1), 0);
  EXPECT_EQ(queue_->ListLasting()->front().state, WorkState::kQueued);
}

TEST_F(PostgresWorkerTest, LiveSourceThatCannotBeIndexedFails) {
  SubmitLive("udp://a:1");
  const Error error{ErrorCode::kInvalidArgument, "the model was replaced"};
  EXPECT_EQ(WorkUntilEmpty(EndWith({.child = {.status = 2, .error = error}})).value_or(-1), 0);
  const auto listed = queue_->ListLasting().value();
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_EQ(listed.front().state, WorkState::kFailed);
  EXPECT_THAT(listed.front().reason, HasSubstr("the model was replaced"));
}

// The database was restarted: no fault of the video's, however often it happens.
TEST_F(PostgresWorkerTest, DatabaseThatDoesNotAnswerCostsNoAttempt) {
  Submit("/a.mp4");
  int runs = 0;
  const auto done = WorkUntilEmpty([&](const IndexTask&, const std::function<ChildControl()>&) -> Expected<TaskEnd> {
    if (++runs > kMaxAttempts) return TaskEnd{};
    return TaskEnd{.child = {.status = 1, .error = Error{ErrorCode::kUnavailable, "the server is starting"}}};
  });
  EXPECT_EQ(done.value_or(0), 1);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
  EXPECT_THAT(lines_, Contains(HasSubstr("the server is starting")));
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
  const auto done = Work(**queue, *segments_, run, options, cancel_);
  EXPECT_EQ(control, ChildControl::kKill);
  EXPECT_EQ(done.value_or(-1), 0) << "done by the other";
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
}

// The parent of a process.
pid_t ParentOf(pid_t process) {
  std::ifstream stat(fmt::format("/proc/{}/stat", process));
  std::string id;
  std::string name;
  std::string state;
  pid_t parent = 0;
  stat >> id >> name >> state >> parent;
  return parent;
}

// Stops processes, until it is destroyed.
class Standstill {
 public:
  explicit Standstill(const std::vector<pid_t>& processes) : processes_(processes) {
    for (const pid_t process : processes_) ::kill(process, SIGSTOP);
  }
  ~Standstill() {
    for (const pid_t process : processes_) ::kill(process, SIGCONT);
  }
  Standstill(const Standstill&) = delete;
  Standstill& operator=(const Standstill&) = delete;

 private:
  std::vector<pid_t> processes_;
};

// The server does not answer the queue, nor take new connections, as after a cut of the network. The task's process is
// killed at the end of the lease, and the loss is no failed attempt, whether the worker gives up to wait for an answer
// before the lease is lost or after it.
class PostgresStandstillTest : public PostgresWorkerTest, public ::testing::WithParamInterface<std::chrono::seconds> {};

TEST_P(PostgresStandstillTest, DoesNotKeepTheProcess) {
  auto queue = TaskQueue::Open(url_ + "&connect_timeout=2&application_name=cut_off", {.worker = "cut off",
                                                                                      .program = "this",
                                                                                      .lease = std::chrono::seconds(2),
                                                                                      .retry_delay = {},
                                                                                      .reply_timeout = GetParam()});
  ASSERT_TRUE(queue) << queue.error().message;
  const auto other = TaskQueue::Open(url_, {.worker = "other", .program = "none"});
  const auto connection = postgres::Connection::Open(url_, false);
  const auto find = [&]() -> pid_t {
    auto row = (*connection)->Query("SELECT max(pid)::bigint FROM pg_stat_activity WHERE application_name = 'cut_off'");
    return row && row->Next() ? static_cast<pid_t>(row->Integer(0)) : 0;
  };
  const auto is_idle = [&](pid_t session) {
    auto row =
        (*connection)->Query(fmt::format("SELECT 1 FROM pg_stat_activity WHERE pid = {} AND state = 'idle'", session));
    return row && row->Next();
  };
  Submit("/a.mp4");
  int runs = 0;
  const auto run = [&](const IndexTask& task, const std::function<ChildControl()>& keep_lease) -> Expected<TaskEnd> {
    if (++runs > 1) return TaskEnd{};
    EXPECT_EQ(task.attempt->attempt, 1);
    const pid_t session = find();
    if (session == 0) return Fail(ErrorCode::kInternal, "no session");
    std::optional<Standstill> standstill;
    const auto stop = [&] { standstill.emplace(std::vector<pid_t>{session, ParentOf(session)}); };
    for (stop(); !is_idle(session); stop()) {  // in a transaction it would keep the locks of the task
      standstill.reset();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    while (keep_lease() != ChildControl::kKill) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    // Another worker, which the server answers, ends the lease.
    EXPECT_TRUE((*connection)->Execute("UPDATE tasks SET leased_until = now() - interval '1 s'"));
    EXPECT_FALSE((*other)->Claim()->has_value());
    EXPECT_EQ(queue_->Count()->queued, 1);
    return TaskEnd{.child = {.status = 128 + SIGKILL, .error = {}, .is_killed = true}};
  };
  WorkerOptions options;
  options.until_empty = true;
  options.poll = std::chrono::milliseconds(1);
  options.inform = [&](const std::string& line) { lines_.push_back(line); };
  const auto done = Work(**queue, *segments_, run, options, cancel_);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(*done, 1);
  // By when the server stood still: before the renewal, between it and what follows, or until after the loss.
  EXPECT_THAT(lines_, Contains(AnyOf(HasSubstr("has not answered"), HasSubstr("connection was lost"),
                                     HasSubstr("was not renewed"))));
  auto row = (*connection)->Query("SELECT failures + kills FROM tasks");
  ASSERT_TRUE(row->Next());
  EXPECT_EQ(row->Integer(0), 0);
}

INSTANTIATE_TEST_SUITE_P(PostgresReplyTimeouts, PostgresStandstillTest,
                         ::testing::Values(std::chrono::seconds(1), std::chrono::seconds(3)));

// A process that crashes while its worker ends is to blame, one that the worker killed after its grace is not.
TEST_F(PostgresWorkerTest, CrashDuringTheEndIsAFailedAttempt) {
  Submit("/a.mp4");
  const auto failures_after = [&](const ChildEnd& end) {
    CancelToken cancel;
    const auto run = [&](const IndexTask&, const std::function<ChildControl()>&) -> Expected<TaskEnd> {
      cancel.Cancel();
      return TaskEnd{.child = end};
    };
    EXPECT_EQ(Work(*queue_, *segments_, run, {.until_empty = true, .left_delay = {}}, cancel).value_or(-1), 0);
    const auto task = queue_->Claim();
    EXPECT_TRUE(queue_->ReleaseOwn());
    return task && *task ? (*task)->failures + (*task)->kills : -1;
  };
  EXPECT_EQ(failures_after({.status = 128 + SIGSEGV, .error = {}}), 1);
  EXPECT_EQ(failures_after({.status = 128 + SIGKILL, .error = {}, .is_killed = true}), 1);
  EXPECT_EQ(failures_after({.status = 128 + SIGTERM, .error = {}}), 1) << "by who ends the worker";
  EXPECT_EQ(failures_after({.status = 128 + SIGKILL, .error = {}}), 2) << "as because the memory ran out";
}

// As by a machine that is short of memory, again and again: nothing is left out for that.
TEST_F(PostgresWorkerTest, KillsFromOutsideAreCountedApart) {
  Submit("/a.mp4");
  int runs = 0;
  std::vector<double> lengths;
  const auto run = [&](const IndexTask& task, const std::function<ChildControl()>&) -> Expected<TaskEnd> {
    lengths.push_back(task.segment_s);
    ++runs;
    if (runs < kMaxKills - 1) return TaskEnd{.child = {.status = 128 + SIGKILL}};
    return runs < kMaxKills + 1 ? TaskEnd{.child = {.status = 128 + SIGSEGV}} : TaskEnd{};
  };
  EXPECT_EQ(WorkUntilEmpty(run).value_or(-1), 1);
  EXPECT_EQ(runs, kMaxKills + 1);
  lengths.pop_back();
  EXPECT_THAT(lengths, Each(0)) << "cut short at the last attempt only";

  Submit("/b.mp4");
  runs = -1'000;
  EXPECT_EQ(WorkUntilEmpty(run).value_or(-1), 0);
  EXPECT_EQ(runs, kMaxKills - 1'000);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1, .failed = 1}));
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

// Stands for `victorious index` on a video of 480 frames, of which those of a process that touches `fatal` are killed.
class CutVideo {
 public:
  CutVideo(IndexStore& store, SegmentStore& segments, std::optional<std::int64_t> fatal)
      : segments_(segments), fatal_(fatal) {
    video_ = store.PutVideo({.content_id = "c", .name = "/a.mp4", .width = 64, .height = 48})->id;
  }

  Expected<TaskEnd> Run(const IndexTask& task) {
    if (task.part) return Search(task.part->frames);
    if (task.segment_s == 0) return Killed();
    cut_lengths.push_back(task.segment_s);
    const std::optional<VideoCut> cut = segments_.Find(cut_).value();
    if (!cut) {
      cut_ =
          segments_
              .Put(
                  {.video = video_, .plan = "plan", .step = 60, .segments = {{{0, 240}, {}, {}}, {{240, 480}, {}, {}}}},
                  {}, {})
              .value();
      return TaskEnd{.cut = cut_};
    }
    if (std::ranges::find(cut->segments, SegmentState::kOpen, &Segment::state) != cut->segments.end())
      return TaskEnd{.cut = cut_};
    joined = cut->segments;
    EXPECT_TRUE(segments_.Finish(cut_, {}));
    return TaskEnd{};
  }

  std::vector<double> cut_lengths;
  std::vector<FrameInterval> searched;
  std::vector<Segment> joined;

 private:
  static TaskEnd Killed() { return {.child = {.status = 128 + 11}}; }

  Expected<TaskEnd> Search(FrameInterval frames) {
    if (fatal_ && frames.Contains(*fatal_)) return Killed();
    searched.push_back(frames);
    EXPECT_TRUE(segments_.Complete(cut_, frames, {}));
    return TaskEnd{};
  }

  SegmentStore& segments_;
  std::optional<std::int64_t> fatal_;
  std::int64_t video_ = 0;
  std::int64_t cut_ = 0;
};

// So that they are joined from time to time.
TEST_F(PostgresWorkerTest, LongVideoQueuesSomeOfItsSegmentsAtATime) {
  CutVideo video(*store_, *segments_, std::nullopt);
  SubmitCut();
  std::vector<std::string> order;
  const auto run = [&](const IndexTask& task, const std::function<ChildControl()>&) {
    order.push_back(task.part ? "segment" : task.video);
    return video.Run(task);
  };
  EXPECT_EQ(WorkUntilEmpty(run, 1).value_or(0), 3) << "a video, two segments";
  EXPECT_EQ(order, (std::vector<std::string>{"/a.mp4", "segment", "/a.mp4", "segment", "/a.mp4"}));
  EXPECT_EQ(video.searched, (std::vector<FrameInterval>{{0, 240}, {240, 480}}));
}

TEST_F(PostgresWorkerTest, CutVideoWaitsForItsSegments) {
  CutVideo video(*store_, *segments_, std::nullopt);
  SubmitCut();
  Submit("/b.mp4");
  std::vector<std::string> order;
  const auto done = WorkUntilEmpty([&](const IndexTask& task, const std::function<ChildControl()>&) {
    order.push_back(task.part ? "segment" : task.video);
    return task.video == "/b.mp4" ? TaskEnd{} : video.Run(task);
  });
  EXPECT_EQ(done.value_or(0), 4) << "two videos, two segments";
  EXPECT_EQ(order, (std::vector<std::string>{"/a.mp4", "segment", "segment", "/a.mp4", "/b.mp4"}))
      << "a video that was begun is ended before the next one";
  EXPECT_EQ(video.searched, (std::vector<FrameInterval>{{0, 240}, {240, 480}}));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 2}));
  EXPECT_EQ(*queue_->CountParts(), (TaskCounts{.done = 2}));
}

TEST_F(PostgresWorkerTest, SegmentThatKillsIsHalvedUntilTheRestIsSearched) {
  CutVideo video(*store_, *segments_, 130);
  SubmitCut();
  const auto done =
      WorkUntilEmpty([&](const IndexTask& task, const std::function<ChildControl()>&) { return video.Run(task); });
  EXPECT_TRUE(done) << done.error().message;
  EXPECT_EQ(video.searched, (std::vector<FrameInterval>{{240, 480}, {0, 120}, {180, 240}}));
  ASSERT_EQ(video.joined.size(), 4U);
  EXPECT_EQ(video.joined[1].frames, (FrameInterval{120, 180}));
  EXPECT_EQ(video.joined[1].state, SegmentState::kQuarantined);
  EXPECT_THAT(video.joined[1].reason, HasSubstr("signal 11"));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
  EXPECT_EQ(*queue_->CountParts(), (TaskCounts{.done = 5, .failed = 1})) << "the halved ones are done by others";
  EXPECT_THAT(lines_, Contains(HasSubstr("frames 120 to 179: left out")));
}

// A video that is not cut at first kills its worker: its last attempt only cuts it.
TEST_F(PostgresWorkerTest, LastAttemptOfAVideoCutsItShort) {
  SubmitCut();
  std::vector<double> lengths;
  const auto done = WorkUntilEmpty([&](const IndexTask& task, const std::function<ChildControl()>&) {
    lengths.push_back(task.segment_s);
    return lengths.size() < 3 ? TaskEnd{.child = {.status = 128 + 11}} : TaskEnd{};
  });
  EXPECT_EQ(done.value_or(0), 1);
  EXPECT_EQ(lengths, (std::vector<double>{60, 60, 7.5}));
}

TEST_F(PostgresWorkerTest, LastAttemptCutsAlsoWhatWasToStayWhole) {
  Submit("/a.mp4");
  std::vector<double> lengths;
  const auto done = WorkUntilEmpty([&](const IndexTask& task, const std::function<ChildControl()>&) {
    lengths.push_back(task.segment_s);
    return lengths.size() < 3 ? TaskEnd{.child = {.status = 128 + 11}} : TaskEnd{};
  });
  EXPECT_EQ(done.value_or(0), 1);
  EXPECT_EQ(lengths, (std::vector<double>{0, 0, 7.5}));
}

// A segment that cannot be read is no reason to cut it: the video has failed, until it is submitted again.
TEST_F(PostgresWorkerTest, SegmentThatFailsFailsItsVideo) {
  CutVideo video(*store_, *segments_, std::nullopt);
  SubmitCut();
  bool is_gone = true;
  const auto run = [&](const IndexTask& task, const std::function<ChildControl()>&) -> Expected<TaskEnd> {
    if (is_gone && task.part && task.part->frames.from > 0)
      return TaskEnd{.child = {.status = 2, .error = Error{ErrorCode::kNotFound, "/a.mp4: no such file"}}};
    return video.Run(task);
  };
  ASSERT_TRUE(WorkUntilEmpty(run));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.failed = 1}));
  EXPECT_THAT(queue_->List(10)->front().reason, HasSubstr("no such file"));
  is_gone = false;
  SubmitCut();
  ASSERT_TRUE(WorkUntilEmpty(run));
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.done = 1}));
  EXPECT_EQ(video.searched, (std::vector<FrameInterval>{{0, 240}, {240, 480}})) << "what was done stays";
}

TEST_F(PostgresWorkerTest, InvalidTaskIsRejected) {
  const NewTask task{.kind = "stitch", .key = "a", .payload = "{}", .program = "this"};
  ASSERT_TRUE(queue_->Submit(std::span(&task, 1)));
  EXPECT_EQ(WorkUntilEmpty(EndWith({})).value_or(-1), 0);
  EXPECT_EQ(*queue_->Count(), (TaskCounts{.failed = 1}));
}

}  // namespace
}  // namespace victorious
