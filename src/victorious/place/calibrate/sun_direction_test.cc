#include "victorious/place/calibrate/sun_direction.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/textured_scenes.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kFrames = 72;  // 24 are sampled: 1, 4, 7, ... 70
constexpr double kYaw_rad = 0.4;
constexpr std::size_t kView = 2;     // seen from azimuth 60 degrees: the camera looks towards 240
constexpr std::size_t kSunView = 3;  // lit from azimuth 90: 150 degrees to the left of the line of sight
constexpr double kRelativeSun_rad = -5 * kPi / 6;
constexpr std::int64_t kNoon_us = 1'591'012'800'000'000;  // 2020-06-01 12:00 UTC
constexpr std::int64_t kHalfDay_us = 43'200'000'000;

// The same scene in every frame, or in every second sampled frame another one; 10 frames per second.
class SceneReader final : public VideoReader {
 public:
  explicit SceneReader(cv::Mat scene, int frames = kFrames) : scene_(std::move(scene)), frames_(frames) {
    description.frame_rate = 10;
    description.frame_count = frames;
  }

  [[nodiscard]] const VideoInfo& info() const override { return description; }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& /*cancel*/,
                                                const ByteProgress& /*progress*/) const override {
    return "scene";
  }
  Expected<std::optional<Frame>> NextFrame() override {
    if (next == broken_at) return Fail(ErrorCode::kDataLoss, "broken");
    if (next == frames_) return std::nullopt;
    const std::int64_t index = next++;
    ++read;
    cv::Mat image = (!other_scene.empty() && index / 3 % 2 == 1 ? other_scene : scene_).clone();
    image.at<std::uint8_t>(0, 0) = static_cast<std::uint8_t>(index);  // FailingExtractor reads it
    return Frame{.index = index, .time_s = 0.1 * static_cast<double>(index), .image = std::move(image)};
  }
  std::vector<DataPacket> TakeDataPackets() override { return {}; }
  bool SeekTo(double time_s) override {
    next = std::max<std::int64_t>(0, std::llround(10 * time_s) - 20);  // a key frame before it
    return true;
  }
  void SkipToEnd() override { next = frames_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

  VideoInfo description;
  std::int64_t next = 0;
  std::int64_t read = 0;
  std::int64_t broken_at = -1;
  cv::Mat other_scene;

 private:
  cv::Mat scene_;
  std::int64_t frames_;
  std::vector<std::string> warnings_;
};

// Fails on the frames up to one.
class FailingExtractor final : public FeatureExtractor {
 public:
  explicit FailingExtractor(int last_failure) : last_failure_(last_failure) {}
  Expected<FeatureSet> Extract(const cv::Mat& grey) const override {
    if (grey.at<std::uint8_t>(0, 0) <= last_failure_) return Fail(ErrorCode::kInternal, "out of memory");
    return testing::FeaturesOf(grey);
  }

 private:
  int last_failure_;
};

cv::Mat SunlitScene(std::size_t sun_view = kSunView) {
  cv::Mat scene = testing::Texture(640, 480, 4);
  testing::Paste(testing::SunDependentTemplates::ImageOf(sun_view, kView), 1.0, 0, {320, 240}, scene);
  return scene;
}

// A camera that looks at the object, with a clock or without.
CameraTrajectory Cameras(std::optional<std::int64_t> utc_us = std::nullopt, int frames = kFrames) {
  std::vector<CameraState> states;
  for (int i = 0; i <= frames; ++i) {
    states.push_back({.time_s = 0.1 * i,
                      .place = {RadiansFromDegrees(48), RadiansFromDegrees(11), 500},
                      .attitude = Attitude{kYaw_rad, testing::kOffNadir_rad - kPi / 2, 0},
                      .hfov_rad = 0.3,
                      .utc_us = utc_us});
  }
  return {std::move(states), 2};
}

class EstimateSunDirectionTest : public ::testing::Test {
 protected:
  static const Recognizer& RelightingRecognizer() {
    static const Recognizer recognizer = Recognizer::Create({testing::ModelFromAround()}, FeatureOptions().engine, {},
                                                            {std::make_shared<const testing::SunDependentTemplates>()})
                                             .value();
    return recognizer;
  }

  Expected<std::optional<Sun>> Estimate(SceneReader& reader, const CameraTrajectory& cameras = Cameras(),
                                        int last_failure = -1) {
    warnings_.clear();
    return EstimateSunDirection({cameras, RelightingRecognizer(), FailingExtractor(last_failure), options_}, reader,
                                cancel_, [&](const std::string& warning) { warnings_.push_back(warning); });
  }

  SunDirectionOptions options_;
  CancelToken cancel_;
  std::vector<std::string> warnings_;
};

TEST_F(EstimateSunDirectionTest, FindsTheSunThatTheFramesAgreeOnAndReadsNoFurther) {
  SceneReader reader(SunlitScene());
  const std::optional<Sun> sun = Estimate(reader).value();
  ASSERT_TRUE(sun);
  EXPECT_NEAR(WrapAngle(sun->azimuth_rad - kYaw_rad - kRelativeSun_rad), 0, 0.2) << "from north";
  EXPECT_GT(sun->elevation_rad, 0.1);
  EXPECT_LT(reader.next, kFrames) << "three samples agree";
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(EstimateSunDirectionTest, ReadsLittleOfALongVideo) {
  constexpr int kLong = 36'000;  // an hour, of which 200 frames are sampled: 90, 270, ...
  SceneReader reader(SunlitScene(), kLong);
  EXPECT_TRUE(Estimate(reader, Cameras({}, kLong)).value());
  EXPECT_LT(reader.read, 1000);
  SceneReader longer(SunlitScene(), 3 * kLong);  // 270, 810, ... are sought
  EXPECT_TRUE(Estimate(longer, Cameras({}, 3 * kLong)).value());
  EXPECT_LT(longer.read, 21 * 8) << "of four samples, and one or two batches read ahead";
  EXPECT_GT(longer.next, 3 * 540);
}

TEST_F(EstimateSunDirectionTest, SamplesOnWhileTheEvidenceIsDivided) {
  SceneReader reader(SunlitScene());
  reader.other_scene = SunlitScene(kSunView + 6);  // the opposite azimuth
  EXPECT_TRUE(Estimate(reader).value());
  EXPECT_EQ(reader.next, kFrames) << "three estimates agree, but as many contradict them";
}

TEST_F(EstimateSunDirectionTest, SunOffSearchesForNone) {
  options_.sun = SunSearch::kOff;
  SceneReader reader(SunlitScene());
  EXPECT_FALSE(Estimate(reader).value());
  EXPECT_FALSE(Estimate(reader, Cameras(kNoon_us)).value()) << "nor by the ephemeris";
  EXPECT_EQ(reader.next, 0);
}

TEST_F(EstimateSunDirectionTest, AClockGivesTheSunByTheEphemerisWithoutReading) {
  SceneReader reader(SunlitScene());
  const CameraTrajectory cameras = Cameras(kNoon_us);
  const std::optional<Sun> sun = Estimate(reader, cameras).value();
  ASSERT_TRUE(sun);
  const Sun expected = SunAt(kNoon_us, cameras.states()[0].place);
  EXPECT_EQ(sun->azimuth_rad, expected.azimuth_rad);
  EXPECT_EQ(sun->elevation_rad, expected.elevation_rad);
  EXPECT_FALSE(Estimate(reader, Cameras(kNoon_us + kHalfDay_us)).value()) << "at night";
  EXPECT_EQ(reader.next, 0);
}

TEST_F(EstimateSunDirectionTest, ThereIsNoneWithoutTheObjectOrAttitudeAndOfALiveSource) {
  SceneReader empty(testing::Texture(640, 480, 5));
  EXPECT_FALSE(Estimate(empty).value());
  EXPECT_EQ(empty.next, kFrames) << "every sample is tried";
  SceneReader sunlit(SunlitScene());
  EXPECT_FALSE(Estimate(sunlit, CameraTrajectory({}, 2)).value());
  SceneReader live(SunlitScene());
  live.description.live = true;
  EXPECT_FALSE(Estimate(live).value());
  EXPECT_EQ(live.next, 0) << "it cannot be read again for the search";
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(EstimateSunDirectionTest, FramesWithoutFeaturesAreSkippedWithAWarning) {
  SceneReader reader(SunlitScene());
  const std::optional<Sun> sun = Estimate(reader, Cameras(), /*last_failure=*/4).value();
  ASSERT_TRUE(sun);
  EXPECT_NEAR(WrapAngle(sun->azimuth_rad - kYaw_rad - kRelativeSun_rad), 0, 0.2);
  EXPECT_THAT(warnings_, ElementsAre("the sun's direction: 2 of 6 sampled frames are skipped: out of memory"));
}

TEST_F(EstimateSunDirectionTest, AReadErrorEndsTheSamplingWithAWarning) {
  SceneReader reader(SunlitScene());
  reader.broken_at = 6;
  const std::optional<Sun> sun = Estimate(reader).value();
  ASSERT_TRUE(sun) << "two samples agree";
  EXPECT_NEAR(WrapAngle(sun->azimuth_rad - kYaw_rad - kRelativeSun_rad), 0, 0.2);
  EXPECT_THAT(warnings_, ElementsAre("the sun's direction is estimated from the frames before an error: broken"));
}

TEST_F(EstimateSunDirectionTest, CancellationIsAnError) {
  SceneReader reader(SunlitScene());
  cancel_.Cancel();
  const auto sun = Estimate(reader);
  ASSERT_FALSE(sun);
  EXPECT_EQ(sun.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace victorious
