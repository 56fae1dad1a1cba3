#include "victorious/store/postgres/text.h"

#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious::postgres {
namespace {

TEST(PostgresText, ValidTextIsItself) {
  for (const std::string text : {"", "a.mp4", "Übung \xE2\x82\xAC \xF0\x9F\x9B\xA9", "\xEE\x80\x80 \xF4\x8F\xBB\xBF"}) {
    EXPECT_EQ(EncodeText(text), text);
    EXPECT_EQ(DecodeText(text), text);
  }
}

TEST(PostgresText, RefusedBytesBecomeCharacters) {
  EXPECT_EQ(EncodeText(std::string("a\0b", 3)),
            "a\xF4\x8F\xBC\x80"
            "b");
  EXPECT_EQ(EncodeText("\xFF"), "\xF4\x8F\xBF\xBF");
  EXPECT_EQ(EncodeText("\xC3"), "\xF4\x8F\xBF\x83") << "a character that is cut off";
  EXPECT_EQ(EncodeText("\xED\xA0\x80").size(), 12U) << "a surrogate";
  EXPECT_EQ(EncodeText("\xC0\x80").size(), 8U) << "an overlong NUL";
  EXPECT_EQ(EncodeText("\xF4\x8F\xBC\x80").size(), 16U) << "a character that stands for a byte";
}

// Law: DecodeText is the inverse of EncodeText for any bytes, and encoding its result again finds nothing to refuse.
TEST(PostgresText, AnyBytesRoundTrip) {
  Random random(20260);
  constexpr std::string_view kBytes(
      "\x00"
      "aé\x80\x8F\xBC\xBF\xC3\xE0\xED\xA0\xF0\xF4\x90\xFF",
      16);
  for (int round = 0; round < 20'000; ++round) {
    std::string bytes(random.Below(12), ' ');
    for (char& byte : bytes) byte = kBytes[random.Below(kBytes.size())];
    const std::string text = EncodeText(bytes);
    ASSERT_EQ(DecodeText(text), bytes) << round;
    ASSERT_EQ(text.find('\0'), std::string::npos) << round;
  }
}

}  // namespace
}  // namespace victorious::postgres
