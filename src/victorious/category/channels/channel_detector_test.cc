#include "victorious/category/channels/channel_detector.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_vehicles.h"
#include "victorious/category/channels/channel_file.h"
#include "victorious/category/channels/channel_training.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

std::vector<BoxedImage> Streets(int count, int headings) {
  std::vector<BoxedImage> images;
  for (int i = 0; i < count; ++i) {
    testing::VehicleImage street = testing::DrawStreet(static_cast<std::uint64_t>(i), headings);
    images.push_back({.image = street.image, .objects = {}, .ignored = {}});
    for (const Box& box : street.boxes) images.back().objects.push_back({.category = 0, .box = box});
  }
  return images;
}

ChannelTrainOptions SmallTraining() {
  return {.min_object_px = 24, .rounds = 3, .trees = 48, .copies = 3, .negatives = 1500};
}

const ChannelModel& VehicleModel() {
  static const ChannelModel model = TrainChannelDetector(Streets(8, 2), {"vehicle"}, SmallTraining(), 1).value();
  return model;
}

struct Found {
  int right = 0;
  int wrong = 0;
  int all = 0;
};

Found CountFound(const ChannelModel& model, const testing::VehicleImage& street) {
  Found count{.all = static_cast<int>(street.boxes.size())};
  for (const ChannelBox& one : DetectByChannels(model, street.image, 0.5)) {
    const bool is_right =
        std::ranges::any_of(street.boxes, [&](const Box& box) { return IntersectionOverUnion(box, one.box) >= 0.5; });
    ++(is_right ? count.right : count.wrong);
  }
  return count;
}

TEST(ChannelDetector, FindsObjectsOfHeadingsThatItHasNotSeen) {
  Found sum;
  for (std::uint64_t seed = 100; seed < 106; ++seed) {
    const Found found = CountFound(VehicleModel(), testing::DrawStreet(seed, 16));
    sum.right += found.right;
    sum.wrong += found.wrong;
    sum.all += found.all;
  }
  EXPECT_GE(sum.right, sum.all * 8 / 10);
  EXPECT_LE(sum.wrong, sum.all / 4);
}

TEST(ChannelDetector, FindsLargerAndGreyObjects) {
  testing::VehicleImage street = testing::DrawStreet(200, 2);
  cv::resize(street.image, street.image, {}, 2.2, 2.2, cv::INTER_LINEAR);
  for (Box& box : street.boxes) box = {2.2 * box.x, 2.2 * box.y, 2.2 * box.width, 2.2 * box.height};
  EXPECT_GE(CountFound(VehicleModel(), street).right, 6);
  cv::Mat grey;
  cv::cvtColor(street.image, grey, cv::COLOR_BGR2GRAY);
  street.image = grey;
  EXPECT_GE(CountFound(VehicleModel(), street).right, 5);
}

TEST(ChannelDetector, FindsNothingInNothing) {
  EXPECT_TRUE(DetectByChannels(VehicleModel(), cv::Mat(300, 400, CV_8UC3, {90, 90, 90}), 0.5).empty());
  EXPECT_TRUE(DetectByChannels(VehicleModel(), cv::Mat(3, 200, CV_8UC3, {90, 90, 90}), 0).empty());
  EXPECT_TRUE(DetectByChannels(VehicleModel(), cv::Mat(1, 1, CV_8UC1, {90}), 0).empty());
}

TEST(ChannelDetector, TheSameSeedTrainsTheSameModel) {
  const std::vector<BoxedImage> images = Streets(2, 2);
  ChannelTrainOptions options = SmallTraining();
  options.trees = 16;
  const auto bytes = [&](std::uint64_t seed) {
    return EncodeChannelModel(TrainChannelDetector(images, {"vehicle"}, options, seed).value());
  };
  EXPECT_EQ(bytes(1), bytes(1));
  EXPECT_NE(bytes(1), bytes(2));
}

TEST(ChannelDetector, IgnoredRegionsAreNoNegatives) {
  // Half of the vehicles have no box, but an ignored region.
  std::vector<BoxedImage> images = Streets(8, 2);
  for (BoxedImage& image : images) {
    for (std::size_t i = 0; i < 4; ++i) {
      image.ignored.push_back(image.objects.back().box);
      image.objects.pop_back();
    }
  }
  const auto found_with = [&](bool ignored) {
    std::vector<BoxedImage> given = images;
    if (!ignored) {
      for (BoxedImage& image : given) image.ignored.clear();
    }
    const ChannelModel model = TrainChannelDetector(given, {"vehicle"}, SmallTraining(), 1).value();
    int right = 0;
    for (std::uint64_t seed = 300; seed < 304; ++seed) {
      right += CountFound(model, testing::DrawStreet(seed, 2)).right;
    }
    return right;
  };
  EXPECT_GT(found_with(true), found_with(false) + 5);
}

TEST(ChannelDetector, TooFewBoxesAreAnError) {
  std::vector<BoxedImage> images = Streets(1, 2);
  images[0].objects.resize(7);
  const auto model = TrainChannelDetector(images, {"vehicle"}, SmallTraining(), 1);
  ASSERT_FALSE(model);
  EXPECT_THAT(model.error().message, HasSubstr("vehicle: 7 boxes"));
}

TEST(ChannelDetector, BoxesThatCannotBeExamplesAreAnError) {
  const std::vector<BoxedImage> images = Streets(6, 2);
  ChannelTrainOptions options = SmallTraining();
  options.min_object_px = 400;  // of which these objects are a tenth
  const auto too_small = TrainChannelDetector(images, {"vehicle"}, options, 1);
  ASSERT_FALSE(too_small);
  EXPECT_THAT(too_small.error().message, HasSubstr("vehicle: 0 of "));
  EXPECT_THAT(too_small.error().message, HasSubstr("channels.min_object_px = 400"));
  std::vector<BoxedImage> thin = Streets(6, 2);
  for (BoxedImage& one : thin) {
    for (auto& object : one.objects) object.box = {2, object.box.y, 300, 2};
  }
  options = SmallTraining();
  const auto too_thin = TrainChannelDetector(thin, {"vehicle"}, options, 1);
  ASSERT_FALSE(too_thin);
  EXPECT_EQ(too_thin.error().code, ErrorCode::kInvalidArgument);
}

TEST(BoostedTrees, LearnsARuleOfTwoFeatures) {
  BoostExamples examples{.features = 4, .positives = {}, .negatives = {}};
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    std::vector<std::uint8_t> row(4);
    for (std::uint8_t& value : row) value = static_cast<std::uint8_t>(random.Below(256));
    const bool is_positive = row[0] < 128 && row[2] >= 64;
    (is_positive ? examples.positives : examples.negatives).push_back(row);
  }
  const BoostedTrees trained = TrainTrees(examples, {.trees = 24}, 1);
  ASSERT_EQ(trained.trees.size(), 24U);
  ASSERT_EQ(trained.floors.size(), 3U);
  int kept = 0;
  for (const auto& row : examples.positives) kept += ScoreExample(trained, row) >= trained.floors.back() ? 1 : 0;
  EXPECT_GE(kept, static_cast<int>(examples.positives.size()) * 98 / 100);
  const auto below =
      std::ranges::count_if(examples.negatives, [&](const auto& row) { return ScoreExample(trained, row) < 0; });
  EXPECT_GE(below, std::ssize(examples.negatives) * 95 / 100);
  EXPECT_TRUE(TrainTrees({.features = 4, .positives = examples.positives, .negatives = {}}, {}, 1).trees.empty());
}

}  // namespace
}  // namespace victorious
