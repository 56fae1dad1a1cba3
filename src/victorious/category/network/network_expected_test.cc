// Detectors made by others, against boxes that reference decoders gave: $VICTORIOUS_DATA/onnx.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/category/network/network_detector.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

struct KnownNetwork {
  const char* name;
  const char* network;
  const char* weights;
  const char* classes;
  DetectorLayout layout;
};

class NetworkExpected : public ::testing::TestWithParam<KnownNetwork> {};

DetectorModel ReadKnown(const fs::path& folder, const KnownNetwork& known) {
  DetectorModel model{.source = known.network};
  model.files.network = ReadFile(folder / known.network).value();
  if (*known.weights != '\0') model.files.weights = ReadFile(folder / known.weights).value();
  model.classes = ParseClassList(ReadFile(folder / known.classes).value(), known.classes).value();
  return model;
}

TEST_P(NetworkExpected, GivesTheBoxesOfTheReference) {
  VICTORIOUS_DATA_OR_SKIP(folder, "onnx");
  constexpr double kMinOverlap = 0.95;
  constexpr double kMaxScoreError = 0.015;
  const auto model = ImportDetector(ReadKnown(folder, GetParam()), {});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->settings.layout, GetParam().layout);
  const auto detector = NetworkDetector::Create(*model, {.tiles = false});
  ASSERT_TRUE(detector) << detector.error().message;
  int expected = 0;
  int agreeing = 0;
  int reported = 0;
  int image_count = 0;
  for (const char* name : {"dog", "motorbike", "car_side", "tile", "oblique", "nadir", "nadir_park"}) {
    const fs::path file = folder / "expected" / (std::string(GetParam().name) + "_" + name + ".json");
    const auto text = ReadFile(file);
    ASSERT_TRUE(text) << text.error().message;
    const nlohmann::json reference = ParseStrictJson(*text).value();
    const fs::path image_file = folder.parent_path() / reference["picture"].get<std::string>();
    cv::Mat image = cv::imread(image_file.string());
    ASSERT_FALSE(image.empty()) << image_file;
    ++image_count;
    if (reference.contains("crop")) {
      const auto crop = reference["crop"].get<std::vector<int>>();
      image = image(cv::Rect(crop[0], crop[1], crop[2], crop[3])).clone();
    }
    const auto found = detector->Detect(image);
    ASSERT_TRUE(found) << found.error().message;
    reported += static_cast<int>(found->size());
    for (const nlohmann::json& one : reference["boxes"]) {
      ++expected;
      const Box box =
          Intersection({one["x"].get<double>(), one["y"].get<double>(), one["w"].get<double>(), one["h"].get<double>()},
                       FrameBox(image.cols, image.rows));
      const bool agrees = std::ranges::any_of(*found, [&](const NetworkBox& own) {
        return own.category == one["class_id"].get<std::size_t>() &&
               IntersectionOverUnion(own.box, box) >= kMinOverlap &&
               std::abs(own.score - one["score"].get<double>()) <= kMaxScoreError;
      });
      agreeing += agrees ? 1 : 0;
      if (!agrees) std::printf("%s %s: no box for %s\n", GetParam().name, name, one.dump().c_str());
    }
  }
  std::printf("%s: %d of %d boxes agree in %d images; %d reported\n", GetParam().name, agreeing, expected, image_count,
              reported);
  EXPECT_GE(agreeing, 0.99 * expected);
  EXPECT_GE(expected, 0.99 * reported);
  EXPECT_GT(expected, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Networks, NetworkExpected,
    ::testing::Values(KnownNetwork{"yolox_nano", "yolox_nano.onnx", "", "coco.names", DetectorLayout::kYolox},
                      KnownNetwork{"nanodet_m", "nanodet_m.onnx", "", "coco.names", DetectorLayout::kNanodet},
                      KnownNetwork{"fastestdet", "fastestdet.onnx", "", "coco.names", DetectorLayout::kFastestdet},
                      KnownNetwork{"dronetv3", "dronetv3.cfg", "dronetv3.weights", "dronetv3.names",
                                   DetectorLayout::kDarknet}),
    [](const auto& known) { return std::string(known.param.name); });

}  // namespace
}  // namespace victorious
