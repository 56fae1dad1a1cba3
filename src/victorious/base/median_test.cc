#include "victorious/base/median.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(Median, IsTheMiddleElement) {
  EXPECT_EQ(Median({5, -1, 3}), 3);
  EXPECT_EQ(Median({4, 1, 2, 3}), 3);
  EXPECT_EQ(Median({7}), 7);
  EXPECT_EQ(Median({}), 0);
}

}  // namespace
}  // namespace victorious
