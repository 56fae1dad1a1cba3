#include "victorious/apps/serve/account_quota.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(AccountQuota, LimitsEachAccountAndAll) {
  AccountQuota quota("jobs", {.in_all = 5, .an_account = 2});
  std::set<std::string> present;
  const auto add = [&](const std::string& id, const std::string& account) {
    const Status status = quota.Check(present, account);
    if (!status) return status.error().message;
    quota.Add(id, account);
    present.insert(id);
    return std::string();
  };
  EXPECT_EQ(add("1", "ann"), "");
  EXPECT_EQ(add("2", "ann"), "");
  EXPECT_THAT(add("3", "ann"), HasSubstr("the account ann has 2 jobs already"));
  EXPECT_EQ(add("4", "bob"), "");
  EXPECT_EQ(add("5", ""), "") << "nobody in particular has no limit of an own";
  EXPECT_EQ(add("6", ""), "");
  EXPECT_THAT(add("7", "bob"), HasSubstr("there are 5 jobs already"));
  present.erase("1");
  EXPECT_EQ(add("8", "ann"), "") << "one has ended";
}

}  // namespace
}  // namespace victorious
