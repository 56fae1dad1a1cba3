#include "victorious/apps/serve/object_key.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

const VideoRecord kVideo{.content_id = "live rtsp://ann:secret@camera/1 17"};
const SightingRecord kSighting{.time_s = 1.5, .box = {40.4, -30.2, 100, 60}};

TEST(ObjectKey, ComesBackAsItWasWritten) {
  const std::string key = FormatObjectKey(kVideo, kSighting, "vehicle/car.v2");
  EXPECT_EQ(key.find("secret"), std::string::npos);
  const auto keyed = ParseObjectKey(key);
  ASSERT_TRUE(keyed) << key;
  EXPECT_EQ(keyed->time_us, 1'500'000);
  EXPECT_EQ(keyed->box, (Box{40, -30, 100, 60}));
  EXPECT_EQ(keyed->model, "vehicle/car.v2");
  EXPECT_TRUE(keyed->IsIn(kVideo));
  EXPECT_FALSE(keyed->IsIn({.content_id = "other"}));
}

TEST(ObjectKey, FindsASightingThatMovedALittle) {
  const auto keyed = ParseObjectKey(FormatObjectKey(kVideo, kSighting, "jeep"));
  ASSERT_TRUE(keyed);
  EXPECT_TRUE(keyed->IsAt(kSighting));
  EXPECT_TRUE(keyed->IsAt({.time_s = 1.5, .box = {45, -28, 100, 62}}));
  EXPECT_FALSE(keyed->IsAt({.time_s = 1.5, .box = {120, -28, 100, 62}}));
  EXPECT_FALSE(keyed->IsAt({.time_s = 1.6, .box = kSighting.box}));
}

TEST(ObjectKey, OtherTextsAreNoKeys) {
  for (const char* text :
       {"", "7", ".", "0123456789abcdef.1.2.3.4.5", "0123456789abcdef.1.2.3.4.5.", "x.1.2.3.4.5.jeep",
        "0123456789abcdef.-1.2.3.4.5.jeep", "0123456789abcdef.1.2.3.4.99999999999.jeep",
        "f123456789abcdef0.1.2.3.4.5.jeep", "0123456789abcdef.1.2.3.4. 5.jeep"}) {
    EXPECT_FALSE(ParseObjectKey(text)) << text;
  }
}

}  // namespace
}  // namespace victorious
