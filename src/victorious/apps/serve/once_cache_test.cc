#include "victorious/apps/serve/once_cache.h"

#include <atomic>
#include <future>
#include <latch>
#include <stdexcept>

#include <gtest/gtest.h>

namespace victorious {
namespace {

using Cache = OnceCache<int>;

TEST(OnceCache, MakesAValueOnceAndDropsTheLeastRecentlyUsed) {
  Cache cache(2);
  int made = 0;
  const auto get = [&](const std::string& key) { return **cache.Get(key, [&]() -> Expected<int> { return ++made; }); };
  EXPECT_EQ(get("a"), 1);
  EXPECT_EQ(get("b"), 2);
  EXPECT_EQ(get("a"), 1);
  EXPECT_EQ(get("c"), 3);  // drops b
  EXPECT_EQ(get("a"), 1);
  EXPECT_EQ(get("b"), 4);
}

TEST(OnceCache, KeepsNoErrorsAndNoExceptions) {
  Cache cache(2);
  const auto failed = cache.Get("a", []() -> Expected<int> { return Fail(ErrorCode::kNotFound, "gone"); });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kNotFound);
  const auto thrown = cache.Get("a", []() -> Expected<int> { throw std::runtime_error("broken"); });
  ASSERT_FALSE(thrown);
  EXPECT_EQ(thrown.error().code, ErrorCode::kInternal);
  EXPECT_EQ(**cache.Get("a", []() -> Expected<int> { return 7; }), 7);
}

TEST(OnceCache, WaitsForItsOwnKeyOnly) {
  Cache cache(4);
  std::latch is_making(1);
  std::promise<void> may_end;
  std::atomic<int> made = 0;
  const auto slow = [&]() -> Expected<int> {
    ++made;
    is_making.count_down();
    may_end.get_future().wait();
    return 1;
  };
  auto first = std::async(std::launch::async, [&] { return **cache.Get("slow", slow); });
  is_making.wait();
  auto second = std::async(std::launch::async, [&] {
    return **cache.Get("slow", [&]() -> Expected<int> {
      ++made;
      return 2;
    });
  });
  // Another key does not wait.
  EXPECT_EQ(**cache.Get("quick", []() -> Expected<int> { return 3; }), 3);
  may_end.set_value();
  EXPECT_EQ(first.get(), 1);
  EXPECT_EQ(second.get(), 1);
  EXPECT_EQ(made, 1);
}

TEST(OnceCache, ValueWhoseMakerIsCancelledIsMadeByAnother) {
  Cache cache(4);
  CancelToken first_left;
  const CancelToken second_stays;
  std::latch is_making(1);
  std::promise<void> may_end;
  auto first = std::async(std::launch::async, [&] {
    return GetUnlessCancelled(cache, "a", first_left, [&]() -> Expected<int> {
      is_making.count_down();
      may_end.get_future().wait();
      return Fail(ErrorCode::kCancelled, "cancelled");
    });
  });
  is_making.wait();
  auto second = std::async(std::launch::async, [&] {
    return GetUnlessCancelled(cache, "a", second_stays, []() -> Expected<int> { return 2; });
  });
  first_left.Cancel();
  may_end.set_value();
  EXPECT_EQ(first.get().error().code, ErrorCode::kCancelled);
  EXPECT_EQ(**second.get(), 2);
}

}  // namespace
}  // namespace victorious
