#include "bench/workloads.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_objects.h"
#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/photo_model.h"

namespace victorious::bench {
namespace {

// Unwraps a result for generated input, for which an error is a programming error.
template <typename T>
T Unwrap(Expected<T> value) {
  VICTORIOUS_CHECK(value.has_value());
  return *std::move(value);
}

// A view of the flat object from afar: foreshortened along the projected line of sight, which points up in the image.
cv::Mat RenderView(const cv::Mat& object, double azimuth_rad, double off_nadir_rad) {
  const double c = std::cos(azimuth_rad);
  const double s = std::sin(azimuth_rad);
  const double squeeze = std::cos(off_nadir_rad);
  const cv::Matx22d linear(c, -s, squeeze * s, squeeze * c);
  const int side = static_cast<int>(std::ceil(std::hypot(object.cols, object.rows)));
  const cv::Vec2d middle(object.cols / 2.0 - 0.5, object.rows / 2.0 - 0.5);
  const cv::Vec2d shift = cv::Vec2d(side / 2.0 - 0.5, side * squeeze / 2.0 - 0.5) - linear * middle;
  const cv::Matx23d map(linear(0, 0), linear(0, 1), shift[0], linear(1, 0), linear(1, 1), shift[1]);
  cv::Mat smooth;
  cv::GaussianBlur(object, smooth, cv::Size(), 0.6);
  cv::Mat view;
  cv::warpAffine(smooth, view, map, cv::Size(side, static_cast<int>(std::ceil(side * squeeze))));
  return view;
}

std::vector<Photo> RenderAllRoundPhotos(const cv::Mat& object, int every) {
  constexpr int kStepDeg = 10;
  std::vector<Photo> photos;
  int number = 0;
  for (int off_nadir = 0; off_nadir <= 70; off_nadir += kStepDeg) {
    for (int azimuth = 0; azimuth < (off_nadir == 0 ? 1 : 360); azimuth += kStepDeg) {
      if (number++ % every != 0) continue;
      photos.push_back(MakePhoto(RenderView(object, RadiansFromDegrees(azimuth), RadiansFromDegrees(off_nadir))));
    }
  }
  return photos;
}

ObjectModel AllRoundModel(const std::string& name, const cv::Mat& bgra, int every) {
  PhotoModelOptions options;
  options.features.max_features = 100;
  options.min_features = 1;
  return Unwrap(MakePhotoModel(name, RenderAllRoundPhotos(bgra, every), std::nullopt, options));
}

// Draws `count` distinct numbers below `bound`.
std::vector<std::uint32_t> DrawDistinct(std::size_t count, std::size_t bound, Random& random) {
  VICTORIOUS_CHECK(count <= bound);
  std::vector<std::uint32_t> numbers(bound);
  std::iota(numbers.begin(), numbers.end(), 0U);
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(numbers[i], numbers[i + random.Below(static_cast<std::uint32_t>(bound - i))]);
  }
  numbers.resize(count);
  return numbers;
}

}  // namespace

testing::SyntheticFlight MakeSyntheticFlight() {
  testing::FlightOptions options;
  options.seed = 8;
  options.objects = 4;
  options.blur_px = 1.25;  // results in about 1300 keypoints, as in the thesis's frames
  return testing::SyntheticFlight(options);
}

cv::Mat GreyFrame(const testing::SyntheticFlight& flight, int index) { return GreyFromBgr(flight.Render(index).image); }

Photo MakePhoto(const cv::Mat& bgra) {
  cv::Mat bgr;
  cv::Mat alpha;
  cv::cvtColor(bgra, bgr, cv::COLOR_BGRA2BGR);
  cv::extractChannel(bgra, alpha, 3);
  return Unwrap(PreparePhoto("drawn", bgr, alpha, std::nullopt));
}

FeatureSet ExtractFeatures(const cv::Mat& grey, int most) {
  FeatureOptions options;
  options.max_features = most;
  return Unwrap(Unwrap(MakeFeatureExtractor(options))->Extract(grey));
}

ObjectModel PhotoModel(const testing::SyntheticFlight& flight, int object) {
  const Photo photo = MakePhoto(flight.ObjectPhoto(object));
  return Unwrap(MakePhotoModel(flight.ObjectName(object), std::span(&photo, 1), std::nullopt, {}));
}

std::vector<ObjectModel> MakeAllRoundModels(const testing::SyntheticFlight& flight, int every) {
  std::vector<ObjectModel> models;
  for (int object = 0; object < flight.options().objects; ++object) {
    models.push_back(AllRoundModel(flight.ObjectName(object), flight.ObjectPhoto(object), every));
  }
  return models;
}

ObjectModel MakeAllRoundModel(std::uint64_t seed, int every) {
  const auto kind = static_cast<testing::ObjectKind>(seed % testing::kNumObjectKinds);
  return AllRoundModel(fmt::format("{} {}", testing::Name(kind), seed), testing::DrawObject(kind, seed).image, every);
}

std::vector<ObjectModel> MakeAllRoundModels(const testing::SyntheticFlight& flight, int every, std::size_t count) {
  std::vector<ObjectModel> models = MakeAllRoundModels(flight, every);
  models.resize(std::min(models.size(), count));
  for (std::uint64_t seed = 1; models.size() < count; ++seed) models.push_back(MakeAllRoundModel(seed, every));
  return models;
}

std::vector<FeatureView> CollectViews(const std::vector<ObjectModel>& models) {
  std::vector<FeatureView> views;
  for (const ObjectModel& model : models) {
    for (std::size_t v = 0; v < model.views.size(); ++v) views.push_back(model.ViewFeatures(v));
  }
  return views;
}

FeatureSet Concatenate(const std::vector<FeatureView>& views) {
  FeatureSet all;
  for (const FeatureView& view : views) {
    all.keypoints.insert(all.keypoints.end(), view.keypoints.begin(), view.keypoints.end());
    all.descriptors.insert(all.descriptors.end(), view.descriptors.begin(), view.descriptors.end());
  }
  return all;
}

FeatureSet ExtractFromFrames(const testing::SyntheticFlight& flight, int frames) {
  std::vector<FeatureSet> sets;
  for (int i = 0; i < frames; ++i) sets.push_back(ExtractFeatures(GreyFrame(flight, i)));
  std::vector<FeatureView> views;
  for (const FeatureSet& one : sets) views.push_back(one.View());
  return Concatenate(views);
}

cv::Mat FloatDescriptors(const FeatureView& features) {
  cv::Mat descriptors(static_cast<int>(features.size()), static_cast<int>(kDescriptorSize), CV_32F);
  std::ranges::copy(features.descriptors, descriptors.begin<float>());
  return descriptors;
}

MatchedScene SimulateMatches(std::size_t true_matches, std::size_t false_matches, std::uint64_t seed) {
  constexpr double kNoisePx = 0.7;
  constexpr double kLogScaleNoise = 0.08;
  constexpr double kTurnNoiseRad = 0.08;
  Random random(seed);
  MatchedScene drawn;
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  drawn.scene = ExtractFeatures(GreyFrame(flight)).keypoints;
  drawn.model = ExtractFeatures(GreyFrame(flight, 60)(cv::Rect(200, 150, 150, 120))).keypoints;
  for (const std::uint32_t scene : DrawDistinct(false_matches, drawn.scene.size(), random)) {
    drawn.matches.push_back({scene, random.Below(static_cast<std::uint32_t>(drawn.model.size())), 0.75F});
  }
  const Similarity2 fit{0.9, 0.7, {320, 200}};
  for (const std::uint32_t model : DrawDistinct(true_matches, drawn.model.size(), random)) {
    const Keypoint& m = drawn.model[model];
    const Eigen::Vector2d place = fit.Apply({m.x, m.y});
    drawn.matches.push_back({static_cast<std::uint32_t>(drawn.scene.size()), model, 0.6F});
    drawn.scene.push_back(
        {static_cast<float>(place.x() + kNoisePx * random.Normal()),
         static_cast<float>(place.y() + kNoisePx * random.Normal()),
         static_cast<float>(m.scale_px * fit.scale * std::exp(kLogScaleNoise * random.Normal())),
         static_cast<float>(WrapAngle(m.orientation_rad + fit.rotation_rad + kTurnNoiseRad * random.Normal()))});
  }
  return drawn;
}

std::vector<PointPair> MakePointPairs(const MatchedScene& scene, const MatchSet& matches) {
  std::vector<PointPair> pairs;
  for (const Match& match : matches) {
    const Keypoint& s = scene.scene[match.scene_keypoint];
    const Keypoint& m = scene.model[match.template_keypoint];
    pairs.push_back({{m.x, m.y}, {s.x, s.y}});
  }
  return pairs;
}

}  // namespace victorious::bench
