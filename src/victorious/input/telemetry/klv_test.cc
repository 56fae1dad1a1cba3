#include "victorious/input/telemetry/klv.h"

#include <gtest/gtest.h>

#include "testing/klv_tools.h"

namespace victorious {
namespace {

using testing::kSt0601LabelBytes;
using testing::St0601Packet;

TEST(Klv, BerLengthsShortAndLong) {
  const std::string text = "\x05\x81\xC8\x82\x01\x00" + std::string("\x8A\0\0\0\0\0\0\0\0\0\x07", 11);
  Bytes bytes = AsBytes(std::string_view("\x05\x81\xC8\x82\x01\x00", 6));
  EXPECT_EQ(TakeBerLength(bytes), 5U);
  EXPECT_EQ(TakeBerLength(bytes), 200U);
  EXPECT_EQ(TakeBerLength(bytes), 256U);
  EXPECT_EQ(TakeBerLength(bytes), std::nullopt);
  Bytes padded = AsBytes(text).last(11);
  EXPECT_EQ(TakeBerLength(padded), 7U) << "leading zeros are ignored";
}

TEST(Klv, RefusesInvalidLengths) {
  for (const std::string_view text : {std::string_view("\x80", 1), std::string_view("\x84\x01", 2),
                                      std::string_view("\x89\x01\0\0\0\0\0\0\0\0", 10)}) {
    Bytes bytes = AsBytes(text);
    EXPECT_EQ(TakeBerLength(bytes), std::nullopt) << HexText(AsBytes(text));
  }
}

TEST(Klv, BerObjectIdentifiers) {
  Bytes bytes = AsBytes("\x0D\x81\x0A");
  EXPECT_EQ(TakeBerOid(bytes), 13U);
  EXPECT_EQ(TakeBerOid(bytes), 138U);
  Bytes endless = AsBytes("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF");
  EXPECT_EQ(TakeBerOid(endless), std::nullopt);
}

TEST(Klv, SignedIntegersOfAnyLength) {
  EXPECT_EQ(ReadSigned(AsBytes("\xFF")), -1);
  EXPECT_EQ(ReadSigned(AsBytes("\x7F\xFF")), 32767);
  EXPECT_EQ(ReadSigned(AsBytes("\xFF\xFF\xFE")), -2);
  EXPECT_EQ(ReadSigned(AsBytes("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFD")), -3);
  EXPECT_EQ(ReadSigned({}), 0);
}

TEST(Klv, FindsUnitsBetweenOtherBytes) {
  const std::string packet = St0601Packet({{65, "\x13"}});
  const std::string text = "head" + packet + "\x01\x02\x03" + packet;
  const KlvUnits found = SplitKlv(AsBytes(text));
  ASSERT_EQ(found.units.size(), 2U);
  EXPECT_EQ(found.units[0].offset, 4U);
  EXPECT_EQ(found.units[1].whole.size(), packet.size());
  EXPECT_TRUE(found.warnings.empty());
}

TEST(Klv, ContinuesAfterAnOverlongUnit) {
  const std::string lying = std::string(kSt0601LabelBytes) + "\x82\xFF\xFF";
  const std::string whole = St0601Packet({{65, "\x13"}});
  const KlvUnits found = SplitKlv(AsBytes(lying + whole));
  ASSERT_EQ(found.units.size(), 1U);
  EXPECT_EQ(found.units[0].offset, lying.size());
  const std::vector<std::string> warnings = found.warnings.Lines();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("65535 bytes"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace victorious
