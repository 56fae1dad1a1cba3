#include "victorious/base/sealed_bytes.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr FileMagic kMagic = {0x8A, 'V', 'T', 'S', 'T', 0x0D, 0x0A, 0x1A};

std::vector<std::byte> Sealed() { return Seal(kMagic, 3, std::vector<std::byte>(20, std::byte{7})); }

TEST(SealedBytes, ComeBack) {
  const std::vector<std::byte> bytes = Sealed();
  EXPECT_TRUE(HasMagic(bytes, kMagic));
  const std::optional<SealedHeader> header = ReadSealedHeader(bytes);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->version, 3U);
  EXPECT_EQ(PayloadOf(bytes).size(), 20U);
  EXPECT_EQ(FaultOfPayload(*header, PayloadOf(bytes)), nullptr);
}

TEST(SealedBytes, ShowDamage) {
  std::vector<std::byte> bytes = Sealed();
  bytes.back() ^= std::byte{1};
  EXPECT_STREQ(FaultOfPayload(ReadSealedHeader(bytes).value(), PayloadOf(bytes)), "its checksum is wrong");
  bytes.pop_back();
  EXPECT_STREQ(FaultOfPayload(ReadSealedHeader(bytes).value(), PayloadOf(bytes)), "its size is wrong");
  bytes.resize(31);
  EXPECT_FALSE(ReadSealedHeader(bytes));
  bytes.resize(7);
  EXPECT_FALSE(HasMagic(bytes, kMagic));
}

}  // namespace
}  // namespace victorious
