#include "victorious/input/video/video_probe.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"

namespace victorious {
namespace {

TEST(BeginsAsVideo, RecognisesVideosAndImages) {
  const testing::ScratchFolder folder;
  for (const char* name : {"a.mp4", "a.mkv", "a.ts", "a.avi"}) {
    const char* const muxer = std::strstr(name, "mkv") != nullptr   ? "matroska"
                              : std::strstr(name, ".ts") != nullptr ? "mpegts"
                              : std::strstr(name, "avi") != nullptr ? "avi"
                                                                    : "mp4";
    testing::WriteTestVideo(folder / name, {.muxer = muxer, .size = {64, 48}, .pts = testing::SteadyTimes(20, 1)});
    EXPECT_TRUE(BeginsAsVideo(folder / name)) << name;
    std::filesystem::rename(folder / name, folder / "server.key");
    EXPECT_TRUE(BeginsAsVideo(folder / "server.key")) << "by the content, not by the name";
  }
  for (const char* name : {"a.png", "a.jpg"}) {
    cv::imwrite(folder / name, cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(90)));
    EXPECT_TRUE(BeginsAsVideo(folder / name)) << name;
  }
}

TEST(BeginsAsVideo, RefusesOtherFiles) {
  const testing::ScratchFolder folder;
  const std::string base64 = "MIGHAgEAMBMGByqGSM49AgEGCCqGSM49AwEHBG0wawIBAQQg7kFJx0Zp4Yh2mUS2qhQ6\n";
  std::string key = "-----BEGIN PRIVATE KEY-----\n";
  for (int i = 0; i < 24; ++i) key += base64;
  std::string der(1200, '\0');
  for (std::size_t i = 0; i < der.size(); ++i) der[i] = static_cast<char>(i * i * 31 + i * 7);
  der.replace(0, 4, "\x30\x82\x04\xa4");
  const std::pair<const char*, std::string> files[] = {
      {"key.mp4", key + "-----END PRIVATE KEY-----\n"},
      {"der.mp4", der},
      {"passwd.mp4", "root:x:0:0:root:/root:/bin/bash\ndaemon:x:1:1:daemon:/usr/sbin:/usr/sbin/nologin\n"},
      {"index.mp4", std::string("SQLite format 3\0\x10\0\1\1\0@  ", 24) + std::string(4000, 'x')},
      {"table.mp4", "time_s,latitude_deg,longitude_deg\n0,52,13\n"},
      {"list.mp4", "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:9,\nfile:///etc/passwd\n"},
      {"empty.mp4", ""},
      {"text.mp4", "a line\n"}};
  for (const auto& [name, content] : files) {
    std::ofstream(folder / name, std::ios::binary) << content;
    EXPECT_FALSE(BeginsAsVideo(folder / name)) << name;
  }
  EXPECT_FALSE(BeginsAsVideo(folder / "absent.mp4"));
  EXPECT_FALSE(BeginsAsVideo(folder.path()));
}

}  // namespace
}  // namespace victorious
