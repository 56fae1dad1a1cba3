// Each layout on outputs that are made up: one object at a known place, among candidates below the threshold.
#include "victorious/category/network/decode_outputs.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "victorious/category/network/output_layout.h"

namespace victorious {
namespace {

constexpr std::size_t kClasses = 3;

NetworkTensor Zeros(const std::vector<int>& shape, float value = 0) {
  std::size_t count = 1;
  for (const int side : shape) count *= static_cast<std::size_t>(side);
  return {.shape = shape, .values = std::vector<float>(count, value)};
}

// Sets a row of a table 1 x N x M.
void SetRow(NetworkTensor& tensor, std::size_t row, std::initializer_list<double> values) {
  std::size_t at = row * static_cast<std::size_t>(tensor.shape.back());
  for (const double value : values) tensor.values[at++] = static_cast<float>(value);
}

DetectorSettings SettingsFor(DetectorLayout layout, int side = 64) {
  DetectorSettings settings = DefaultSettings(layout);
  settings.width = settings.height = side;
  settings.min_score = 0.3;
  return settings;
}

void ExpectOne(const std::vector<NetworkTensor>& outputs, const DetectorSettings& settings, const Box& box,
               std::size_t category, double score) {
  const auto found = DecodeOutputs(outputs, settings, kClasses);
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 1);
  const NetworkBox& one = found->front();
  EXPECT_NEAR(one.box.x, box.x, 1e-3);
  EXPECT_NEAR(one.box.y, box.y, 1e-3);
  EXPECT_NEAR(one.box.width, box.width, 1e-3);
  EXPECT_NEAR(one.box.height, box.height, 1e-3);
  EXPECT_EQ(one.category, category);
  EXPECT_NEAR(one.score, score, 1e-6);
}

// A logit for a probability.
double Logit(double p) { return std::log(p / (1 - p)); }

TEST(DecodeOutputs, Yolov5) {
  NetworkTensor table = Zeros({1, 252, 8});
  SetRow(table, 100, {30, 20, 10, 8, 0.8, 0.1, 0.9, 0.2});
  SetRow(table, 101, {30, 20, 10, 8, 0.8, 0.1, 0.3, 0.2});  // 0.24
  ExpectOne({table}, SettingsFor(DetectorLayout::kYolov5), {25, 16, 10, 8}, 1, 0.72);
}

TEST(DecodeOutputs, Yolov8AndItsTransposed) {
  NetworkTensor rows = Zeros({1, 84, 7});
  SetRow(rows, 50, {30, 20, 10, 8, 0.1, 0.2, 0.6});
  NetworkTensor columns = Zeros({1, 7, 84});
  for (std::size_t r = 0; r < 84; ++r) {
    for (std::size_t c = 0; c < 7; ++c) columns.values[c * 84 + r] = rows.values[r * 7 + c];
  }
  ExpectOne({rows}, SettingsFor(DetectorLayout::kYolov8), {25, 16, 10, 8}, 2, 0.6);
  ExpectOne({columns}, SettingsFor(DetectorLayout::kYolov8), {25, 16, 10, 8}, 2, 0.6);
}

TEST(DecodeOutputs, Yolov10) {
  NetworkTensor table = Zeros({1, 300, 6});
  SetRow(table, 0, {10, 12, 30, 22, 0.7, 1});
  SetRow(table, 1, {10, 12, 30, 22, 0.9, 3});  // no such class
  ExpectOne({table}, SettingsFor(DetectorLayout::kYolov10), {10, 12, 20, 10}, 1, 0.7);
}

TEST(DecodeOutputs, YoloxIsRelativeToTheCell) {
  NetworkTensor table = Zeros({1, 84, 8});                                                 // 8 x 8, 4 x 4, 2 x 2 cells
  SetRow(table, 64 + 4 + 2, {0.25, 0.5, std::log(2), std::log(0.5), 0.9, 0.5, 0.1, 0.1});  // stride 16, x 2, y 1
  ExpectOne({table}, SettingsFor(DetectorLayout::kYolox), {36 - 16, 24 - 4, 32, 8}, 0, 0.45);
}

TEST(DecodeOutputs, NanodetReadsDistributions) {
  constexpr int kBins = 8;
  std::vector<NetworkTensor> outputs;
  for (const int cells : {64, 16, 4}) {
    outputs.push_back(Zeros({1, cells, static_cast<int>(kClasses)}));
    outputs.push_back(Zeros({1, cells, 4 * kBins}));
  }
  SetRow(outputs[2], 4 + 2, {0, 0, 0.8});  // stride 16, x 2, y 1
  NetworkTensor& sides = outputs[3];
  const std::array<int, 4> bins = {1, 2, 3, 0};
  for (std::size_t s = 0; s < bins.size(); ++s) {
    sides.values[6 * 32 + s * kBins + static_cast<std::size_t>(bins[s])] = 50;  // certain
  }
  const Box box{39.5 - 16, 23.5 - 32, 16 + 48, 32};
  ExpectOne(outputs, SettingsFor(DetectorLayout::kNanodet), box, 2, 0.8);
  std::swap(outputs[2], outputs[5]);  // the order of outputs is free
  std::swap(outputs[0], outputs[3]);
  ExpectOne(outputs, SettingsFor(DetectorLayout::kNanodet), box, 2, 0.8);
}

TEST(DecodeOutputs, NanodetPlusIsOneTable) {
  NetworkTensor table = Zeros({1, 85, 3 + 32});  // strides 8 to 64
  const std::size_t row = 64 + 16 + 3;           // stride 32, x 1, y 1
  table.values[row * 35] = 0.5F;
  for (std::size_t s = 0; s < 4; ++s) table.values[row * 35 + 3 + s * 8 + 1] = 50;
  ExpectOne({table}, SettingsFor(DetectorLayout::kNanodet), {0, 0, 64, 64}, 0, 0.5);
}

TEST(DecodeOutputs, Fastestdet) {
  NetworkTensor planes = Zeros({1, 8, 4, 4}, 0);
  const auto set = [&](std::size_t channel, double value) {
    planes.values[channel * 16 + 1 * 4 + 2] = static_cast<float>(value);  // y 1, x 2
  };
  set(0, 0.9);
  set(1, std::atanh(0.5));
  set(3, Logit(0.25));
  set(4, Logit(0.5));
  set(6, 0.8);
  ExpectOne({planes}, SettingsFor(DetectorLayout::kFastestdet), {40 - 8, 16 - 16, 16, 32}, 1,
            std::pow(0.9, 0.6) * std::pow(0.8, 0.4));
}

TEST(DecodeOutputs, SsdOfBothKinds) {
  NetworkTensor output = Zeros({1, 1, 2, 7});
  SetRow(output, 1, {0, 2, 0.6, 0.25, 0.5, 0.75, 1});  // classes from 1 on
  ExpectOne({output}, SettingsFor(DetectorLayout::kSsd), {16, 32, 32, 32}, 1, 0.6);
  NetworkTensor corners = Zeros({1, 1200, 4});
  NetworkTensor classes = Zeros({1, 1200, 4});
  SetRow(classes, 7, {0.3, 0.1, 0.6, 0});  // the background first
  SetRow(corners, 7, {0.25, 0.5, 0.75, 1});
  ExpectOne({classes, corners}, SettingsFor(DetectorLayout::kSsd), {16, 32, 32, 32}, 1, 0.6);
}

TEST(DecodeOutputs, DetrOfBothKinds) {
  NetworkTensor boxes = Zeros({1, 100, 4});
  SetRow(boxes, 9, {0.5, 0.5, 0.5, 0.25});
  NetworkTensor with_nothing = Zeros({1, 100, 4});
  for (std::size_t r = 0; r < 100; ++r) SetRow(with_nothing, r, {0, 0, 0, 20});
  SetRow(with_nothing, 9, {0, std::log(7), 0, 0});  // 7 of 10
  ExpectOne({with_nothing, boxes}, SettingsFor(DetectorLayout::kDetr), {16, 24, 32, 16}, 1, 0.7);
  NetworkTensor independent = Zeros({1, 100, 3}, -20);
  SetRow(independent, 9, {-20, -20, Logit(0.4)});
  ExpectOne({boxes, independent}, SettingsFor(DetectorLayout::kDetr), {16, 24, 32, 16}, 2, 0.4);
}

TEST(DecodeOutputs, DarknetReadsAllItsLayers) {
  std::vector<NetworkTensor> outputs = {Zeros({12, 8}), Zeros({48, 8})};
  SetRow(outputs[1], 5, {0.5, 0.25, 0.5, 0.25, 0.9, 0.1, 0, 0.7});  // objectness is in the class's already
  ExpectOne(outputs, SettingsFor(DetectorLayout::kDarknet), {16, 8, 32, 16}, 2, 0.7);
}

TEST(DecodeOutputs, LeavesOutNumbersThatAreNone) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const DetectorLayout layout : {DetectorLayout::kYolov5, DetectorLayout::kYolox}) {
    const int rows = layout == DetectorLayout::kYolov5 ? 252 : 84;
    for (const float value : {kNan, kInfinite, -kInfinite, 1e30F}) {
      NetworkTensor table = Zeros({1, rows, 8});
      for (std::size_t v = 0; v < 8; ++v) {
        SetRow(table, v, {30, 20, 10, 8, 0.9, 0.9, 0, 0});
        table.values[v * 8 + v] = value;
      }
      const auto found = DecodeOutputs(std::vector{table}, SettingsFor(layout), kClasses);
      ASSERT_TRUE(found);
      for (const NetworkBox& one : *found) {
        EXPECT_TRUE(std::isfinite(one.box.x + one.box.y + one.box.width + one.box.height));
        EXPECT_LE(one.score, 1);
      }
      EXPECT_LT(found->size(), 8);
    }
  }
}

TEST(DecodeOutputs, RefusesShapesOfAnotherLayout) {
  const auto settings = SettingsFor(DetectorLayout::kYolox);
  EXPECT_FALSE(DecodeOutputs(std::vector{Zeros({1, 83, 8})}, settings, kClasses));  // no grids
  EXPECT_FALSE(DecodeOutputs(std::vector{Zeros({1, 84, 9})}, settings, kClasses));  // another class
  EXPECT_FALSE(DecodeOutputs(std::vector<NetworkTensor>{}, settings, kClasses));
  NetworkTensor cut = Zeros({1, 84, 8});
  cut.values.pop_back();
  EXPECT_FALSE(DecodeOutputs(std::vector{cut}, settings, kClasses));
  EXPECT_FALSE(DecodeOutputs(std::vector{NetworkTensor{.shape = {1, -84, -8}, .values = {}}}, settings, kClasses));
}

}  // namespace
}  // namespace victorious
