#include "victorious/evaluate/findable.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "victorious/evaluate/drawn_clutter.h"
#include "testing/waffle.h"

namespace victorious {
namespace {

Expected<Findable> Measure(const ObjectModel& model, const FindableOptions& options, const FindableWatch& watch = {}) {
  return HowFindable(model, FaintFeatures(), {}, options, CancelToken(), watch);
}

FindableOptions Few(double size_px) {
  FindableOptions options;
  options.size_px = size_px;
  options.directions = 3;
  return options;
}

TEST(Findable, TheLargeAreFoundTheTinyAreNot) {
  const Findable large = Measure(testing::WaffleModel(), Few(200)).value();
  const Findable tiny = Measure(testing::WaffleModel(), Few(10)).value();
  EXPECT_GE(large.share.found, 2);
  EXPECT_EQ(tiny.share.found, 0);
  EXPECT_EQ(large.share.asked, 3);
  ASSERT_EQ(large.bands.size(), 2U);  // 0 to 30 and 30 to 60 degrees
  EXPECT_EQ(large.bands[0].share.asked, 2);
  EXPECT_DOUBLE_EQ(large.bands[1].most_deg, 60);
  ASSERT_TRUE(large.least.half_px);
  EXPECT_GT(*large.least.half_px, 10);
  EXPECT_LT(*large.least.half_px, 200);
  if (large.least.most_px) {
    EXPECT_LE(*large.least.half_px, *large.least.most_px);
  }
}

// Noise reduces the detections, and the missed images are then repeated without it.
TEST(Findable, NoiseHidesAndItsAbsenceHelps) {
  FindableOptions options = Few(100);
  const Findable quiet = Measure(testing::WaffleModel(), options).value();
  EXPECT_FALSE(quiet.quiet);
  options.noise = 0.6;
  const Findable noisy = Measure(testing::WaffleModel(), options).value();
  EXPECT_LT(noisy.share.found, quiet.share.found);
  ASSERT_TRUE(noisy.quiet);
  EXPECT_EQ(noisy.quiet->found, quiet.share.found);
}

TEST(Findable, TheSameSeedTellsTheSame) {
  const Findable first = Measure(testing::WaffleModel(), Few(60)).value();
  const Findable again = Measure(testing::WaffleModel(), Few(60)).value();
  EXPECT_EQ(ToJson(first), ToJson(again));
}

TEST(Findable, IsSeenInASunWithoutAnAttitude) {
  FindableOptions options = Few(120);
  options.sun_deg = 50;
  options.attitude_known = false;
  int pictures = 0;
  FindableWatch watch;
  watch.picture = [&](const cv::Mat& bgr) { pictures += bgr.type() == CV_8UC3 ? 1 : 0; };
  const Findable lit = Measure(testing::WaffleModel(), options, watch).value();
  EXPECT_EQ(pictures, 3);
  EXPECT_GT(lit.share.found, 0);
}

// A uniform side of the model: the report names the interval and the reason.
TEST(Findable, SaysWhatWouldHelp) {
  Findable findable;
  findable.largest_px = 256;
  findable.options.noise = 0.1;
  findable.share = {.asked = 10, .found = 4, .right_view = 4};
  findable.quiet = FoundShare{.asked = 10, .found = 8, .right_view = 8};
  findable.bands.resize(2);
  findable.bands[0] = {.least_deg = 0, .most_deg = 35, .share = {}, .least = {.half_px = 32, .most_px = 64}};
  findable.bands[1] = {.least_deg = 35, .most_deg = 70, .share = {}, .least = {}, .features = 7};
  const std::string text = ToText(findable);
  EXPECT_NE(text.find("At 0 to 35 degrees off nadir, 90 % are detected from 64 px"), std::string::npos)
      << text;
  EXPECT_NE(text.find("7 features per view"), std::string::npos) << text;
  EXPECT_NE(text.find("Without the noise, the detected fraction at 64 px rises from 0.40 to 0.80"), std::string::npos)
      << text;
  const auto json = ToJson(findable);
  EXPECT_TRUE(json["bands"][1]["half_found_from_px"].is_null());
  EXPECT_EQ(json["found_without_noise"], 0.8);
  EXPECT_EQ(json["advice"].size(), 3U);
}

TEST(Findable, RefusesWhatItCannotMeasure) {
  for (const double size_px : {0.0, 7.0, 1e9, std::nan("")}) {
    EXPECT_EQ(Measure(testing::WaffleModel(), Few(size_px)).error().code, ErrorCode::kInvalidArgument) << size_px;
  }
  FindableOptions low = Few(64);
  low.sun_deg = 2;
  EXPECT_NE(Measure(testing::WaffleModel(), low).error().message.find("5 to 90"), std::string::npos);
  ObjectModel photos = testing::WaffleModel();
  photos.views[2].surface = {};
  EXPECT_NE(Measure(photos, Few(64)).error().message.find("CAD"), std::string::npos);
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_EQ(HowFindable(testing::WaffleModel(), FaintFeatures(), {}, Few(64), cancel).error().code,
            ErrorCode::kCancelled);
}

TEST(DrawnClutter, IsItsSeedsAloneAndFullOfEdges) {
  const cv::Mat clutter = DrawClutter({320, 240}, 5);
  EXPECT_EQ(cv::norm(clutter, DrawClutter({320, 240}, 5), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(clutter, DrawClutter({320, 240}, 6), cv::NORM_INF), 50);
  const auto extractor = MakeFeatureExtractor(FaintFeatures()).value();
  EXPECT_GT(extractor->Extract(clutter).value().size(), 400U);
}

}  // namespace
}  // namespace victorious
