#include "victorious/base/missing_path.h"

#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

TEST(MissingPathTest, AFileIsNoFolderAndNotNothing) {
  const testing::ScratchFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "file", std::string_view("x")));
  EXPECT_TRUE(CheckIsFolder(folder.path(), "make one"));
  const Status file = CheckIsFolder(folder / "file", "make one");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(file.error().message, (folder / "file").string() + ": a file, not a folder: make one");
  for (const auto& path : {folder / "none", folder / "file" / "below"}) {
    const Status none = CheckIsFolder(path, "make one");
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::kNotFound);
    EXPECT_EQ(none.error().message, path.string() + ": no such folder: make one");
  }
  EXPECT_EQ(NoSuchFile("a.db", "make one").message, "a.db: no such file: make one");
}

}  // namespace
}  // namespace victorious
