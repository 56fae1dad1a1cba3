#include "victorious/base/file_roots.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::Not;

class FileRootsTest : public ::testing::Test {
 protected:
  FileRootsTest() {
    for (const char* name : {"videos", "videos/.hidden", "other"}) fs::create_directories(folder_ / name);
    for (const char* name : {"videos/a.mp4", "videos/.b.mp4", "videos/.hidden/c.mp4", "videos/server.key",
                             "other/d.mp4", "videos-2.mp4"}) {
      std::ofstream(folder_ / name) << name;
    }
  }

  testing::ScratchFolder folder_;
  FileRoots roots_{{folder_ / "videos", folder_ / "later"}, {folder_ / "videos/server.key"}};
};

TEST_F(FileRootsTest, HasWhatLiesBelow) {
  EXPECT_TRUE(roots_.Has(folder_ / "videos/a.mp4"));
  EXPECT_TRUE(roots_.Has(folder_ / "videos"));
  EXPECT_TRUE(roots_.Has(folder_ / "videos/../videos/a.mp4"));
  EXPECT_TRUE(roots_.Has(folder_ / "videos/absent/b.mp4"));
  EXPECT_TRUE(roots_.Has(folder_ / "later/b.mp4")) << "a folder that is made later";
  for (const char* outside :
       {"other/d.mp4", "videos-2.mp4", "videos/../other/d.mp4", "videos/../absent", "", "videos/.."}) {
    EXPECT_FALSE(roots_.Has(folder_ / outside)) << outside;
  }
  EXPECT_FALSE(roots_.Has("/etc/passwd"));
  EXPECT_FALSE(roots_.Has("http://host/a.mp4"));
  EXPECT_FALSE(FileRoots(std::vector<fs::path>{}).Has(folder_ / "videos/a.mp4"));
  EXPECT_TRUE(FileRoots().Has("/etc/passwd"));
}

TEST_F(FileRootsTest, HasNothingHiddenOrSecret) {
  EXPECT_FALSE(roots_.Has(folder_ / "videos/.b.mp4"));
  EXPECT_FALSE(roots_.Has(folder_ / "videos/.hidden/c.mp4"));
  EXPECT_FALSE(roots_.Has(folder_ / "videos/server.key"));
  EXPECT_TRUE(FileRoots({folder_ / "videos/.hidden"}).Has(folder_ / "videos/.hidden/c.mp4"))
      << "a folder that was named itself";
  EXPECT_TRUE(FileRoots({folder_ / "other/d.mp4"}).Has(folder_ / "other/d.mp4")) << "a file that was named itself";
}

TEST_F(FileRootsTest, FollowsLinksThatStayBelow) {
  fs::create_symlink(folder_ / "videos/a.mp4", folder_ / "videos/inside.mp4");
  fs::create_symlink(folder_ / "other/d.mp4", folder_ / "videos/outside.mp4");
  fs::create_symlink("..", folder_ / "videos/up");
  fs::create_symlink("server.key", folder_ / "videos/key.mp4");
  fs::create_symlink("videos", folder_ / "alias");
  EXPECT_TRUE(roots_.Has(folder_ / "videos/inside.mp4"));
  EXPECT_TRUE(roots_.Has(folder_ / "alias/a.mp4"));
  EXPECT_TRUE(FileRoots({folder_ / "alias"}).Has(folder_ / "videos/a.mp4"));
  EXPECT_FALSE(roots_.Has(folder_ / "videos/outside.mp4"));
  EXPECT_FALSE(roots_.Has(folder_ / "videos/up/other/d.mp4"));
  EXPECT_FALSE(roots_.Has(folder_ / "videos/key.mp4"));
}

TEST_F(FileRootsTest, SaysTheSameOfWhatIsNotThere) {
  const Status there = roots_.Check(folder_ / "other/d.mp4");
  fs::remove(folder_ / "other/d.mp4");
  const Status absent = roots_.Check(folder_ / "other/d.mp4");
  ASSERT_FALSE(there);
  ASSERT_FALSE(absent);
  EXPECT_EQ(there.error().code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(there.error().message, absent.error().message);
  EXPECT_THAT(there.error().message, HasSubstr("--videos"));
  EXPECT_THAT(there.error().message, Not(HasSubstr(folder_.path().string())));
}

TEST_F(FileRootsTest, AnOpenFileStaysTheSame) {
  const auto file = roots_.Open(folder_ / "videos/a.mp4");
  ASSERT_TRUE(file) << file.error().message;
  fs::remove(folder_ / "videos/a.mp4");
  fs::create_symlink(folder_ / "other/d.mp4", folder_ / "videos/a.mp4");
  std::ifstream stream(file->path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "videos/a.mp4");
  EXPECT_EQ(roots_.Open(folder_ / "videos/a.mp4").error().code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(roots_.Open(folder_ / "videos").error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(roots_.Open(folder_ / "videos/absent").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace victorious
