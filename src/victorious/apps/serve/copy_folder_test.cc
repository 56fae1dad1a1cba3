#include "victorious/apps/serve/copy_folder.h"

#include <fstream>
#include <set>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "testing/data.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

class CopyFolderTest : public ::testing::Test {
 protected:
  // A file that was used last so many seconds ago.
  void Put(const char* name, std::size_t bytes, int unused_s) {
    std::ofstream(folder_ / name) << std::string(bytes, 'x');
    timespec then{};
    ::clock_gettime(CLOCK_REALTIME, &then);
    then.tv_sec -= unused_s;
    const timespec times[2] = {then, then};
    ASSERT_EQ(::utimensat(AT_FDCWD, (folder_ / name).c_str(), times, 0), 0);
  }

  std::set<std::string> Left() {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) names.insert(entry.path().filename());
    return names;
  }

  testing::ScratchFolder folder_;
  CopyFolder copies_{folder_.path(), {.max_bytes = 250}};
};

TEST_F(CopyFolderTest, RemovesFilesThatNothingRefersTo) {
  for (const char* name : {"x-1.vcat", "x-2.vcat", "x-3.vcat", "x-4.vcat.tmp-7", "y-1.vcat"}) Put(name, 10, 100);
  Put("x-5.vcat", 10, 1);
  {
    const auto use = copies_.Take("x-3.vcat");
    Put("x-3.vcat", 10, 100);
    copies_.RemoveOthers("x-", {"x-1.vcat"});
    EXPECT_THAT(Left(), ElementsAre("x-1.vcat", "x-3.vcat", "x-4.vcat.tmp-7", "x-5.vcat", "y-1.vcat"));
  }
  copies_.RemoveOthers("x-", {});
  EXPECT_THAT(Left(), ElementsAre("x-4.vcat.tmp-7", "x-5.vcat", "y-1.vcat")) << "one was just made";
}

TEST_F(CopyFolderTest, RemovesFilesNotUsedForTheLongestTime) {
  Put("a.mp4", 100, 500);
  Put("b.mp4", 100, 800);
  Put("c.mp4", 100, 300);
  Put("d.mp4", 100, 400);
  for (const char* name : {"a.telemetry.csv", "c.telemetry.csv"}) Put(name, 900, 900);
  copies_.Trim();
  EXPECT_THAT(Left(), ElementsAre("c.mp4", "c.telemetry.csv", "d.mp4"));
  copies_.Trim();
  EXPECT_THAT(Left(), ElementsAre("c.mp4", "c.telemetry.csv", "d.mp4")) << "they take less than the limit";
}

TEST_F(CopyFolderTest, AFileThatIsTakenCountsAsUsedNow) {
  Put("a.mp4", 100, 900);
  Put("b.mp4", 100, 800);
  Put("c.mp4", 100, 700);
  const auto changed = std::filesystem::last_write_time(folder_ / "a.mp4");
  ASSERT_TRUE(copies_.Take("a.mp4")) << "and let go at once";
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "a.mp4"), changed) << "of which the entity tag is made";
  EXPECT_FALSE(copies_.Take("none.mp4"));
  copies_.Trim();
  EXPECT_THAT(Left(), ElementsAre("a.mp4", "c.mp4"));
}

TEST_F(CopyFolderTest, FilesThatAreSentOrMadeStay) {
  CopyFolder small(folder_.path(), {.max_bytes = 10, .in_use = std::chrono::seconds(0)});
  Put("a.mp4", 100, 900);
  Put("b.mp4", 100, 800);
  Put("c.mp4", 100, 700);
  Put("e.mp4.tmp-12", 100, 600);
  auto first = small.Take("a.mp4");
  auto second = small.Take("a.mp4");
  Put("a.mp4", 100, 900);
  first.reset();
  small.Trim();
  EXPECT_THAT(Left(), ElementsAre("a.mp4", "c.mp4", "e.mp4.tmp-12")) << "of those not held, the last one used stays";
  second.reset();
  small.Trim();
  EXPECT_THAT(Left(), ElementsAre("c.mp4", "e.mp4.tmp-12"));
}

TEST_F(CopyFolderTest, FilesUsedAMomentAgoStay) {
  CopyFolder small(folder_.path(), {.max_bytes = 10});
  for (const char* name : {"a.mp4", "b.mp4"}) Put(name, 100, 5);
  Put("c.mp4", 100, 65);
  small.Trim();
  EXPECT_THAT(Left(), ElementsAre("a.mp4", "b.mp4")) << "their players ask for the next range";
}

TEST(CopyFolder, AFolderThatIsNotThereIsEmpty) {
  const testing::ScratchFolder folder;
  CopyFolder copies(folder / "new", {});
  copies.Trim();
  EXPECT_FALSE(copies.Has("a.mp4"));
  ASSERT_TRUE(copies.Create());
  EXPECT_TRUE(std::filesystem::is_directory(folder / "new"));
}

}  // namespace
}  // namespace victorious
