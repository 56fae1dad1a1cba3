#include "victorious/apps/serve/waiting_connections.h"

#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(WaitingConnections, OldestIsClosedFirst) {
  std::vector<std::string> closed;
  WaitingConnections waiting;
  EXPECT_FALSE(waiting.CloseOldest());
  const auto add = [&](const std::string& client, const std::string& name) {
    return waiting.Add({client, [&closed, name] { closed.push_back(name); }});
  };
  const auto first = add("a", "first");
  [[maybe_unused]] const auto second = add("a", "second");
  [[maybe_unused]] const auto third = add("b", "third");
  [[maybe_unused]] const auto fourth = add("a", "fourth");
  waiting.Remove(first);
  EXPECT_TRUE(waiting.CloseOldestOf("b"));
  EXPECT_FALSE(waiting.CloseOldestOf("b"));
  EXPECT_TRUE(waiting.CloseOldest());
  EXPECT_TRUE(waiting.CloseOldest());
  EXPECT_FALSE(waiting.CloseOldest());
  EXPECT_EQ(closed, (std::vector<std::string>{"third", "second", "fourth"}));
}

}  // namespace
}  // namespace victorious
