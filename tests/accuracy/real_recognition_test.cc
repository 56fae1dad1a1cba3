// Recognition of known objects in real images: one detection at the true place, and no false positives.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "tests/accuracy/real_images.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/video/video_reader.h"

namespace victorious::testing {
namespace {

constexpr double kMinOverlap = 0.7;

cv::Mat ReadBgr(const std::string& relative) { return ReadImage(DataPath(kRecognitionData) / relative).value().bgr; }

Polygon WholeOf(const cv::Mat& image) {
  return BoxCorners({0, 0, static_cast<double>(image.cols), static_cast<double>(image.rows)});
}

// A scene with the name and outline of the only model in it.
struct Scene {
  std::string name;
  cv::Mat image;
  std::size_t model;
  Polygon outline;
};

class RealRecognition : public ::testing::Test {
 protected:
  enum Model : std::size_t { kBox, kGraf, kBoat, kWall };

  static std::vector<ObjectModel> Models() {
    return {MakeModel("box", ReadBgr("find_object/box.png")), MakeModel("graf", Series("graf").ReadBgr(1)),
            MakeModel("boat", Series("boat").ReadBgr(1)), MakeModel("wall", Series("wall").ReadBgr(1))};
  }

  static std::vector<Scene> Scenes() {
    const cv::Mat box = ReadBgr("find_object/box.png");
    const cv::Mat box_scene = ReadBgr("find_object/box_in_scene.png");
    std::vector<Scene> scenes = {
        {"box in its scene", box_scene, kBox,
         Project(WholeOf(box), EstimateHomographyByOpenCv(GreyFromBgr(box), GreyFromBgr(box_scene)))}};
    const auto add = [&](const Series& series, std::size_t model, std::initializer_list<int> numbers) {
      const Polygon whole = WholeOf(series.ReadBgr(1));
      for (const int number : numbers) {
        scenes.push_back({fmt::format("{} 1 in {}", series.name(), number), series.ReadBgr(number), model,
                          Project(whole, series.HomographyFromFirst(number))});
      }
    };
    add(Series("graf"), kGraf, {2, 3});
    add(Series("boat"), kBoat, {2, 3, 4});
    add(Series("wall"), kWall, {3});
    return scenes;
  }
};

TEST_F(RealRecognition, FindsEachModelOnceAtItsPosition) {
  VICTORIOUS_DATA_OR_SKIP(data, kRecognitionData);
  const Recognizer recognizer = MakeRecognizer(Models());
  for (const Scene& scene : Scenes()) {
    SCOPED_TRACE(scene.name);
    const std::vector<Detection> found = recognizer.Recognize(ExtractFeatures(GreyFromBgr(scene.image))).value();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].model_index, scene.model);
    const OutlineOverlap agreement = CompareOutlines(found[0].outline, scene.outline, scene.image.size());
    fmt::print("{:<18} score {:.3f}, {:>4} inliers, overlap {:.3f} in view, {:.3f} whole\n", scene.name, found[0].score,
               found[0].fit.inliers.size(), agreement.in_view, agreement.whole);
    EXPECT_GE(agreement.in_view, kMinOverlap);
  }
}

TEST_F(RealRecognition, FindsThePostcardInEveryFrame) {
  VICTORIOUS_DATA_OR_SKIP(data, "real/recognition/visp_video/postcard/video-postcard.mp4");
  constexpr Box kPostcard{62, 82, 252, 250};  // in frame 0
  constexpr std::int64_t kCompareEvery = 10;
  const auto reader = VideoReader::Open(data.string(), {.color = FrameColor::kBgr}).value();
  std::optional<Recognizer> recognizer;
  cv::Mat card;  // grey, of frame 0
  int frames = 0;
  int found_once = 0;
  int others = 0;
  double min_overlap = 1;
  while (const std::optional<Frame> frame = reader->NextFrame().value()) {
    if (!recognizer) {
      card = GreyFromBgr(frame->image)(cv::Rect(62, 82, 252, 250)).clone();
      std::vector<ObjectModel> models = Models();
      models.push_back(MakeModel("postcard", frame->image, kPostcard));
      recognizer = MakeRecognizer(std::move(models));
    }
    const cv::Mat grey = GreyFromBgr(frame->image);
    const std::vector<Detection> found = recognizer->Recognize(ExtractFeatures(grey)).value();
    const auto is_card = [](const Detection& one) { return one.model_index == kWall + 1; };
    const auto cards = std::ranges::count_if(found, is_card);
    ++frames;
    found_once += cards == 1 ? 1 : 0;
    others += static_cast<int>(found.size()) - static_cast<int>(cards);
    if (cards == 1 && frame->index % kCompareEvery == 0) {
      const Polygon truth = Project(WholeOf(card), EstimateHomographyByOpenCv(card, grey));
      const Polygon& outline = std::ranges::find_if(found, is_card)->outline;
      min_overlap = std::min(min_overlap, CompareOutlines(outline, truth, grey.size()).in_view);
    }
  }
  fmt::print("postcard: once in {} of {} frames, least overlap {:.3f}; {} other finds\n", found_once, frames,
             min_overlap, others);
  EXPECT_GT(frames, 100);
  EXPECT_EQ(found_once, frames);
  EXPECT_EQ(others, 0);
  EXPECT_GE(min_overlap, kMinOverlap);
}

}  // namespace
}  // namespace victorious::testing
