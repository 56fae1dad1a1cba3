// The methods that search a CAD model, on scenes with a rendered object: recognize/ cannot render.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/small_cad_model.h"
#include "testing/textured_scenes.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/relit_views.h"
#include "victorious/object/model/view_surface.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {
namespace {

// 97 views, every 15 degrees.
const ObjectModel& ModelOfManyViews() {
  static const ObjectModel model = testing::MakeSmallCadModel({.step_deg = 15, .max_off_nadir_deg = 60});
  return model;
}

// 58 views of equal density, as they are read from their file.
const ObjectModel& ModelOfEvenViews() {
  static const ObjectModel model = [] {
    const testing::ScratchFolder folder;
    const ModelLibrary library(folder.path());
    const Status added =
        library.Add(testing::MakeSmallCadModel({.step_deg = 15, .max_off_nadir_deg = 60, .layout = ViewLayout::kEven}));
    EXPECT_TRUE(added) << added.error().message;
    return library.Load("slab").value();
  }();
  return model;
}

// Renderings from directions between those views.
const ObjectModel& ViewsBetween() {
  static const ObjectModel model = testing::MakeSmallCadModel({.step_deg = 40, .max_off_nadir_deg = 40});
  return model;
}

// A scene that shows the object as view `number` of ViewsBetween() does, at half its size.
cv::Mat SceneOfMethods(std::size_t number) {
  const ViewSurface surface = DecodeSurface(ViewsBetween().views[number].surface, "slab").value();
  const cv::Mat mask = surface.depth_map.depth_m == surface.depth_map.depth_m;  // not NaN
  cv::Mat scene = testing::Texture(640, 480, number);
  const cv::Matx23d map(0.5, 0, 60.0 + 20 * static_cast<double>(number), 0, 0.5, 80);
  cv::Mat object;
  cv::Mat shown;
  cv::warpAffine(surface.grey, object, map, scene.size(), cv::INTER_AREA);
  cv::warpAffine(mask, shown, map, scene.size(), cv::INTER_NEAREST);
  object.copyTo(scene, shown);
  return scene;
}

std::vector<Detection> Find(const cv::Mat& scene, const RecognizeOptions& options, const FrameConditions& conditions,
                            const ObjectModel& model = ModelOfManyViews()) {
  std::shared_ptr<const RelitTemplateSource> relit = MakeRelitViews(model).value();
  return Recognizer::Create({model}, model.engine, options, {std::move(relit)})
      .value()
      .Recognize(testing::FeaturesOf(scene), conditions)
      .value();
}

RecognizeOptions SearchedBy(SearchMethod method) {
  RecognizeOptions options;
  options.method = method;
  return options;
}

// A camera that sees the objects of ViewsBetween() upright.
FrameConditions ConditionsWithSun() {
  return {.vertical = MakeVertical({0, RadiansFromDegrees(40) - kPi / 2, 0}, 0.3, 640, 480),
          .relative_sun = Sun{.azimuth_rad = 1, .elevation_rad = 0.7}};
}

TEST(SearchMethods, ShortlistFindsInRenderedScenesWhatVotesFind) {
  for (const std::size_t number : {2, 5}) {
    const cv::Mat scene = SceneOfMethods(number);
    for (const FrameConditions& conditions : {FrameConditions{}, ConditionsWithSun()}) {
      const std::vector<Detection> expected = Find(scene, SearchedBy(SearchMethod::kVotes), conditions);
      const std::vector<Detection> found = Find(scene, SearchedBy(SearchMethod::kShortlist), conditions);
      ASSERT_EQ(expected.size(), 1U) << number;
      ASSERT_EQ(found.size(), 1U) << number;
      EXPECT_GT(IntersectionOverUnion(found[0].box, expected[0].box), 0.8) << number;
      EXPECT_GT(found[0].neg_log10_nfa, 0.7 * expected[0].neg_log10_nfa) << number;
    }
  }
}

TEST(SearchMethods, ShortlistIsTheSameForAnyNumberOfThreads) {
  const cv::Mat scene = SceneOfMethods(4);
  const auto find = [&](int threads) {
    oneapi::tbb::task_arena arena(threads);
    return arena.execute([&] { return Find(scene, SearchedBy(SearchMethod::kShortlist), ConditionsWithSun()); });
  };
  const std::vector<Detection> alone = find(1);
  ASSERT_EQ(alone.size(), 1U);
  const std::vector<Detection> together = find(2);
  ASSERT_EQ(together.size(), 1U);
  EXPECT_EQ(together[0].view, alone[0].view);
  EXPECT_EQ(together[0].neg_log10_nfa, alone[0].neg_log10_nfa);
  EXPECT_EQ(together[0].outline, alone[0].outline);
}

TEST(SearchMethods, FindAModelOfEvenViewsAsOneOfAGrid) {
  const ObjectModel& even = ModelOfEvenViews();
  EXPECT_LT(even.views.size(), 0.6 * static_cast<double>(ModelOfManyViews().views.size()));
  EXPECT_NE(even.id, ModelOfManyViews().id);
  EXPECT_NE(even.options_json, ModelOfManyViews().options_json);
  const ViewSphere sphere =
      MakeViewSphere({.step_deg = 15, .max_off_nadir_deg = 60, .layout = ViewLayout::kEven}).value();
  ASSERT_EQ(even.views.size(), sphere.views.size());
  for (std::size_t i = 0; i < even.views.size(); ++i) {
    EXPECT_TRUE(std::ranges::equal(even.views[i].neighbours, sphere.views[i].neighbours)) << i;
  }
  for (const std::size_t number : {2, 5}) {
    const cv::Mat scene = SceneOfMethods(number);
    for (const FrameConditions& conditions : {FrameConditions{}, ConditionsWithSun()}) {
      for (const SearchMethod method : {SearchMethod::kVotes, SearchMethod::kShortlist}) {
        const std::vector<Detection> expected = Find(scene, SearchedBy(method), conditions);
        const std::vector<Detection> found = Find(scene, SearchedBy(method), conditions, even);
        ASSERT_EQ(expected.size(), 1U) << number;
        ASSERT_EQ(found.size(), 1U) << number;
        EXPECT_GT(IntersectionOverUnion(found[0].box, expected[0].box), 0.8) << number;
      }
    }
  }
}

}  // namespace
}  // namespace victorious
