#include "victorious/kernels/dog_extrema.h"

#include <algorithm>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {

void PrintTo(const DogExtremum& extremum, std::ostream* out) { *out << extremum.x << '/' << extremum.layer; }

namespace {

struct Levels {
  std::vector<std::int16_t> pixels;
  LevelRows rows;

  Levels(std::size_t width, Random& random, std::uint32_t range) {
    const std::size_t padded = PaddedWidth(width);
    pixels.resize(kLevels * 3 * padded);
    for (std::int16_t& pixel : pixels) {
      pixel = static_cast<std::int16_t>(static_cast<int>(random.Below(2 * range + 1)) - static_cast<int>(range));
    }
    for (std::size_t l = 0; l < kLevels; ++l) {
      for (std::size_t r = 0; r < 3; ++r) rows.row[l][r] = pixels.data() + (3 * l + r) * padded;
    }
  }
  std::int16_t& At(std::size_t level, std::size_t row, std::size_t x) {
    return pixels[static_cast<std::size_t>(rows.row[level][row] - pixels.data()) + x];
  }
};

using Find = std::size_t (*)(const LevelRows&, std::int32_t, std::int32_t, std::int16_t, DogExtremum*);

std::vector<DogExtremum> FindAll(Find find, const LevelRows& rows, std::int32_t first, std::int32_t end,
                                 std::int16_t threshold) {
  std::vector<DogExtremum> found(kSearchedLayers * static_cast<std::size_t>(std::max(0, end - first)));
  found.resize(find(rows, first, end, threshold, found.data()));
  return found;
}

TEST(DogExtrema, FindsOneThatStandsOut) {
  Random random(1);
  Levels levels(40, random, 0);
  levels.At(3, 1, 17) = 500;  // D of layer 2 is +500, of layer 3 -500
  const auto found = FindAll(&FindDogExtremaRef, levels.rows, 1, 39, 100);
  EXPECT_EQ(found, (std::vector<DogExtremum>{{17, 2}, {17, 3}}));
  EXPECT_TRUE(FindAll(&FindDogExtremaRef, levels.rows, 1, 39, 500).empty());
  EXPECT_TRUE(FindAll(&FindDogExtremaRef, levels.rows, 18, 39, 100).empty());
}

class DogExtremaTarget : public TargetTest {};

TEST_P(DogExtremaTarget, AgreesWithTheReference) {
  Random random(2);
  for (const std::uint32_t range : {3U, 40U, static_cast<std::uint32_t>(kLevelOffset)}) {  // few values: many ties
    for (const std::int32_t width : {3, 11, 31, 32, 33, 64, 90, 511, 513, 1100}) {
      const Levels levels(static_cast<std::size_t>(width), random, range);
      for (const std::int32_t border : {1, 5}) {
        for (const std::int16_t threshold : {std::int16_t{0}, std::int16_t{2}, std::int16_t{82}}) {
          EXPECT_EQ(FindAll(&FindDogExtrema, levels.rows, border, width - border, threshold),
                    FindAll(&FindDogExtremaRef, levels.rows, border, width - border, threshold))
              << "width " << width << " range " << range;
        }
      }
    }
  }
}

VICTORIOUS_EVERY_TARGET(DogExtremaTarget);

}  // namespace
}  // namespace victorious::kernels
