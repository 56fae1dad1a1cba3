#include "victorious/apps/serve/video_roots.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/video_tools.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::Not;

class VideoRootsTest : public ::testing::Test {
 protected:
  VideoRootsTest() {
    for (const char* name : {"index", "flights", "elsewhere"}) fs::create_directories(folder_ / name);
    testing::WriteTestVideo(folder_ / "flights/a.mp4", {.pts = testing::SteadyTimes(3, 100)});
    fs::copy_file(folder_ / "flights/a.mp4", folder_ / "elsewhere/b.mp4");
    fs::copy_file(folder_ / "flights/a.mp4", folder_ / "index/c.mp4");
    for (const char* name : {"flights/key.pem", "elsewhere/key.pem", "flights/t.csv", "elsewhere/t.csv"}) {
      std::ofstream(folder_ / name) << "-----BEGIN PRIVATE KEY-----\n";
    }
  }

  [[nodiscard]] VideoRecord Named(const std::string& name, const std::string& in = "") const {
    return {.name = name.starts_with('/') ? (folder_.path().string() + name) : name,
            .folder = in.empty() ? "" : (folder_ / in).string()};
  }

  testing::ScratchFolder folder_;
  VideoRoots roots_{FileRoots({folder_ / "index", folder_ / "flights"}), folder_ / "index/index.db"};
};

TEST_F(VideoRootsTest, FindsVideosBelowTheRoots) {
  EXPECT_EQ(*roots_.Find(Named("/flights/a.mp4")), folder_ / "flights/a.mp4");
  EXPECT_EQ(*roots_.Find(Named("a.mp4", "flights")), folder_ / "flights/a.mp4");
  EXPECT_EQ(*roots_.Find(Named("c.mp4")), folder_ / "index/c.mp4") << "from the index's folder";
  EXPECT_EQ(*roots_.Find(Named("c.mp4", "elsewhere")), folder_ / "index/c.mp4")
      << "the index was moved with its videos";
  EXPECT_EQ(roots_.Find(Named("/flights/absent.mp4")).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(roots_.Find(Named("rtsp://host/camera")).error().code, ErrorCode::kUnsupported);
}

TEST_F(VideoRootsTest, RefusesOthersAndNamesTheFlag) {
  for (const VideoRecord& video :
       {Named("/elsewhere/b.mp4"), Named("/elsewhere/absent.mp4"), Named("b.mp4", "elsewhere"),
        Named("../elsewhere/b.mp4", "flights"), Named("/flights/../elsewhere/b.mp4")}) {
    const auto found = roots_.Find(video);
    ASSERT_FALSE(found) << video.name;
    EXPECT_EQ(found.error().code, ErrorCode::kPermissionDenied) << video.name;
    EXPECT_THAT(found.error().message, HasSubstr("--videos"));
    EXPECT_THAT(found.error().message, Not(HasSubstr(folder_.path().string())));
  }
}

TEST_F(VideoRootsTest, SendsOnlyVideosAndImages) {
  EXPECT_TRUE(roots_.Open(Named("/flights/a.mp4")));
  EXPECT_TRUE(roots_.Open(Named("/flights/a.mp4"))) << "as the first time";
  EXPECT_EQ(roots_.Open(Named("/flights/key.pem")).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(roots_.Open(Named("/elsewhere/key.pem")).error().code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(roots_.Open(Named("/flights")).error().code, ErrorCode::kUnsupported);
  // Another content under the same name is looked at again.
  fs::remove(folder_ / "flights/key.pem");
  fs::copy_file(folder_ / "flights/a.mp4", folder_ / "flights/key.pem");
  EXPECT_TRUE(roots_.Open(Named("/flights/key.pem")));
}

TEST_F(VideoRootsTest, ReadsTelemetryBelowTheRoots) {
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& line) { warnings.push_back(line); };
  VideoRecord video = Named("/flights/a.mp4");
  video.telemetry = folder_ / "flights/t.csv";
  EXPECT_EQ(roots_.Telemetry(video, warn), folder_ / "flights/t.csv");
  EXPECT_TRUE(warnings.empty());
  video.telemetry = folder_ / "elsewhere/t.csv";
  EXPECT_FALSE(roots_.Telemetry(video, warn));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], HasSubstr("--videos"));
}

TEST_F(VideoRootsTest, NamesTheFlagForVideosElsewhere) {
  EXPECT_EQ(roots_.DescribeOutside({Named("/flights/a.mp4"), Named("/flights/absent.mp4")}), "");
  const std::string said = roots_.DescribeOutside({Named("/flights/a.mp4"), Named("/elsewhere/b.mp4")});
  EXPECT_THAT(said, HasSubstr("1 of 2 videos"));
  EXPECT_THAT(said, HasSubstr("--videos " + (folder_ / "elsewhere").string()));
}

}  // namespace
}  // namespace victorious
