#include "victorious/base/without_folders.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(WithoutFoldersTest, LeavesTheLastName) {
  EXPECT_EQ(WithoutFolders("/srv/my videos/a.mp4: damaged"), "a.mp4: damaged");
  EXPECT_EQ(WithoutFolders("start /usr/bin/x: no such file"), "start x: no such file");
  EXPECT_EQ(WithoutFolders(R"({"name":"/srv/a b/","reason":"/x/y.csv: cut"})"),
            R"({"name":"a b","reason":"y.csv: cut"})");
  EXPECT_EQ(WithoutFolders("--models=/srv/models"), "--models=models");
  EXPECT_EQ(WithoutFolders("/"), "/");
  EXPECT_EQ(WithoutFolders(""), "");
}

TEST(WithoutFoldersTest, KeepsWhatIsNoPath) {
  for (const char* const text : {"files are uploaded to /api/v1/uploads", "rtsp://camera.example.org/stream: refused",
                                 "3 / 4 of 20 km/h", "a/b.mp4: damaged"}) {
    EXPECT_EQ(WithoutFolders(text), text);
  }
}

}  // namespace
}  // namespace victorious
