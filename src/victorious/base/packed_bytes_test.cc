#include "victorious/base/packed_bytes.h"

#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;

enum class Colour { kRed, kGreen };

std::vector<std::byte> Written() {
  ByteWriter writer;
  writer.Put(std::int64_t{-5});
  writer.PutOptional(std::optional(0.1));
  writer.PutOptional(std::optional<double>());
  writer.Put(Colour::kGreen);
  writer.PutItems(std::span<const double>(std::array{1.5, std::numeric_limits<double>::denorm_min()}));
  return writer.Take();
}

TEST(PackedBytes, ComeBackAsTheyWereWritten) {
  const std::vector<std::byte> bytes = Written();
  ByteReader reader(bytes);
  EXPECT_EQ(reader.Get<std::int64_t>(), -5);
  EXPECT_EQ(reader.GetOptional<double>(), 0.1);
  EXPECT_EQ(reader.GetOptional<double>(), std::nullopt);
  EXPECT_EQ(reader.GetEnum(Colour::kGreen), Colour::kGreen);
  EXPECT_THAT(reader.GetItems<double>(), ElementsAre(1.5, std::numeric_limits<double>::denorm_min()));
  EXPECT_TRUE(reader.IsAtEnd());
}

TEST(PackedBytes, FaultsAreRemembered) {
  const std::vector<std::byte> bytes = Written();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::span<const std::byte> shorter(bytes.data(), size);
    ByteReader reader(shorter);
    reader.Get<std::int64_t>();
    reader.GetOptional<double>();
    reader.GetOptional<double>();
    reader.GetEnum(Colour::kGreen);
    reader.GetItems<double>();
    EXPECT_FALSE(reader.IsAtEnd()) << size;
  }
  ByteReader longer(bytes);
  longer.Get<std::int64_t>();
  EXPECT_FALSE(longer.IsAtEnd());
  ByteWriter writer;
  writer.Put(std::int32_t{2});
  const std::vector<std::byte> two = writer.Take();
  ByteReader enumerator(two);
  EXPECT_EQ(enumerator.GetEnum(Colour::kGreen), Colour::kRed);
  EXPECT_TRUE(enumerator.HasFailed());
}

TEST(PackedBytes, TextsAreReadAsWritten) {
  ByteWriter writer;
  writer.PutText("");
  writer.PutText(std::string_view("a\0b", 3));
  const std::string packed = writer.TakeText();
  EXPECT_EQ(packed.size(), 2 * sizeof(std::uint64_t) + 3);
  ByteReader reader(std::as_bytes(std::span(packed)));
  EXPECT_EQ(reader.GetText(), "");
  EXPECT_EQ(reader.GetText(), std::string("a\0b", 3));
  EXPECT_TRUE(reader.IsAtEnd());
  EXPECT_EQ(reader.GetText(), "");
  EXPECT_TRUE(reader.HasFailed());
}

// A damaged number of items must not allocate.
TEST(PackedBytes, HugeNumberOfItemsIsAFault) {
  ByteWriter writer;
  writer.Put(std::numeric_limits<std::uint64_t>::max());
  const std::vector<std::byte> bytes = writer.Take();
  ByteReader reader(bytes);
  EXPECT_TRUE(reader.GetItems<double>().empty());
  EXPECT_TRUE(reader.HasFailed());
}

}  // namespace
}  // namespace victorious
