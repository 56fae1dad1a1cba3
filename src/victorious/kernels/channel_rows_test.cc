#include "victorious/kernels/channel_rows.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

TEST(ChannelRows, SumsPairsAndCutsOffAtTheLargestByte) {
  const std::vector<float> in = {1, 2, 3, 4};
  std::vector<float> sums = {10, 20};
  AddPixelPairsRef(in.data(), 2, sums.data());
  EXPECT_EQ(sums, (std::vector<float>{13, 27}));
  const std::vector<float> gain = {2, 1000, 0.9F, 0};
  std::vector<std::uint8_t> bytes(4);
  EncodeCellsRef(in.data(), gain.data(), 4, bytes.data());
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{2, 255, 2, 0}));
}

class ChannelRowsTarget : public TargetTest {};

TEST_P(ChannelRowsTarget, ComputesAsTheReference) {
  Random random(5);
  for (const std::size_t count : {0U, 1U, 3U, 8U, 16U, 31U, 100U, 963U}) {
    std::vector<float> in(2 * count);
    std::vector<float> gain(count);
    std::vector<float> sums(count);
    for (float& value : in) value = static_cast<float>(random.Uniform(0, 300));
    for (float& value : gain) value = static_cast<float>(random.Uniform(0, 1.5));
    for (float& value : sums) value = static_cast<float>(random.Uniform(0, 300));
    std::vector<float> expected_sums = sums;
    AddPixelPairs(in.data(), count, sums.data());
    AddPixelPairsRef(in.data(), count, expected_sums.data());
    EXPECT_EQ(sums, expected_sums) << count;
    std::vector<std::uint8_t> bytes(count);
    std::vector<std::uint8_t> expected_bytes(count);
    EncodeCells(in.data(), gain.data(), count, bytes.data());
    EncodeCellsRef(in.data(), gain.data(), count, expected_bytes.data());
    EXPECT_EQ(bytes, expected_bytes) << count;
  }
}

VICTORIOUS_EVERY_TARGET(ChannelRowsTarget);

}  // namespace
}  // namespace victorious::kernels
