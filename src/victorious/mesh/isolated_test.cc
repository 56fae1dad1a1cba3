#include "victorious/mesh/isolated.h"

#include <csignal>
#include <cstdio>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(RunIsolated, ReturnsResultsOfAnySize) {
  EXPECT_EQ(RunIsolated([] { return std::string(); }), "");
  const auto large = [] { return std::string(std::size_t{20} << 20, 'x'); };  // NOLINT(bugprone-string-constructor)
  EXPECT_EQ(RunIsolated(large), large());
}

TEST(RunIsolated, ReturnsErrors) {
  const auto result = RunIsolated(
      []() -> Expected<std::string> { return Fail(ErrorCode::kUnsupported, "too round: square is right"); });
  EXPECT_EQ(result.error(), (Error{ErrorCode::kUnsupported, "too round: square is right"}));
}

TEST(RunIsolated, DoesNotAffectTheParent) {
  int value = 1;
  EXPECT_TRUE(RunIsolated([&] {
    value = 2;
    std::puts("unheard");
    return std::string();
  }));
  EXPECT_EQ(value, 1);
}

TEST(RunIsolated, CrashIsAnError) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE}) {
    const auto result = RunIsolated([&] {
      std::raise(signal);
      return std::string();
    });
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kDataLoss);
  }
}

TEST(RunIsolated, TimeIsBounded) {
  const auto result = RunIsolated(
      [] {
        for (const volatile bool forever = true; forever;) {
        }
        return std::string();
      },
      {.processor_s = 1});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(result.error().message, HasSubstr("1 s of processor time"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(RunIsolated, MemoryIsBounded) {
  const auto result = RunIsolated([] { return std::string(std::size_t{200} << 20, 'x'); }, {.memory_bytes = 100 << 20});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(result.error().message, HasSubstr("100 MiB"));
}
#endif

}  // namespace
}  // namespace victorious
