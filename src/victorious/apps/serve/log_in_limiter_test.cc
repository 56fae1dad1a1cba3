#include "victorious/apps/serve/log_in_limiter.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

// How many attempts are let through before one is refused, up to 1000.
int CountAttempts(LogInLimiter& limiter, const std::string& client, const std::string& name, std::int64_t now_us) {
  int count = 0;
  while (count < 1000 && !limiter.Take(client, name, now_us)) ++count;
  return count;
}

TEST(LogInLimiterTest, OneClientGuessesTenTimesThenOnceAMinute) {
  LogInLimiter limiter;
  EXPECT_EQ(CountAttempts(limiter, "10.0.0.1", "ann", 0), 10);
  EXPECT_EQ(limiter.Take("10.0.0.1", "ANN", 0), 60) << "the same account, and the seconds until the next attempt";
  EXPECT_EQ(CountAttempts(limiter, "10.0.0.1", "ann", 59 * kSecond), 0);
  EXPECT_EQ(CountAttempts(limiter, "10.0.0.1", "ann", 60 * kSecond), 1);
  EXPECT_EQ(CountAttempts(limiter, "10.0.0.2", "ann", 60 * kSecond), 10) << "nobody is locked out everywhere";
}

TEST(LogInLimiterTest, OneClientTriesFewNames) {
  LogInLimiter limiter;
  int count = 0;
  for (int i = 0; i < 100; ++i) count += limiter.Take("10.0.0.1", "name" + std::to_string(i), 0) ? 0 : 1;
  EXPECT_EQ(count, 20);
  EXPECT_FALSE(limiter.Take("10.0.0.2", "ann", 0));
}

TEST(LogInLimiterTest, ManyClientsShareTheAttemptsOfAName) {
  LogInLimiter limiter;
  int count = 0;
  for (int i = 0; i < 50; ++i) count += CountAttempts(limiter, "10.0.1." + std::to_string(i), "ann", 0);
  EXPECT_EQ(count, 100);
}

TEST(LogInLimiterTest, AddressesOfANetworkAreOneClient) {
  LogInLimiter limiter;
  EXPECT_EQ(CountAttempts(limiter, "2001:db8::1", "ann", 0), 10);
  EXPECT_EQ(CountAttempts(limiter, "2001:db8::ffff:2", "ann", 0), 0);
  EXPECT_EQ(CountAttempts(limiter, "2001:db8:0:1::1", "ann", 0), 10);
}

TEST(LogInLimiterTest, SuccessTakesNothing) {
  LogInLimiter limiter;
  for (int i = 0; i < 100; ++i) {
    ASSERT_FALSE(limiter.Take("10.0.0.1", "ann", 0)) << i;
    limiter.PutBack("10.0.0.1", "ann");
  }
  EXPECT_EQ(CountAttempts(limiter, "10.0.0.1", "ann", 0), 10);
}

TEST(LogInLimiterTest, MemoryIsBounded) {
  LogInLimiter limiter;
  int let_in = 0;
  for (int i = 0; i < 20'000; ++i) {
    let_in +=
        limiter.Take("10.1." + std::to_string(i / 250) + "." + std::to_string(i % 250), "n" + std::to_string(i), 0) ? 0
                                                                                                                    : 1;
  }
  EXPECT_LT(let_in, 5000);
  EXPECT_FALSE(limiter.Take("10.0.0.1", "ann", 3600 * kSecond)) << "what has refilled is forgotten";
}

}  // namespace
}  // namespace victorious
