#include "victorious/category/network/output_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/category/network/network_tensor.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using Shapes = std::vector<std::vector<int>>;

struct LayoutCase {
  Shapes shapes;
  std::size_t classes;
  cv::Size input;
  DetectorLayout layout;
};

TEST(RecogniseLayout, ByShapeClassesAndInput) {
  constexpr std::size_t kCoco = 80;
  const std::vector<LayoutCase> cases = {
      {{{1, 25200, 85}}, kCoco, {640, 640}, DetectorLayout::kYolov5},
      {{{1, 8400, 85}}, kCoco, {640, 640}, DetectorLayout::kYolox},
      {{{1, 3549, 85}}, kCoco, {416, 416}, DetectorLayout::kYolox},
      {{{1, 84, 8400}}, kCoco, {640, 640}, DetectorLayout::kYolov8},
      {{{1, 8400, 84}}, kCoco, {640, 640}, DetectorLayout::kYolov8},
      {{{1, 5, 5040}}, 1, {640, 384}, DetectorLayout::kYolov8},
      {{{1, 300, 6}}, kCoco, {640, 640}, DetectorLayout::kYolov10},
      {{{1, 25200, 6}}, 1, {640, 640}, DetectorLayout::kYolov5},
      {{{1, 2704, 80}, {1, 2704, 32}, {1, 676, 80}, {1, 676, 32}, {1, 169, 80}, {1, 169, 32}},
       kCoco,
       {416, 416},
       DetectorLayout::kNanodet},
      {{{1, 3598, 112}}, kCoco, {416, 416}, DetectorLayout::kNanodet},
      {{{1, 85, 22, 22}}, kCoco, {352, 352}, DetectorLayout::kFastestdet},
      {{{1, 1, 100, 7}}, kCoco, {300, 300}, DetectorLayout::kSsd},
      {{{1, 3000, 21}, {1, 3000, 4}}, 20, {300, 300}, DetectorLayout::kSsd},
      {{{1, 100, 92}, {1, 100, 4}}, 91, {800, 800}, DetectorLayout::kDetr},
      {{{1, 300, 4}, {1, 300, 80}}, kCoco, {640, 640}, DetectorLayout::kDetr},
      {{{1083, 7}, {4332, 7}}, 2, {608, 608}, DetectorLayout::kDarknet}};
  for (const LayoutCase& one : cases) {
    const auto layout = RecogniseLayout(one.shapes, one.classes, one.input);
    ASSERT_TRUE(layout) << ShapeText(one.shapes[0]) << ": " << layout.error().message;
    EXPECT_EQ(*layout, one.layout) << ShapeText(one.shapes[0]);
  }
}

TEST(RecogniseLayout, SaysHowManyClassesWouldFit) {
  const auto layout = RecogniseLayout(Shapes{{1, 84, 8400}}, 3, {640, 640});
  ASSERT_FALSE(layout);
  EXPECT_EQ(layout.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(layout.error().message,
              HasSubstr("1x84x8400 are those of a yolov8 with 80 classes, and the class list has 3"));
}

TEST(RecogniseLayout, SaysTheMostUsualLayoutThatWouldFit) {
  const auto layout = RecogniseLayout(Shapes{{1, 3549, 85}}, 2, {416, 416});
  ASSERT_FALSE(layout);
  EXPECT_THAT(layout.error().message, HasSubstr("a yolox with 80 classes, and the class list has 2"));
}

TEST(RecogniseLayout, RefusesOtherOutputs) {
  for (const Shapes& shapes : {Shapes{}, Shapes{{1, 1000}}, Shapes{{1}}, Shapes{{1, 3, 80, 80, 85}},
                               Shapes{{1, 4, 9, 9}}, Shapes{{1, 0, 85}}, Shapes{{2, 8400, 85}}}) {
    const auto layout = RecogniseLayout(shapes, 80, {640, 640});
    ASSERT_FALSE(layout);
    EXPECT_THAT(layout.error().message, HasSubstr("no known detector"));
  }
}

TEST(GridsOf, CountsTheCellsOfSuccessiveStrides) {
  const auto grids = GridsOf(3549, {416, 416});
  ASSERT_EQ(grids.size(), 3);
  EXPECT_EQ(grids[0].stride, 8);
  EXPECT_EQ(grids[0].columns, 52);
  EXPECT_EQ(grids[2].stride, 32);
  EXPECT_EQ(grids[2].rows, 13);
  EXPECT_EQ(GridsOf(3598, {416, 416}).size(), 4);
  EXPECT_TRUE(GridsOf(3550, {416, 416}).empty());
}

}  // namespace
}  // namespace victorious
