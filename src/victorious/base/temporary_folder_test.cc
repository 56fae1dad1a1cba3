#include "victorious/base/temporary_folder.h"

#include <fstream>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(TemporaryFolder, IsGoneWithItsFiles) {
  std::filesystem::path path;
  {
    const auto folder = TemporaryFolder::Make();
    ASSERT_TRUE(folder);
    path = (*folder)->path();
    std::ofstream(path / "file") << "text";
    EXPECT_EQ(std::filesystem::status(path).permissions() & std::filesystem::perms::others_all,
              std::filesystem::perms::none);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(TemporaryFolder, EachIsItsOwn) {
  const auto one = TemporaryFolder::Make();
  const auto other = TemporaryFolder::Make();
  ASSERT_TRUE(one && other);
  EXPECT_NE((*one)->path(), (*other)->path());
}

}  // namespace
}  // namespace victorious
