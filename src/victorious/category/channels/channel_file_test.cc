#include "victorious/category/channels/channel_file.h"

#include <cstddef>
#include <functional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

ChannelModel SomeChannelModel() {
  BoostedTrees trained{.trees = std::vector<FeatureTree>(9), .floors = {-7, 12}};
  trained.trees[3] = {.feature = {1, 2, kWindowFeatures - 1}, .threshold = {4, 8, 252}, .leaf = {-127, 127, 3, 0}};
  ChannelModel model{.program_version = "1", .images = 3, .boxes = 40, .min_object_px = 20};
  model.categories.push_back({.name = "vehicle/car", .length = 1.4, .width = 0.7, .detectors = {trained, {}, trained}});
  model.categories.push_back({.name = "person", .width = 1.5, .turns = false, .detectors = {trained}});
  model.categories[0].calibration = {.slope = 0.5, .offset = -1};
  return model;
}

TEST(ChannelFile, RoundTrip) {
  const testing::ScratchFolder folder;
  const auto path = folder / "cars.vcat";
  ASSERT_TRUE(WriteChannelModel(path, SomeChannelModel()));
  const auto read = ReadChannelModel(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->boxes, 40);
  EXPECT_EQ(read->min_object_px, 20);
  ASSERT_EQ(read->categories.size(), 2U);
  EXPECT_EQ(read->categories[0].name, "vehicle/car");
  EXPECT_EQ(read->categories[0].length, 1.4);
  EXPECT_EQ(read->categories[0].calibration.offset, -1);
  EXPECT_EQ(read->categories[0].detectors, SomeChannelModel().categories[0].detectors);
  EXPECT_FALSE(read->categories[1].turns);
  EXPECT_EQ(EncodeChannelModel(*read), EncodeChannelModel(SomeChannelModel()));
}

TEST(ChannelFile, EveryDamageIsAnError) {
  const std::vector<std::byte> whole = EncodeChannelModel(SomeChannelModel());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(ParseChannelModel(std::span(whole).first(size), "cut")) << size;
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (i >= 12 && i < 16) continue;  // reserved
    std::vector<std::byte> changed = whole;
    changed[i] ^= std::byte{0x41};
    EXPECT_FALSE(ParseChannelModel(changed, "changed")) << i;
  }
}

// A model that a search could not use, behind a valid checksum.
TEST(ChannelFile, ValuesOutOfRangeAreErrors) {
  const std::vector<std::function<void(ChannelModel&)>> changes = {
      [](ChannelModel& m) { m.categories[0].detectors[0].trees[0].feature[1] = kWindowFeatures; },
      [](ChannelModel& m) { m.categories[0].detectors[0].trees[0].leaf[0] = -128; },
      [](ChannelModel& m) { m.categories[0].detectors[0].floors.pop_back(); },
      [](ChannelModel& m) { m.categories[0].detectors[0].trees.resize(257); },
      [](ChannelModel& m) { m.categories[0].detectors.pop_back(); },
      [](ChannelModel& m) { m.categories[0].length = 0; },
      [](ChannelModel& m) { m.categories[0].length = 1e9; },
      [](ChannelModel& m) { m.categories[0].name.clear(); },
      [](ChannelModel& m) { m.categories[0].name = "a\nb"; },
      [](ChannelModel& m) { m.categories[1].name = m.categories[0].name; },
      [](ChannelModel& m) { m.categories.clear(); },
      [](ChannelModel& m) { m.min_object_px = 0; },
      [](ChannelModel& m) { m.categories[0].calibration.slope = 1e308 * 10; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    ChannelModel model = SomeChannelModel();
    changes[i](model);
    const auto read = ParseChannelModel(EncodeChannelModel(model), "cars");
    ASSERT_FALSE(read) << i;
    EXPECT_EQ(read.error().code, ErrorCode::kDataLoss);
    EXPECT_THAT(read.error().message, HasSubstr("cars: a damaged detector by channels")) << i;
  }
}

}  // namespace
}  // namespace victorious
