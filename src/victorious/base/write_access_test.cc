#include "victorious/base/write_access.h"

#include <cerrno>

#include <gtest/gtest.h>

#include "testing/data.h"

namespace victorious {
namespace {

TEST(IsWritable, SaysWhyNot) {
  const testing::ScratchFolder folder;
  EXPECT_TRUE(IsWritable(folder.path()));
  errno = 0;
  EXPECT_FALSE(IsWritable(folder / "absent"));
  EXPECT_EQ(errno, ENOENT);
}

}  // namespace
}  // namespace victorious
