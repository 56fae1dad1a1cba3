#include "victorious/input/telemetry/st0601.h"

#include <cmath>

#include <gtest/gtest.h>

#include "testing/klv_tools.h"
#include "victorious/input/telemetry/klv_packets.h"

namespace victorious {
namespace {

using testing::BerLength;
using testing::BigEndian;
using testing::CameraPacket;
using testing::kSt0601LabelBytes;
using testing::St0601Packet;

KlvPacket DecodeSet(const std::string& text) {
  const KlvPackets decoded = DecodeKlv(AsBytes(text));
  EXPECT_EQ(decoded.packets.size(), 1U);
  return decoded.packets.empty() ? KlvPacket() : decoded.packets[0];
}

TEST(St0601, ItemsByNumberNameAndUnit) {
  const KlvPacket packet =
      DecodeSet(St0601Packet({{3, "MISSION01"}, {5, BigEndian(0x71C2, 2)}, {13, BigEndian(0x5595B66D, 4)}}));
  ASSERT_EQ(packet.items.size(), 4U);
  EXPECT_EQ(std::get<std::string>(packet.items[0].value), "MISSION01");
  EXPECT_EQ(packet.items[1].name, "Platform Heading Angle");
  EXPECT_EQ(packet.items[1].unit, "deg");
  EXPECT_NEAR(*packet.Number(5), 159.974365, 1e-6);
  EXPECT_NEAR(*packet.Number(13), 60.176822966978335, 1e-13);
  ASSERT_TRUE(packet.checksum);
  EXPECT_TRUE(packet.checksum->IsValid());
  EXPECT_TRUE(packet.problem.empty());
}

TEST(St0601, ItemsBeyondTheLimitAreReportedAsSuch) {
  const KlvPacket packet = DecodeSet(St0601Packet(std::vector<std::pair<int, std::string>>(5000, {65, "\x13"})));
  EXPECT_EQ(packet.items.size(), 4096U);
  EXPECT_EQ(packet.problem, "more than 4096 items: the others, from byte 12288 of 15004 on, are not decoded");
}

TEST(St0601, MappingFollowsTheGivenLength) {
  EXPECT_EQ(*DecodeSet(St0601Packet({{18, "\xFF"}})).Number(18), 360);
  EXPECT_EQ(*DecodeSet(St0601Packet({{13, "\x7F\xFF\xFF"}})).Number(13), 90);
  EXPECT_EQ(*DecodeSet(St0601Packet({{13, "\x80\x01"}})).Number(13), -90);
}

TEST(St0601, LeadingZerosDoNotChangeTheMapping) {
  EXPECT_NEAR(*DecodeSet(St0601Packet({{22, BigEndian(457, 4)}})).Number(22), 69.73, 0.01);
  EXPECT_EQ(*DecodeSet(St0601Packet({{22, BigEndian(0xFFFFFFFF, 4)}})).Number(22), 10000);
}

TEST(St0601, LowestSignedNumberIsNoValue) {
  const KlvPacket packet = DecodeSet(St0601Packet({{6, BigEndian(0x8000, 2)}}));
  EXPECT_FALSE(packet.Number(6));
  EXPECT_FALSE(packet.items[0].note.empty());
}

TEST(St0601, Imapb) {
  EXPECT_NEAR(*ImapbValue(AsBytes(std::string_view("\x00\x00\x00", 3)), -900, 19000), -900, 1e-9);
  EXPECT_NEAR(*ImapbValue(AsBytes(std::string_view("\x03\x8E\x00", 3)), -900, 19000), 10, 1e-12);
  // Zero maps exactly if it is within the range: item 117, 1 degree per second in two bytes.
  EXPECT_NEAR(*DecodeSet(St0601Packet({{117, BigEndian(0x3E90, 2)}})).Number(117), 1.0, 1e-12);
  EXPECT_FALSE(ImapbValue(AsBytes(std::string_view("\xC8\x00", 2)), 0, 100)) << "plus infinity";
  EXPECT_FALSE(ImapbValue(AsBytes(std::string_view("\xD0\x00", 2)), 0, 100)) << "not a number";
}

TEST(St0601, ListsOfBitsAndIdentifiers) {
  const KlvPacket packet = DecodeSet(St0601Packet({{47, "\x31"}, {116, "\x03\x07"}, {81, "\x01\x02\x03\x04"}}));
  EXPECT_EQ(std::get<KlvList>(packet.items[0].value), (KlvList{0, 4, 5}));
  EXPECT_EQ(std::get<KlvList>(packet.items[1].value), (KlvList{3, 7}));
  EXPECT_EQ(std::get<KlvList>(packet.items[2].value), (KlvList{1, 2, 3, 4}));
}

// A local set of one item.
std::string Set(int number, const std::string& bytes) {
  return std::string(1, static_cast<char>(number)) + BerLength(bytes.size()) + bytes;
}

TEST(St0601, NestedSetsAndUnknownNumbersStayBytes) {
  const KlvPacket packet = DecodeSet(St0601Packet({{48, "\x01\x01\x03"}, {200, "\x09"}, {65, "\x13"}}));
  EXPECT_EQ(HexText(std::get<KlvRaw>(packet.items[0].value)), "010103");
  EXPECT_TRUE(packet.items[0].is_set);
  EXPECT_EQ(packet.items[0].note, "a set of 1 items; not decoded");
  EXPECT_FALSE(packet.items[1].is_set);
  EXPECT_EQ(packet.items[1].number, 200);
  EXPECT_EQ(packet.items[1].name, "unknown");
  EXPECT_EQ(*packet.Number(65), 19);
}

TEST(St0601, InvalidNestedSetsDoNotAffectOtherItems) {
  const std::string far =
      std::string("\x04\x88\x7F\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x01", 11);  // a length of 2^63 - 1 bytes
  const std::string zeros(60000, '\0');                                 // items of number 0 and no bytes
  const KlvPacket packet = DecodeSet(St0601Packet({{74, Set(1, "ab") + far}, {48, "\x80"}, {95, zeros}, {65, "\x13"}}));
  ASSERT_EQ(packet.items.size(), 5U);
  EXPECT_EQ(packet.items[0].note, "a set of 1 items, then truncated at byte 4 of 15; not decoded");
  EXPECT_EQ(packet.items[1].note, "a set of 0 items, then truncated at byte 0 of 1; not decoded");
  EXPECT_EQ(*packet.Number(65), 19);
  EXPECT_TRUE(packet.problem.empty());
  EXPECT_TRUE(packet.checksum && packet.checksum->IsValid());
}

TEST(St0601, SetsWithinSetsAreNotOpened) {
  std::string deep = "\x01\x01\x07";
  while (deep.size() < 30000) deep = Set(48, deep);
  const KlvPacket packet = DecodeSet(St0601Packet({{48, deep}, {65, "\x13"}}));
  EXPECT_EQ(packet.items[0].note, "a set of 1 items; not decoded");
  EXPECT_EQ(*packet.Number(65), 19);
  // A nested packet of this standard stays bytes and gives no second camera.
  EXPECT_EQ(DecodeSet(St0601Packet({{100, CameraPacket(1)}, {65, "\x13"}})).items.size(), 3U);
}

TEST(St0601, BadChecksumIsReportedAndItemsKept) {
  std::string text = CameraPacket(1);
  text[30] = static_cast<char>(text[30] ^ 1);
  const KlvPacket packet = DecodeSet(text);
  ASSERT_TRUE(packet.checksum);
  EXPECT_FALSE(packet.checksum->IsValid());
  EXPECT_EQ(packet.items.size(), 12U);
}

TEST(St0601, ItemWithInvalidLengthEndsThePacket) {
  const std::string text =
      std::string(kSt0601LabelBytes) + BerLength(7) + std::string("\x05\x02\x40\x00\x06\x7F\x00", 7);
  const KlvPacket packet = DecodeSet(text);
  EXPECT_EQ(packet.items.size(), 1U);
  EXPECT_NE(packet.problem.find("byte 4 of 7"), std::string::npos) << packet.problem;
}

}  // namespace
}  // namespace victorious
