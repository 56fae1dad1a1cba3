// The contract of JobQueue, tested for every implementation.
#include "victorious/store/job_queue.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/account_store.h"

namespace victorious {
namespace {

using ::testing::SizeIs;

constexpr std::array kAllKinds = {JobKind::kIndex, JobKind::kModel, JobKind::kCopy,
                                  JobKind::kClip,  JobKind::kLive,  JobKind::kTrack};
constexpr std::int64_t kLease = 100;

class JobQueueTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    queue_ = Open();
    other_ = Open();
  }

  std::unique_ptr<JobQueue> Open() {
    auto queue = OpenJobQueue(name_);
    EXPECT_TRUE(queue) << queue.error().message;
    return *std::move(queue);
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<JobQueue> queue_;
  std::unique_ptr<JobQueue> other_;  // of another process
};

TEST_P(JobQueueTest, JobsAreTakenOnceInTheirOrder) {
  const auto first = queue_->Submit({JobKind::kIndex, R"({"video": "a"})", 1});
  const auto second = queue_->Submit({JobKind::kModel, "{}", 2});
  ASSERT_TRUE(first && second);
  const auto a = queue_->Claim("A", kAllKinds, 10, kLease);
  const auto b = other_->Claim("B", kAllKinds, 10, kLease);
  ASSERT_TRUE(a && *a && b && *b);
  EXPECT_EQ((*a)->id, first->id);
  EXPECT_EQ((*a)->input_json, R"({"video": "a"})");
  EXPECT_EQ((*a)->state, WorkState::kRunning);
  EXPECT_EQ((*b)->id, second->id);
  EXPECT_FALSE(*queue_->Claim("C", kAllKinds, 10, kLease));
  EXPECT_EQ(*queue_->CountOpen(), 2);
  ASSERT_TRUE(queue_->Complete(first->id, "A", "12 sightings", 20));
  EXPECT_EQ(*queue_->CountOpen(), 1);
  const auto done = other_->Find(first->id);
  EXPECT_EQ((*done)->state, WorkState::kDone);
  EXPECT_EQ((*done)->progress.message, "12 sightings");
  EXPECT_EQ((*done)->ended_utc_us, 20);
  EXPECT_EQ(queue_->Fail(first->id, "A", "", 21).error().code, ErrorCode::kConflict);
}

TEST_P(JobQueueTest, AJobIsSubmittedOnceAsLongAsItIsOpen) {
  const NewJob asked{.kind = JobKind::kCopy, .input_json = R"({"video": "a"})", .now_us = 1, .actor = "ann"};
  const auto first = queue_->SubmitOnce(asked);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->is_new);
  const auto same = other_->SubmitOnce(asked);
  EXPECT_FALSE(same->is_new);
  EXPECT_EQ(same->job.id, first->job.id);
  EXPECT_TRUE(other_->SubmitOnce({.kind = JobKind::kCopy, .input_json = R"({"video": "b"})", .now_us = 1})->is_new);
  EXPECT_TRUE(other_->SubmitOnce({.kind = JobKind::kIndex, .input_json = asked.input_json, .now_us = 1})->is_new);
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  EXPECT_FALSE(other_->SubmitOnce(asked)->is_new) << "it runs";
  ASSERT_TRUE(queue_->Complete(first->job.id, "A", "", 20));
  EXPECT_TRUE(other_->SubmitOnce(asked)->is_new);
}

TEST_P(JobQueueTest, TheLogSaysWhoAskedForAJobAndWhoCancelledIt) {
  const auto job = queue_->Submit({.kind = JobKind::kIndex, .input_json = "{}", .now_us = 5, .actor = "ann"});
  ASSERT_TRUE(queue_->SubmitOnce({.kind = JobKind::kIndex, .input_json = "{}", .now_us = 6, .actor = "bob"}));
  ASSERT_TRUE(queue_->Cancel(job->id, 7, "bob"));
  EXPECT_FALSE(queue_->Cancel(99, 8, "bob"));
  const auto accounts = OpenAccountStore(name_, StoreMode::kRead);
  const auto log = (*accounts)->Audit(10, std::nullopt);
  ASSERT_THAT(*log, SizeIs(2)) << "what was asked for before is no change, nor is what failed";
  EXPECT_EQ((*log)[1].action, "job");
  EXPECT_EQ((*log)[1].actor, "ann");
  EXPECT_EQ((*log)[1].subject, "job " + std::to_string(job->id));
  EXPECT_EQ((*log)[1].time_utc_us, 5);
  EXPECT_EQ((*log)[0].action, "cancel_job");
  EXPECT_EQ((*log)[0].actor, "bob");
}

TEST_P(JobQueueTest, CopiesAreTakenFirst) {
  const auto search = queue_->Submit({JobKind::kIndex, "{}", 1});
  const auto first = queue_->Submit({JobKind::kCopy, R"({"video": "a"})", 2});
  const auto second = queue_->Submit({JobKind::kCopy, R"({"video": "b"})", 3});
  for (const std::int64_t id : {first->id, second->id, search->id})
    EXPECT_EQ((*other_->Claim("A", kAllKinds, 10, kLease))->id, id);
}

TEST_P(JobQueueTest, HeartbeatsKeepAJobAndItsProgress) {
  const auto job = queue_->Submit({JobKind::kIndex, "{}", 1});
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  EXPECT_TRUE(*queue_->Renew(job->id, "A", 100, kLease,
                             {.done = 5, .total = 9, .unit = "frames", .message = "x", .behind_s = 2.5}));
  EXPECT_FALSE(*other_->Claim("B", kAllKinds, 150, kLease)) << "the lease was renewed at 100";
  const auto found = other_->Find(job->id);
  EXPECT_EQ((*found)->progress.done, 5);
  EXPECT_EQ((*found)->progress.total, 9);
  EXPECT_EQ((*found)->progress.unit, "frames");
  EXPECT_EQ((*found)->progress.behind_s, 2.5);
  ASSERT_TRUE(*other_->Claim("B", kAllKinds, 100 + 2 * kLease, kLease));
  EXPECT_FALSE((*other_->Find(job->id))->progress.behind_s) << "another attempt";
}

TEST_P(JobQueueTest, JobOfADeadWorkerGoesOn) {
  const auto job = queue_->Submit({JobKind::kIndex, "{}", 1});
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  EXPECT_FALSE(*other_->Claim("B", kAllKinds, 110, kLease)) << "the lease runs until 110";
  const auto again = other_->Claim("B", kAllKinds, 111, kLease);
  ASSERT_TRUE(again && *again);
  EXPECT_EQ((*again)->id, job->id);
  EXPECT_EQ((*again)->attempts, 2);
  EXPECT_EQ(queue_->Renew(job->id, "A", 120, kLease, {}).error().code, ErrorCode::kConflict) << "A was taken for dead";
  EXPECT_EQ(queue_->Complete(job->id, "A", "", 120).error().code, ErrorCode::kConflict);
}

TEST_P(JobQueueTest, JobThatKillsItsWorkersFails) {
  const auto job = queue_->Submit({JobKind::kIndex, "{}", 1});
  for (int attempt = 0; attempt < kMaxJobAttempts; ++attempt) {
    ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 1000 * (attempt + 1), kLease)) << attempt;
  }
  EXPECT_FALSE(*queue_->Claim("A", kAllKinds, 99'000, kLease));
  EXPECT_EQ((*queue_->Find(job->id))->state, WorkState::kFailed);
  EXPECT_THAT((*queue_->Find(job->id))->progress.message, ::testing::HasSubstr("was killed 10 times"));
}

// A server that is killed again and again takes with it what it works on.
TEST_P(JobQueueTest, JobThatComesFurtherEachTimeGoesOn) {
  const auto job = queue_->Submit({JobKind::kIndex, "{}", 1});
  std::int64_t now_us = 0;
  const auto attempt = [&](std::int64_t done) {
    now_us += 2 * kLease;
    const auto claimed = queue_->Claim("A", kAllKinds, now_us, kLease);
    if (!claimed || !*claimed) return false;
    EXPECT_TRUE(queue_->Renew(job->id, "A", now_us, kLease, {.done = done, .unit = "frames"}));
    return true;
  };
  for (int i = 1; i <= 3 * kMaxJobAttempts; ++i) ASSERT_TRUE(attempt(10 * i)) << i;
  const std::int64_t furthest = 30 * kMaxJobAttempts;
  for (int i = 1; i < kMaxJobAttempts; ++i) ASSERT_TRUE(attempt(i % 2 == 0 ? furthest : furthest - 5)) << i;
  EXPECT_FALSE(attempt(furthest)) << "it does not come further";
  EXPECT_EQ((*queue_->Find(job->id))->state, WorkState::kFailed);
}

TEST_P(JobQueueTest, ReleasedJobsAreTakenAgainWithoutLosingAnAttempt) {
  const auto job = queue_->Submit({JobKind::kIndex, "{}", 1});
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
    ASSERT_TRUE(queue_->Release(job->id, "A"));
  }
  EXPECT_EQ((*queue_->Find(job->id))->state, WorkState::kQueued);
  EXPECT_EQ(queue_->Release(job->id, "A").error().code, ErrorCode::kConflict);
}

TEST_P(JobQueueTest, CancelEndsWhatWaitsAndAsksWhatRuns) {
  const auto running = queue_->Submit({JobKind::kIndex, "{}", 1});
  const auto waiting = queue_->Submit({JobKind::kIndex, "{}", 2});
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  EXPECT_EQ(other_->Cancel(waiting->id, 11, "ann")->state, WorkState::kCancelled);
  EXPECT_EQ(other_->Cancel(running->id, 11, "ann")->state, WorkState::kRunning);
  EXPECT_FALSE(*queue_->Renew(running->id, "A", 12, kLease, {}));
  ASSERT_TRUE(queue_->EndCancelled(running->id, "A", 13));
  EXPECT_EQ(other_->Cancel(running->id, 14, "ann")->ended_utc_us, 13) << "it stays as it ended";
  EXPECT_EQ(queue_->Cancel(99, 1, "ann").error().code, ErrorCode::kNotFound);
  const auto orphan = queue_->Submit({JobKind::kIndex, "{}", 20});
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 21, kLease));
  ASSERT_TRUE(queue_->Cancel(orphan->id, 22, "ann"));
  EXPECT_FALSE(*other_->Claim("B", kAllKinds, 500, kLease)) << "not begun again after its worker died";
  EXPECT_EQ((*queue_->Find(orphan->id))->state, WorkState::kCancelled);
}

TEST_P(JobQueueTest, AFailedJobIsTriedAgainAsIfItWereNew) {
  const auto job = queue_->Submit({JobKind::kLive, R"({"video":"rtsp://a:b@c"})", 1, "ann"});
  EXPECT_EQ(other_->Retry(job->id, 2, "bob").error().code, ErrorCode::kConflict) << "it waits";
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  EXPECT_EQ(other_->Retry(job->id, 11, "bob").error().code, ErrorCode::kConflict) << "it runs";
  ASSERT_TRUE(*queue_->Renew(job->id, "A", 12, kLease, {.done = 5, .total = 9, .unit = "frames", .behind_s = 2.5}));
  ASSERT_TRUE(queue_->Fail(job->id, "A", "no route to host", 20));
  const auto again = other_->Retry(job->id, 30, "bob");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->id, job->id);
  EXPECT_EQ(again->input_json, job->input_json);
  EXPECT_EQ(again->state, WorkState::kQueued);
  EXPECT_EQ(again->attempts, 0);
  EXPECT_EQ(again->progress.message, "");
  EXPECT_EQ(again->progress.done, 0);
  EXPECT_FALSE(again->ended_utc_us);
  EXPECT_FALSE(again->started_utc_us);
  EXPECT_FALSE(again->progress.behind_s);
  for (int attempt = 0; attempt < kMaxJobAttempts; ++attempt) {
    ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 1000 * (attempt + 1), kLease)) << "all attempts anew: " << attempt;
  }
  ASSERT_TRUE(queue_->Complete(job->id, "A", "", 99'000));
  EXPECT_EQ(other_->Retry(job->id, 99'001, "bob").error().code, ErrorCode::kConflict) << "it is done";
  EXPECT_EQ(other_->Retry(99, 1, "bob").error().code, ErrorCode::kNotFound);
  const auto accounts = OpenAccountStore(name_, StoreMode::kRead);
  const auto log = (*accounts)->Audit(10, std::nullopt);
  ASSERT_THAT(*log, SizeIs(2)) << "what was refused is no change";
  EXPECT_EQ((*log)[0].action, "retry_job");
  EXPECT_EQ((*log)[0].actor, "bob");
  EXPECT_EQ((*log)[0].subject, "job " + std::to_string(job->id));
}

TEST_P(JobQueueTest, ACancelledJobIsTriedAgainUnlessAnotherDoesTheSame) {
  const NewJob asked{.kind = JobKind::kCopy, .input_json = R"({"video": "a"})", .now_us = 1, .actor = "ann"};
  const auto first = queue_->Submit(asked);
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  ASSERT_TRUE(queue_->Cancel(first->id, 11, "ann"));
  ASSERT_TRUE(queue_->EndCancelled(first->id, "A", 12));
  const auto second = queue_->Submit(asked);
  EXPECT_EQ(queue_->Retry(first->id, 13, "ann").error().code, ErrorCode::kConflict);
  ASSERT_TRUE(queue_->Cancel(second->id, 14, "ann"));
  EXPECT_EQ(queue_->Retry(first->id, 15, "ann")->cancel_asked, false);
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 16, kLease));
  EXPECT_TRUE(*queue_->Renew(first->id, "A", 17, kLease, {})) << "it is not to be cancelled any more";
}

TEST_P(JobQueueTest, AJobThatHasEndedIsRemoved) {
  const auto job = queue_->Submit({JobKind::kIndex, "{}", 1});
  EXPECT_EQ(other_->Remove(job->id, 2, "ann").error().code, ErrorCode::kConflict) << "it waits";
  ASSERT_TRUE(*queue_->Claim("A", kAllKinds, 10, kLease));
  EXPECT_EQ(other_->Remove(job->id, 11, "ann").error().code, ErrorCode::kConflict) << "it runs";
  ASSERT_TRUE(queue_->Complete(job->id, "A", "", 12));
  ASSERT_TRUE(other_->Remove(job->id, 13, "ann"));
  EXPECT_THAT(*queue_->List(10), SizeIs(0));
  EXPECT_FALSE(*queue_->Find(job->id));
  EXPECT_EQ(queue_->Remove(job->id, 14, "ann").error().code, ErrorCode::kNotFound);
  EXPECT_NE(queue_->Submit({JobKind::kIndex, "{}", 20})->id, job->id) << "an id names one job";
  const auto accounts = OpenAccountStore(name_, StoreMode::kRead);
  EXPECT_EQ((*(*accounts)->Audit(10, std::nullopt))[1].action, "remove_job");
}

TEST_P(JobQueueTest, ClaimsOnlyTheWantedKinds) {
  const auto live =
      queue_->Submit({JobKind::kLive, R"({"video":"rtsp://a:b@c"})", 1, "ann", R"({"title":"rtsp://c"})"});
  const auto clip = queue_->Submit({JobKind::kClip, "{}", 2});
  ASSERT_TRUE(live && clip);
  EXPECT_FALSE(*queue_->Claim("A", std::array{JobKind::kIndex}, 10, kLease));
  EXPECT_EQ((*queue_->Claim("A", std::array{JobKind::kClip, JobKind::kCopy}, 10, kLease))->id, clip->id);
  EXPECT_EQ((*queue_->Claim("B", std::array{JobKind::kLive}, 10, kLease))->id, live->id);
}

TEST_P(JobQueueTest, ListsWhatGoesOnThenWhatEndedLast) {
  std::vector<std::int64_t> ids;
  for (int i = 0; i < 5; ++i) {
    ids.push_back(queue_->Submit({JobKind::kIndex, "{}", i})->id);
    if (i < 3) {
      ASSERT_TRUE(queue_->Cancel(ids.back(), 10, "ann"));
    }
  }
  const auto jobs = other_->List(2);
  ASSERT_THAT(*jobs, SizeIs(4));
  EXPECT_EQ((*jobs)[0].id, ids[3]);
  EXPECT_EQ((*jobs)[1].id, ids[4]);
  EXPECT_EQ((*jobs)[2].id, ids[2]);
  EXPECT_EQ((*jobs)[3].id, ids[1]);
}

VICTORIOUS_TEST_ON_ALL_STORES(JobQueueTest);

}  // namespace
}  // namespace victorious
