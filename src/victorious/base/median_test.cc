#include "victorious/base/median.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(Median, IsTheMiddleElement) {
  EXPECT_EQ(Median({5, -1, 3}), 3);
  EXPECT_EQ(Median({4, 1, 2, 3}), 3);
  EXPECT_EQ(Median({7}), 7);
}

TEST(Median, NoValuesHaveNone) {
  EXPECT_EQ(MedianOr({}, -2), -2);
  EXPECT_EQ(MedianOr({3}, -2), 3);
  EXPECT_DEATH(Median({}), "check failed");
}

}  // namespace
}  // namespace victorious
