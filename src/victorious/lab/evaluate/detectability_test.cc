#include "victorious/lab/evaluate/detectability.h"

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/small_cad_model.h"
#include "victorious/lab/evaluate/detectability_report.h"
#include "victorious/lab/evaluate/drawn_clutter.h"
#include "victorious/object/model/model_file.h"
#include "victorious/object/model/photo_model.h"

namespace victorious {
namespace {

Expected<Detectability> Measure(const ObjectModel& model, const DetectabilityOptions& options,
                                const DetectabilityCallbacks& callbacks = {}) {
  return MeasureDetectability(model, LowContrastFeatureOptions(), {}, options, CancelToken(), callbacks);
}

DetectabilityOptions Few(double size_px) {
  DetectabilityOptions options;
  options.size_px = size_px;
  options.directions = 3;
  return options;
}

TEST(Detectability, LargeModelsAreFoundTinyOnesAreNot) {
  const Detectability large = Measure(testing::SmallCadModel(), Few(200)).value();
  const Detectability tiny = Measure(testing::SmallCadModel(), Few(10)).value();
  EXPECT_GE(large.rate.found, 2);
  EXPECT_EQ(tiny.rate.found, 0);
  EXPECT_EQ(large.rate.tested, 3);
  ASSERT_EQ(large.bands.size(), 2U);  // 0 to 30 and 30 to 60 degrees
  EXPECT_EQ(large.bands[0].rate.tested, 2);
  EXPECT_DOUBLE_EQ(large.bands[1].max_deg, 60);
  ASSERT_TRUE(large.min_size.size_50_px);
  EXPECT_GT(*large.min_size.size_50_px, 10);
  EXPECT_LT(*large.min_size.size_50_px, 200);
  if (large.min_size.size_90_px) {
    EXPECT_LE(*large.min_size.size_50_px, *large.min_size.size_90_px);
  }
}

// Noise reduces the detections, and the missed images are then repeated without it.
TEST(Detectability, NoiseLowersTheDetectionRate) {
  DetectabilityOptions options = Few(100);
  const Detectability without_noise = Measure(testing::SmallCadModel(), options).value();
  EXPECT_FALSE(without_noise.without_noise);
  options.noise = 0.9;
  const Detectability noisy = Measure(testing::SmallCadModel(), options).value();
  EXPECT_LT(noisy.rate.found, without_noise.rate.found);
  ASSERT_TRUE(noisy.without_noise);
  EXPECT_EQ(noisy.without_noise->found, without_noise.rate.found);
}

TEST(Detectability, IsDeterministicBySeed) {
  const Detectability first = Measure(testing::SmallCadModel(), Few(60)).value();
  const Detectability again = Measure(testing::SmallCadModel(), Few(60)).value();
  EXPECT_EQ(ToJson(first), ToJson(again));
}

TEST(Detectability, RendersUnderSunWithoutAttitude) {
  DetectabilityOptions options = Few(120);
  options.sun_deg = 50;
  options.attitude_known = false;
  int images = 0;
  DetectabilityCallbacks callbacks;
  callbacks.image = [&](const cv::Mat& bgr) { images += bgr.type() == CV_8UC3 ? 1 : 0; };
  const Detectability sunlit = Measure(testing::SmallCadModel(), options, callbacks).value();
  EXPECT_EQ(images, 3);
  EXPECT_GT(sunlit.rate.found, 0);
}

// A uniform side of the model: the report names the interval and the reason.
TEST(Detectability, SuggestsRemedies) {
  Detectability findable;
  findable.max_size_px = 256;
  findable.options.noise = 0.1;
  findable.rate = {.tested = 10, .found = 4, .correct_view = 4};
  findable.without_noise = DetectionRate{.tested = 10, .found = 8, .correct_view = 8};
  findable.bands.resize(2);
  findable.bands[0] = {.min_deg = 0, .max_deg = 35, .rate = {}, .min_size = {.size_50_px = 32, .size_90_px = 64}};
  findable.bands[1] = {.min_deg = 35, .max_deg = 70, .rate = {}, .min_size = {}, .features = 7};
  const std::string text = ToText(findable);
  EXPECT_NE(text.find("At 0 to 35 degrees off nadir, 90 % are detected from 64 px"), std::string::npos) << text;
  EXPECT_NE(text.find("7 features per view"), std::string::npos) << text;
  EXPECT_NE(text.find("Without the noise, the detected fraction at 64 px rises from 0.40 to 0.80"), std::string::npos)
      << text;
  const auto json = ToJson(findable);
  EXPECT_TRUE(json["bands"][1]["half_found_from_px"].is_null());
  EXPECT_EQ(json["found_without_noise"], 0.8);
  EXPECT_EQ(json["advice"].size(), 3U);
}

// A model of photos is tested by its photos, turned; one without texture is found at no size.
TEST(Detectability, MeasuresModelsOfPhotos) {
  cv::Mat textured;
  cv::cvtColor(DrawClutter({200, 150}, 3), textured, cv::COLOR_GRAY2BGR);
  cv::Mat plain(150, 200, CV_8UC3, cv::Scalar::all(120));
  for (int i = 0; i < 4; ++i) cv::circle(plain, {40 + 40 * i, 75}, 8, cv::Scalar::all(200), cv::FILLED);
  const auto model_of = [](const cv::Mat& bgr) {
    const Photo photo = PreparePhoto("photo.png", bgr, {}, std::nullopt).value();
    const ObjectModel made = MakePhotoModel("board", std::span(&photo, 1), std::nullopt, {}).value();
    auto bytes = std::make_shared<std::vector<std::byte>>(EncodeModel(made).value());
    return ParseModel(*bytes, bytes, "board").value();
  };
  DetectabilityOptions options = Few(120);
  options.directions = 6;
  std::vector<cv::Mat> images;
  DetectabilityCallbacks callbacks;
  callbacks.image = [&](const cv::Mat& bgr) { images.push_back(bgr); };
  const Detectability rich = Measure(model_of(textured), options, callbacks).value();
  EXPECT_TRUE(rich.of_photos);
  EXPECT_EQ(images.size(), 6U);
  EXPECT_GE(rich.bands.front().rate.found, 3) << ToText(rich);
  EXPECT_EQ(rich.bands.front().rate.correct_view, rich.bands.front().rate.found);
  EXPECT_EQ(rich.max_size_px, 128);
  EXPECT_NE(ToText(rich).find("0 to 25 degrees from the photo's direction"), std::string::npos) << ToText(rich);
  EXPECT_TRUE(ToJson(rich)["bands"][0].contains("turned_deg"));
  const Detectability poor = Measure(model_of(plain), options).value();
  EXPECT_LT(poor.rate.found, rich.rate.found);
  options.sun_deg = 40;
  EXPECT_NE(Measure(model_of(textured), options).error().message.find("photos"), std::string::npos);
}

TEST(Detectability, RefusesInvalidOptionsAndModelsWithoutImages) {
  for (const double size_px : {0.0, 7.0, 1e9, std::nan("")}) {
    EXPECT_EQ(Measure(testing::SmallCadModel(), Few(size_px)).error().code, ErrorCode::kInvalidArgument) << size_px;
  }
  DetectabilityOptions low = Few(64);
  low.sun_deg = 2;
  EXPECT_NE(Measure(testing::SmallCadModel(), low).error().message.find("5 to 90"), std::string::npos);
  ObjectModel bare = testing::SmallCadModel();
  bare.views[2].surface = {};
  EXPECT_NE(Measure(bare, Few(64)).error().message.find("stores no images"), std::string::npos);
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_EQ(
      MeasureDetectability(testing::SmallCadModel(), LowContrastFeatureOptions(), {}, Few(64), cancel).error().code,
      ErrorCode::kCancelled);
}

TEST(DrawClutter, DependsOnlyOnSeedAndIsFullOfEdges) {
  const cv::Mat clutter = DrawClutter({320, 240}, 5);
  EXPECT_EQ(cv::norm(clutter, DrawClutter({320, 240}, 5), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(clutter, DrawClutter({320, 240}, 6), cv::NORM_INF), 50);
  const auto extractor = MakeFeatureExtractor(LowContrastFeatureOptions()).value();
  EXPECT_GT(extractor->Extract(clutter).value().size(), 400U);
}

}  // namespace
}  // namespace victorious
