#include "victorious/base/credentials.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(WithoutCredentials, LeavesTheRest) {
  for (const auto& [text, shown] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", ""},
           {"/videos/a@b.mp4", "/videos/a@b.mp4"},
           {"rtsp://host/a@b", "rtsp://host/a@b"},
           {"rtsp://ann@host", "rtsp://host"},
           {"rtsp://ann:p@ss@host:554/one?x=1@2", "rtsp://host:554/one?…"},
           {"srt://host:1?passphrase=abc: no packet", "srt://host:1?… no packet"},
           {"postgresql://ann@host/db?sslmode=require: no rtsp://b:c@d",
            "postgresql://ann@host/db?sslmode=require: no rtsp://d"},
           {"udp://@239.0.0.1:5000: no packet, srt://b:c@d", "udp://239.0.0.1:5000: no packet, srt://d"},
       }) {
    EXPECT_EQ(WithoutCredentials(text), shown);
  }
}

}  // namespace
}  // namespace victorious
