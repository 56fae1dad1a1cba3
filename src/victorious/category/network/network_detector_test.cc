#include "victorious/category/network/network_detector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include "testing/tiny_detector.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

constexpr int kSide = 64;

DetectorModel TinyModel(const std::string& onnx = testing::TinyDetectorOnnx(kSide)) {
  DetectorModel model{.source = "tiny.onnx"};
  model.classes = ParseClassList(testing::TinyDetectorClasses(), "tiny").value();
  model.files.network = onnx;
  return model;
}

std::string ImportMessage(DetectorModel model, const DetectorImport& import = {}) {
  const auto imported = ImportDetector(std::move(model), import);
  return imported ? "imported" : imported.error().message;
}

cv::Mat RedAt(cv::Size size, std::initializer_list<cv::Point> places) {
  cv::Mat bgr(size, CV_8UC3, cv::Scalar(0, 0, 0));
  for (const cv::Point& at : places) bgr(cv::Rect(at.x, at.y, 16, 16)) = cv::Scalar(0, 0, 255);
  return bgr;
}

TEST(ImportDetector, RecognisesLayoutAndInput) {
  const auto model = ImportDetector(TinyModel(), {});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->settings.layout, DetectorLayout::kFastestdet);
  EXPECT_EQ(model->settings.width, kSide);
  EXPECT_EQ(model->settings.height, kSide);
}

TEST(ImportDetector, TakesWhatItIsGiven) {
  const auto model =
      ImportDetector(TinyModel(), {.input = cv::Size(96, 32), .channels = ChannelOrder::kRgb, .min_score = 0.8});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->settings.width, 96);
  EXPECT_EQ(model->settings.height, 32);
  EXPECT_EQ(model->settings.channels, ChannelOrder::kRgb);
  EXPECT_EQ(model->settings.min_score, 0.8);
  EXPECT_THAT(ImportMessage(TinyModel(), {.layout = DetectorLayout::kYolov8}), HasSubstr("not those of a yolov8"));
  EXPECT_THAT(ImportMessage(TinyModel(), {.min_score = 7}), HasSubstr("min_score = 7"));
}

TEST(ImportDetector, RefusesWhatIsNoNetwork) {
  EXPECT_THAT(ImportMessage(TinyModel("not a network")), HasSubstr("cannot read this network"));
  EXPECT_NE(ImportMessage(TinyModel("")), "imported");
  DetectorModel other = TinyModel();
  other.classes.pop_back();
  EXPECT_THAT(ImportMessage(other), HasSubstr("a fastestdet with 2 classes, and the class list has 1"));
  DetectorModel darknet = TinyModel("[net]\nwidth=64\nheight=64\n[convolutional\n");
  darknet.files.weights = "weights";
  EXPECT_NE(ImportMessage(darknet), "imported");
}

TEST(ImportDetector, EndsOneLineForEveryCutOrChangedFile) {
  const std::string whole = testing::TinyDetectorOnnx(kSide);
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 7) {
    const std::string message = ImportMessage(TinyModel(whole.substr(0, size)));
    EXPECT_NE(message, "imported") << size;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  for (const std::size_t at : {3, 5, 9, 20, 40, 60, 80}) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x55);
    EXPECT_EQ(ImportMessage(TinyModel(changed)).find('\n'), std::string::npos);
  }
}

TEST(ImportDetector, ANetworkThatTakesTooMuchMemoryIsAnError) {
  constexpr int kPadding = 400'000;  // an output of 70 GB
  EXPECT_THAT(ImportMessage(TinyModel(testing::TinyDetectorOnnx(kSide, kPadding))), HasSubstr("MiB of memory"));
}

TEST(NetworkDetector, FindsInTheWholeImageAndInTiles) {
  const auto model = ImportDetector(TinyModel(), {});
  ASSERT_TRUE(model) << model.error().message;
  const auto detector = NetworkDetector::Create(*model, {});
  ASSERT_TRUE(detector) << detector.error().message;
  const auto whole = detector->Detect(RedAt({kSide, kSide}, {{16, 32}}));
  ASSERT_TRUE(whole) << whole.error().message;
  ASSERT_EQ(whole->size(), 1);
  EXPECT_GT(IntersectionOverUnion((*whole)[0].box, {16, 32, 16, 16}), 0.99);
  EXPECT_EQ((*whole)[0].category, 0);
  // Four times the input: too small for the whole image, found once although tiles overlap.
  const cv::Size large(4 * kSide, 4 * kSide);  // tiles begin at cells
  EXPECT_GT(detector->RunsOf(large), 12);
  const auto found = detector->Detect(RedAt(large, {{48, 96}, {0, 0}}));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2);
  const auto small_only = NetworkDetector::Create(*model, {.tiles = false});
  EXPECT_TRUE(small_only->Detect(RedAt(large, {{48, 96}}))->empty());
}

TEST(NetworkDetector, OptionsSetTilesAndScore) {
  const auto model = ImportDetector(TinyModel(), {});
  ASSERT_TRUE(model) << model.error().message;
  const cv::Size large(256, 256);
  const auto coarse = NetworkDetector::Create(*model, {.tile_px = 128});
  ASSERT_TRUE(coarse) << coarse.error().message;
  EXPECT_LT(coarse->RunsOf(large), NetworkDetector::Create(*model, {})->RunsOf(large));
  EXPECT_TRUE(coarse->Detect(RedAt(large, {{48, 96}}))->empty());  // 8 px of the input
  const auto lenient = NetworkDetector::Create(*model, {.tile_px = 128, .min_score = 0.1});
  EXPECT_FALSE(lenient->Detect(RedAt(large, {{48, 96}}))->empty());
}

TEST(NetworkDetector, IsThreadSafeAndRepeatable) {
  const auto model = ImportDetector(TinyModel(), {});
  const auto detector = NetworkDetector::Create(model.value(), {});
  std::vector<std::vector<NetworkBox>> found(8);
  oneapi::tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    found[i] = detector->Detect(RedAt({256, 256}, {{16 * static_cast<int>(i), 32}})).value();
  });
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto again = detector->Detect(RedAt({256, 256}, {{16 * static_cast<int>(i), 32}})).value();
    ASSERT_FALSE(found[i].empty());
    ASSERT_EQ(found[i].size(), again.size());
    EXPECT_EQ(found[i][0].box, again[0].box);
    EXPECT_EQ(found[i][0].score, again[0].score);
  }
}

TEST(NetworkDetector, ARunThatFailsIsAnError) {
  const auto model = ImportDetector(TinyModel(), {});
  DetectorModel broken = model.value();
  broken.files.network = "no network";
  const auto detector = NetworkDetector::Create(broken, {});
  ASSERT_FALSE(detector);
  EXPECT_THAT(detector.error().message, HasSubstr("tiny.onnx: "));
  EXPECT_FALSE(NetworkDetector::Create(model.value(), {.tile_overlap = 2}));
  EXPECT_FALSE(NetworkDetector::Create(model.value(), {.interval_s = -1}));
}

}  // namespace
}  // namespace victorious
