#include "victorious/category/finder/channel_source.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/drawn_vehicles.h"
#include "victorious/category/channels/channel_file.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const auto kNoProgress = [](std::size_t) {};

ChannelTrainOptions SmallTraining() {
  return {.min_object_px = 24, .rounds = 2, .trees = 32, .copies = 3, .negatives = 1000};
}

// A list of the boxes of some streets, whose images are in `folder`.
std::vector<CategoryListRow> WriteStreets(const testing::ScratchFolder& folder, int count) {
  std::vector<CategoryListRow> rows;
  for (int i = 0; i < count; ++i) {
    const testing::VehicleImage street = testing::DrawStreet(static_cast<std::uint64_t>(i), 2);
    const std::string name = "street" + std::to_string(i) + ".png";
    EXPECT_TRUE(WriteImage(folder / name, street.image));
    for (const Box& box : street.boxes) {
      rows.push_back({.image = name, .category = "vehicle", .box = box, .mark = {}, .where = "list.csv line 2"});
    }
  }
  return rows;
}

TEST(ChannelSource, IsTrainedReadAndFindsItsCategoryInFrames) {
  const testing::ScratchFolder folder;
  const std::vector<CategoryListRow> rows = WriteStreets(folder, 4);
  EXPECT_TRUE(HasSeveralBoxesAnImage(rows));
  const auto model = TrainChannelsOnList(folder.path(), rows, SmallTraining(), 1, kNoProgress);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->images, 4);
  EXPECT_EQ(model->boxes, 32);
  ASSERT_TRUE(WriteChannelModel(folder / "cars.vcat", *model));
  auto read = ReadCategorySource(folder / "cars.vcat");
  ASSERT_TRUE(read) << read.error().message;
  const auto source = MakeCategorySource(*std::move(read), {}, {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_THAT((*source)->names(), ElementsAre("vehicle"));
  EXPECT_TRUE((*source)->IsDetector());
  EXPECT_THAT((*source)->DescribeSearch({640, 480}), HasSubstr("640 x 480 px for objects of 24 px"));
  const testing::VehicleImage street = testing::DrawStreet(50, 2);
  Frame frame{.bgr = street.image};
  cv::cvtColor(street.image, frame.image, cv::COLOR_BGR2GRAY);
  const auto found = (*source)->FindIn(frame);
  ASSERT_TRUE(found) << found.error().message;
  int right = 0;
  for (const FoundCategory& one : *found) {
    EXPECT_GE(one.probability, 0.5);
    right +=
        std::ranges::any_of(street.boxes, [&](const Box& box) { return IntersectionOverUnion(box, one.box) >= 0.5; });
  }
  EXPECT_GE(right, 6);
}

TEST(ChannelSource, AListWithoutBoxesOrWithCadFilesIsAnError) {
  const testing::ScratchFolder folder;
  std::vector<CategoryListRow> rows = WriteStreets(folder, 1);
  const auto message = [&] {
    const auto model = TrainChannelsOnList(folder.path(), rows, SmallTraining(), 1, kNoProgress);
    return model ? std::string() : model.error().message;
  };
  rows[0].category.clear();
  EXPECT_THAT(message(), HasSubstr("list.csv line 2: no category"));
  for (CategoryListRow& row : rows) row.category = kIgnoredCategory;
  EXPECT_FALSE(HasSeveralBoxesAnImage(rows));
  EXPECT_THAT(message(), HasSubstr("without boxes"));
  rows[0].image = "car.obj";
  EXPECT_THAT(message(), HasSubstr("CAD file"));
}

TEST(ChannelSource, BackgroundCategoriesAreNotReported) {
  ChannelModel model{.program_version = "1"};
  model.categories.push_back({.name = "background", .detectors = std::vector<BoostedTrees>(kTrainedHeadings)});
  EXPECT_THAT(ChannelSource::Create(model, {}).error().message, HasSubstr("background"));
  model.categories.push_back({.name = "car", .detectors = std::vector<BoostedTrees>(kTrainedHeadings)});
  const auto source = ChannelSource::Create(model, {});
  ASSERT_TRUE(source);
  EXPECT_THAT(source->names(), ElementsAre("car"));
}

}  // namespace
}  // namespace victorious
