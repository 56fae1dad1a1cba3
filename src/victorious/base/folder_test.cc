#include "victorious/base/folder.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

TEST(ListFolder, GivesWhatIsInItByName) {
  const testing::ScratchFolder folder;
  std::ofstream(folder.path() / "b") << "text";
  std::ofstream(folder.path() / "a") << "text";
  fs::create_directories(folder.path() / "c" / "below");
  fs::create_symlink("absent", folder.path() / "d");
  const auto paths = ListFolder(folder.path());
  ASSERT_TRUE(paths) << paths.error().message;
  EXPECT_THAT(*paths, ::testing::ElementsAre(folder.path() / "a", folder.path() / "b", folder.path() / "c",
                                             folder.path() / "d"));
  EXPECT_THAT(ListFolder(folder.path() / "c" / "below").value(), ::testing::IsEmpty());
}

TEST(ListFolder, SaysWhyThereIsNone) {
  const testing::ScratchFolder folder;
  std::ofstream(folder.path() / "file") << "text";
  const auto absent = ListFolder(folder.path() / "absent");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(absent.error().message, ::testing::StartsWith((folder.path() / "absent").string() + ": "));
  EXPECT_EQ(ListFolder(folder.path() / "file").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ListFolder(folder.path() / std::string(5000, 'x')).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace victorious
