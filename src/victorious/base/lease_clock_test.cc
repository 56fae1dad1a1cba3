#include "victorious/base/lease_clock.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

using std::chrono::seconds;

constexpr LeaseClock::Clock::time_point kStart{seconds(1000)};

const Status kAway = Fail(ErrorCode::kUnavailable, "the server does not answer");

TEST(LeaseClock, IsDueAnIntervalAfterTheLastAttempt) {
  LeaseClock lease(seconds(60), seconds(15), kStart);
  EXPECT_FALSE(lease.IsDue(kStart + seconds(14)));
  EXPECT_TRUE(lease.IsDue(kStart + seconds(15)));
  lease.Enter(kAway, kStart + seconds(20));
  EXPECT_FALSE(lease.IsDue(kStart + seconds(34))) << "a server that is away is not asked all the time";
  EXPECT_TRUE(lease.IsDue(kStart + seconds(35)));
}

TEST(LeaseClock, RunsOutWithoutARenewalThatSucceeds) {
  LeaseClock lease(seconds(60), seconds(15), kStart);
  lease.Enter({}, kStart + seconds(15));
  for (int second = 30; second < 75; second += 15) {
    lease.Enter(kAway, kStart + seconds(second));
    EXPECT_FALSE(lease.IsLost(kStart + seconds(second + 14))) << second;
  }
  EXPECT_TRUE(lease.IsLost(kStart + seconds(75)));
  lease.Enter({}, kStart + seconds(76));
  EXPECT_TRUE(lease.IsLost(kStart + seconds(76))) << "work has stopped";
  EXPECT_FALSE(lease.IsDue(kStart + seconds(1000)));
}

TEST(LeaseClock, IsLostAtOnceToAnotherWorker) {
  LeaseClock lease(seconds(60), seconds(15), kStart);
  EXPECT_FALSE(lease.was_lost());
  lease.Enter(Fail(ErrorCode::kConflict, "another worker has it"), kStart + seconds(15));
  EXPECT_TRUE(lease.IsLost(kStart + seconds(15)));
  EXPECT_TRUE(lease.was_lost());
}

}  // namespace
}  // namespace victorious
