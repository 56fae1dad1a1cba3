#include "victorious/apps/serve/source_guard.h"

#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(HostOfSource, IsThatOfTheAddress) {
  EXPECT_EQ(HostOfSource("rtsp://ann:pass@192.0.2.7:554/a@b"), "192.0.2.7");
  EXPECT_EQ(HostOfSource("rtsp://x@y@camera.example.org/1"), "camera.example.org");
  EXPECT_EQ(HostOfSource("srt://[fe80::1]:9000?mode=caller"), "fe80::1");
  EXPECT_EQ(HostOfSource("udp://@239.0.0.1:1234"), "239.0.0.1");
  EXPECT_EQ(HostOfSource("udp://:1234"), "");
  EXPECT_EQ(HostOfSource("camera"), "");
}

TEST(CheckSource, RefusesThisMachineAndLinkLocalAddresses) {
  for (const char* const url :
       {"rtsp://127.0.0.1:22/", "rtsp://127.9.9.9/", "rtsp://2130706433/", "rtsp://0x7f.1/", "rtsp://localhost:80/",
        "rtsp://169.254.169.254/latest", "rtsp://a:b@0.0.0.0/", "srt://[::1]:1", "srt://[::ffff:127.0.0.1]:1",
        "srt://[fe80::1]:1", "srt://[::]:1", "rtsp://there-is-none.invalid/", "rtsp://:8554/a", "srt://:9000"}) {
    const Status status = CheckSource(url, {});
    ASSERT_FALSE(status) << url;
    EXPECT_EQ(status.error(), CheckSource("rtsp://127.0.0.1/", {}).error()) << "the same words for all";
  }
  for (const char* const url : {"rtsp://192.0.2.7:554/", "rtsp://10.1.2.3/", "udp://:1234", "udp://0.0.0.0:5600",
                                "udp://@239.1.2.3:1234", "srt://:9000?mode=listener", "srt://[2001:db8::1]:9"}) {
    EXPECT_TRUE(CheckSource(url, {})) << url;
  }
}

TEST(CheckSource, TakesListedHostsOnly) {
  const std::vector<std::string> allowed = {"192.0.2.7", "Camera.local", "127.0.0.1"};
  for (const char* const url : {"rtsp://192.0.2.7/", "rtsp://camera.LOCAL/", "rtsp://127.0.0.1/"}) {
    EXPECT_TRUE(CheckSource(url, allowed)) << url;
  }
  for (const char* const url : {"rtsp://192.0.2.8/", "udp://:1234", "rtsp://localhost/", "rtsp://192.0.2.7.example/"}) {
    EXPECT_FALSE(CheckSource(url, allowed)) << url;
  }
}

}  // namespace
}  // namespace victorious
