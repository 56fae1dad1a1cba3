#include "victorious/apps/serve/static_files.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/video_tools.h"

namespace victorious {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

class StaticFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "web/assets");
    testing::WriteBytes(folder_ / "web/index.html", "<p>page</p>");
    testing::WriteBytes(folder_ / "web/assets/a.js", "run()");
    testing::WriteBytes(folder_ / "secret.txt", "secret");
  }

  testing::ScratchFolder folder_;
};

TEST_F(StaticFilesTest, SendsFilesOfItsFolder) {
  const StaticFiles files(folder_ / "web");
  const HttpResponse page = files.Get({}, {});
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.content_type, "text/html; charset=utf-8");
  EXPECT_EQ(page.file->length, 11);
  const HttpResponse script = files.Get({}, {"assets", "a.js"});
  EXPECT_EQ(script.content_type, "text/javascript; charset=utf-8");
  EXPECT_THAT(script.headers, Contains(Pair("Cache-Control", HasSubstr("immutable"))));
}

TEST_F(StaticFilesTest, SendsNothingFromOutside) {
  std::filesystem::create_symlink(folder_ / "secret.txt", folder_ / "web/link.txt");
  const StaticFiles files(folder_ / "web");
  EXPECT_EQ(files.Get({}, {"link.txt"}).status, 404);
  EXPECT_EQ(files.Get({}, {"..", "secret.txt"}).status, 404);
  EXPECT_EQ(files.Get({}, {"assets"}).status, 404) << "a folder";
  EXPECT_EQ(files.Get({}, {"none.js"}).status, 404);
}

TEST_F(StaticFilesTest, SaysHowToBuildThePage) {
  const StaticFiles files("");
  EXPECT_THAT(files.Get({}, {}).body, HasSubstr("make build"));
  EXPECT_EQ(files.Get({}, {"assets", "a.js"}).status, 404);
}

}  // namespace
}  // namespace victorious
