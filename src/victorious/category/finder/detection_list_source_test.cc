#include "victorious/category/finder/detection_list_source.h"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;

Frame FrameOf(std::int64_t index) {
  Frame frame;
  frame.index = index;
  frame.image = cv::Mat::zeros(100, 200, CV_8U);
  return frame;
}

TEST(DetectionListSource, GivesTheBoxesOfAFrameClippedToIt) {
  DetectionList list{.detector = "yolo", .classes = {"car", "truck"}};
  list.frames[2] = {{.category = 1, .box = {190, 90, 20, 30}, .score = 0.5, .track = 4},
                    {.category = 0, .box = {300, 0, 10, 10}}};
  const auto source = DetectionListSource::Create(std::move(list));
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_TRUE(source->IsListed());
  EXPECT_THAT(source->names(), ElementsAre("yolo/car", "yolo/truck"));
  EXPECT_EQ(source->content_id(), "listed/yolo");
  EXPECT_TRUE(source->FindIn(FrameOf(1))->empty());
  const auto found = source->FindIn(FrameOf(2));
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().category, 1U);
  EXPECT_DOUBLE_EQ(found->front().box.width, 10);
  EXPECT_DOUBLE_EQ(found->front().box.height, 10);
  EXPECT_DOUBLE_EQ(found->front().probability, 0.5);
  EXPECT_EQ(found->front().track, 4);
}

TEST(DetectionListSource, ScalesPartsOfTheFrame) {
  DetectionList list{.detector = "yolo", .classes = {"car"}, .is_relative = true};
  list.frames[0] = {{.category = 0, .box = {0.25, 0.5, 0.5, 0.25}}};
  const auto source = DetectionListSource::Create(std::move(list));
  const Box box = source->FindIn(FrameOf(0))->front().box;
  EXPECT_DOUBLE_EQ(box.x, 50);
  EXPECT_DOUBLE_EQ(box.y, 50);
  EXPECT_DOUBLE_EQ(box.width, 100);
  EXPECT_DOUBLE_EQ(box.height, 25);
}

TEST(DetectionListSource, RefusesNamesThatCannotBeStoredOrAreOfOthers) {
  for (const std::string name : {"boxed", "a/b", "", "a\nb"}) {
    EXPECT_FALSE(DetectionListSource::Create({.detector = name, .classes = {"car"}})) << name;
  }
  EXPECT_FALSE(DetectionListSource::Create({.detector = "yolo", .classes = {"a\tb"}}));
}

}  // namespace
}  // namespace victorious
