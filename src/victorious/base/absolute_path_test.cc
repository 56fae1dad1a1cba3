#include "victorious/base/absolute_path.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(AbsolutePath, IsNormal) {
  EXPECT_EQ(AbsolutePath("/videos/./town/../flight.mp4"), "/videos/flight.mp4");
  EXPECT_EQ(AbsolutePath("flight.mp4"), (std::filesystem::current_path() / "flight.mp4").string());
}

TEST(AbsolutePath, OfNoneIsEmpty) { EXPECT_EQ(AbsolutePath(""), ""); }

}  // namespace
}  // namespace victorious
