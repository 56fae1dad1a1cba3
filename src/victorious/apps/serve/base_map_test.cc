#include "victorious/apps/serve/base_map.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/video_tools.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(ReadBaseMap, TakesAddressesOfTileServers) {
  const auto found = ReadBaseMap("https://tile.example.org:8443/a/{z}/{x}/{y}.png?key=1;2", "");
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->IsNone());
  EXPECT_EQ(found->origin, "https://tile.example.org:8443");
  EXPECT_EQ(found->url, "https://tile.example.org:8443/a/{z}/{x}/{y}.png?key=1;2");
  EXPECT_EQ(found->attribution, "Map: tile.example.org:8443");
  EXPECT_FALSE(found->is_vector);
  EXPECT_EQ(ReadBaseMap("http://127.0.0.1:9/{z}/{x}/{y}", "© us")->attribution, "© us");
  EXPECT_TRUE(BaseMap().IsNone());
}

// The host becomes a part of a header.
TEST(ReadBaseMap, RefusesWhatIsNoAddressOfTiles) {
  for (const char* url :
       {"https://a.org/{z}/{x}.png", "https://a.org/{z}/{x}/{y}/{y}", "https://{s}.a.org/{z}/{x}/{y}",
        "https:///{z}/{x}/{y}", "https://a.org;script-src *\n/{z}/{x}/{y}", "https://a b/{z}/{x}/{y}",
        "https://a.org;b/{z}/{x}/{y}", "https://ann:word@a.org/{z}/{x}/{y}", "ftp://a.org/{z}/{x}/{y}"}) {
    const auto found = ReadBaseMap(url, "");
    ASSERT_FALSE(found) << url;
    EXPECT_EQ(found.error().code, ErrorCode::kInvalidArgument) << url;
  }
  EXPECT_THAT(ReadBaseMap("https://a.org/{z}/{x}.png", "").error().message, HasSubstr("must have {y} once"));
}

TEST(ReadBaseMap, ReadsTheHeaderOfPmtilesFiles) {
  const testing::ScratchFolder folder;
  const auto path = folder / "map.pmtiles";
  std::string header("PMTiles\x03");
  header.resize(127);
  const auto read = [&](int type) {
    header[99] = static_cast<char>(type);
    header[101] = 14;
    testing::WriteBytes(path, header + "tiles");
    return ReadBaseMap(path.string(), "© us");
  };
  EXPECT_TRUE(read(1)->is_vector);
  EXPECT_EQ(read(1)->file, path);
  EXPECT_EQ(read(1)->max_zoom, 14);
  EXPECT_FALSE(read(2)->is_vector);
  EXPECT_FALSE(read(4)->is_vector);
  EXPECT_EQ(read(0).error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(read(5).error().message, HasSubstr("tiles of type 5"));
  for (const std::string& bytes : {std::string(), header.substr(0, 126), "PMTiles\x02" + header.substr(8)}) {
    testing::WriteBytes(path, bytes);
    EXPECT_EQ(ReadBaseMap(path.string(), "").error().code, ErrorCode::kUnsupported);
  }
  EXPECT_EQ(ReadBaseMap((folder / "none.pmtiles").string(), "").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ReadBaseMap(folder.path().string(), "").error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace victorious
