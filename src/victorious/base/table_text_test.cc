#include "victorious/base/table_text.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

std::string Utf16(std::string_view text, bool big_endian) {
  std::string bytes;
  for (const char c : text) bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

TEST(TableText, SemicolonsTabsAndDecimalCommasBecomeOneForm) {
  const std::string plain = "time_s,name,height_m\n0.5,x,-12.25\n1,,3e2\n";
  EXPECT_EQ(CommaSeparated(plain), plain);
  EXPECT_EQ(CommaSeparated("time_s;name;height_m\n0.5;x;-12.25\n1;;3e2\n"), plain);
  EXPECT_EQ(CommaSeparated("time_s;name;height_m\r\n0,5;x;-12,25\r\n1;;3e2\r\n"), plain);
  EXPECT_EQ(CommaSeparated("time_s\tname\theight_m\n0.5\tx\t-12.25\n1\t\t3e2"), plain);
  EXPECT_EQ(CommaSeparated("sep=;\ntime_s;name;height_m\n0,5;x;-12,25\n1;;3e2\n"), "\n" + plain) << "the same lines";
  EXPECT_EQ(CommaSeparated("sep=,\n" + plain), "\n" + plain);
}

TEST(TableText, TextsKeepTheirCommas) {
  EXPECT_EQ(CommaSeparated("a;b\n\"x;\"\"y\"\"\";one, two, 3\n"), "a,b\n\"x;\"\"y\"\"\",\"one, two, 3\"\n");
}

TEST(TableText, Utf16IsUtf8) {
  for (const bool big_endian : {false, true}) {
    const std::string bytes = Utf16("time_s,x\n0.5,1\n", big_endian);
    EXPECT_EQ(CommaSeparated((big_endian ? "\xFE\xFF" : "\xFF\xFE") + bytes), "time_s,x\n0.5,1\n");
    EXPECT_EQ(CommaSeparated(bytes), "time_s,x\n0.5,1\n") << "without a byte order mark";
  }
  EXPECT_EQ(Utf8FromText("\xEF\xBB\xBF"
                         "abc"),
            "abc");
  EXPECT_EQ(Utf8FromText(std::string("\xFF\xFE\xE9\x00\x3D\xD8\x00\xDE\x3D\xD8\x41\x00\x41", 13)),
            "\xC3\xA9\xF0\x9F\x98\x80\xEF\xBF\xBD"
            "A");
}

}  // namespace
}  // namespace victorious
