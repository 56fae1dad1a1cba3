#include "victorious/search/recognize/recognizer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/flat_view_source.h"
#include "testing/processor_device.h"
#include "testing/textured_scenes.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/object/features/feature_extractor.h"

namespace victorious {
namespace {

using testing::FeaturesOf;
using testing::kAround;
using testing::kOffNadir_rad;
using testing::ModelFromAround;
using testing::ModelOf;
using testing::Paste;
using testing::SunDependentTemplates;
using testing::Texture;

Recognizer MakeRecognizer(std::vector<ObjectModel> models) {
  return Recognizer::Create(std::move(models), FeatureOptions().engine, {}).value();
}

TEST(Recognizer, GrammarFindsEachInstance) {
  const cv::Mat crate = Texture(120, 90, 1);
  const cv::Mat sign = Texture(100, 100, 2);
  const cv::Mat absent = Texture(110, 100, 3);
  cv::Mat scene = Texture(640, 480, 4);
  const std::vector<Similarity2> truth = {Paste(crate, 1.0, 0.5, {150, 120}, scene),
                                          Paste(crate, 0.8, -2.0, {470, 130}, scene),
                                          Paste(sign, 1.2, 1.5, {300, 340}, scene)};
  const Recognizer recognizer =
      MakeRecognizer({ModelOf("crate", crate), ModelOf("sign", sign), ModelOf("absent", absent)});
  const std::vector<Detection> detections = recognizer.Recognize(FeaturesOf(scene)).value();
  ASSERT_EQ(detections.size(), 3U);
  std::size_t matched = 0;
  for (const Similarity2& fit : truth) {
    const std::size_t model = matched == 2 ? 1 : 0;
    const cv::Mat& image = model == 1 ? sign : crate;
    Polygon outline;
    for (const Eigen::Vector2d& corner :
         BoxCorners({0, 0, static_cast<double>(image.cols), static_cast<double>(image.rows)}))
      outline.push_back(fit.Apply(corner));
    for (const Detection& detection : detections) {
      if (detection.model_index == model && IntersectionOverUnion(detection.outline, outline) > 0.9) {
        ++matched;
        break;
      }
    }
  }
  EXPECT_EQ(matched, 3U);
}

RecognizeOptions RecognisedBy(SearchMethod method) {
  RecognizeOptions options;
  options.method = method;
  return options;
}

RecognizeOptions ByVotes() { return RecognisedBy(SearchMethod::kVotes); }

// The methods for CAD models: the vote search, which is the definition, and its approximation.
class VotesTest : public ::testing::TestWithParam<SearchMethod> {};

INSTANTIATE_TEST_SUITE_P(Methods, VotesTest, ::testing::Values(SearchMethod::kVotes, SearchMethod::kShortlist),
                         [](const auto& test) { return std::string(ToText(kSearchMethodTexts, test.param)); });

TEST_P(VotesTest, FindEachInstance) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  // More instances than the maximum number of seeds.
  const std::vector<Similarity2> truth = {
      Paste(crate, 1.0, 0.5, {110, 110}, scene), Paste(crate, 0.8, -2.0, {270, 100}, scene),
      Paste(crate, 0.9, 0.5, {430, 120}, scene), Paste(crate, 1.0, 3.0, {120, 340}, scene),
      Paste(crate, 0.9, 1.4, {310, 350}, scene), Paste(crate, 0.8, 0.5, {500, 330}, scene)};
  const Recognizer recognizer = Recognizer::Create({ModelOf("crate", crate), ModelOf("absent", Texture(110, 100, 3))},
                                                   FeatureOptions().engine, RecognisedBy(GetParam()))
                                    .value();
  const std::vector<Detection> detections = recognizer.Recognize(FeaturesOf(scene)).value();
  ASSERT_EQ(detections.size(), truth.size());
  for (const Similarity2& fit : truth) {
    const Eigen::Vector2d centre = fit.Apply({60, 45});
    EXPECT_TRUE(std::ranges::any_of(detections, [&](const Detection& found) {
      return found.model_index == 0 && (found.fit.scene_from_template.Apply({60, 45}) - centre).norm() < 3;
    }));
  }
}

TEST(Recognizer, SearchesOnlyGivenViews) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  const Eigen::Vector2d centre = Paste(crate, 1.0, 0.5, {150, 120}, scene).Apply({60, 45});
  const FeatureSet features = FeaturesOf(scene);
  const std::vector<std::size_t> views = {0};
  for (const RecognizeOptions& options : {ByVotes(), RecognisedBy(SearchMethod::kShortlist), RecognizeOptions()}) {
    const Recognizer recognizer = Recognizer::Create({ModelOf("absent", Texture(110, 100, 3)), ModelOf("crate", crate)},
                                                     FeatureOptions().engine, options)
                                      .value();
    const std::vector<Detection> found = recognizer.RecognizeViews(features, 1, views, {}).value();
    ASSERT_EQ(found.size(), 1U) << ToText(kSearchMethodTexts, options.method);
    EXPECT_EQ(found[0].model_index, 1U);
    EXPECT_LT((found[0].fit.scene_from_template.Apply({60, 45}) - centre).norm(), 3);
    EXPECT_TRUE(recognizer.RecognizeViews(features, 0, views, {}).value().empty());
    EXPECT_TRUE(recognizer.RecognizeViews(features, 1, {}, {}).value().empty());
  }
}

// The shortlist proposes a third of the coarse views; the others have none and leave out the last of three searches.
TEST(Recognizer, SearchesPartsOfTheViewsInTurn) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const auto found = [&](const RecognizeOptions& options) {
    const Recognizer recognizer =
        Recognizer::Create({ModelOf("crate", crate)}, FeatureOptions().engine, options).value();
    std::vector<std::size_t> counts;
    for (std::size_t part = 0; part < 3; ++part) {
      counts.push_back(recognizer.Recognize(features, {}, {}, {.index = part, .count = 3}).value().size());
    }
    return counts;
  };
  EXPECT_EQ(found(RecognisedBy(SearchMethod::kShortlist)), (std::vector<std::size_t>{1, 0, 0})) << "the only view";
  EXPECT_EQ(found(ByVotes()), (std::vector<std::size_t>{1, 1, 0}));
  EXPECT_EQ(found({}), (std::vector<std::size_t>{1, 1, 0}));
}

// A view without features is no coarse view and does not cover its neighbours.
TEST_P(VotesTest, ViewWithoutFeaturesIsNoCoarseView) {
  const cv::Mat crate = Texture(120, 90, 1);
  ObjectModel model = ModelOf("crate", crate);
  model.kind = ModelKind::kCad;
  ModelView plain = model.views[0];
  plain.feature_count = 0;
  plain.neighbours = {1};
  model.views[0].neighbours = {0};
  model.views.insert(model.views.begin(), plain);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const Recognizer recognizer = Recognizer::Create({model}, FeatureOptions().engine, RecognisedBy(GetParam())).value();
  EXPECT_EQ(recognizer.Recognize(FeaturesOf(scene)).value().size(), 1U);
}

// A ring of views, each a neighbour of the adjacent two; only one shows the object in the scene, and it is no coarse
// view.
TEST_P(VotesTest, ReachViewsBetweenCoarseViews) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat blurred;
  cv::GaussianBlur(crate, blurred, cv::Size(), 2.0);
  const auto storage = std::make_shared<FeatureSet>();
  ObjectModel model;
  model.name = "crate";
  model.engine = FeatureOptions().engine;
  model.kind = ModelKind::kCad;
  for (std::uint32_t view = 0; view < 4; ++view) {
    const FeatureSet features = FeaturesOf(view == 1 ? crate : blurred);
    model.views.push_back({.source = "crate",
                           .width = crate.cols,
                           .height = crate.rows,
                           .first_feature = storage->size(),
                           .feature_count = features.size(),
                           .outline = BoxCorners({0, 0, 120, 90}),
                           .angles = {},
                           .neighbours = {(view + 3) % 4, (view + 1) % 4}});
    storage->keypoints.insert(storage->keypoints.end(), features.keypoints.begin(), features.keypoints.end());
    storage->descriptors.insert(storage->descriptors.end(), features.descriptors.begin(), features.descriptors.end());
  }
  model.features = storage->View();
  model.storage = storage;
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const auto find = [&](SearchMethod method) {
    return Recognizer::Create({model}, FeatureOptions().engine, RecognisedBy(method))
        .value()
        .Recognize(FeaturesOf(scene))
        .value();
  };
  const std::vector<Detection> detections = find(GetParam());
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].view, 1U);
  EXPECT_EQ(detections[0].neg_log10_nfa, find(SearchMethod::kVotes)[0].neg_log10_nfa) << "verification is exact";
}

TEST_P(VotesTest, EstimateSunFromRelitTemplates) {
  constexpr std::size_t kView = 2;
  constexpr std::size_t kSunView = 3;
  cv::Mat scene = Texture(640, 480, 4);
  Paste(SunDependentTemplates::ImageOf(kSunView, kView), 1.0, 0, {320, 240}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const auto templates = std::make_shared<const SunDependentTemplates>();
  const Recognizer recognizer =
      Recognizer::Create({ModelFromAround()}, FeatureOptions().engine, RecognisedBy(GetParam()), {templates}).value();
  ASSERT_TRUE(recognizer.HasRelitTemplates());
  const Vertical vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480);

  const std::optional<SunEstimate> found_sun = recognizer.EstimateSun(features, vertical).value();
  ASSERT_TRUE(found_sun);
  EXPECT_EQ(templates->coarse().size(), kAround / 2) << "all coarse views are tried at half resolution";
  EXPECT_TRUE(templates->sharp().contains(kView));
  EXPECT_LT(templates->sharp().size(), kAround / 2) << "only the best of them at full resolution";
  EXPECT_GT(found_sun->gain_decades, 6) << "diffuse light explains nothing";
  const Sun sun = found_sun->relative_sun;
  // Seen from azimuth 60, lit from azimuth 90: the camera looks towards 240, so the sun's relative azimuth is -150.
  EXPECT_NEAR(WrapAngle(sun.azimuth_rad + 5 * kPi / 6), 0, 0.2);

  EXPECT_TRUE(recognizer.Recognize(features, {.vertical = vertical, .relative_sun = {}}).value().empty());
  const std::vector<Detection> found =
      recognizer.Recognize(features, {.vertical = vertical, .relative_sun = sun}).value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].view, kView);
  EXPECT_FALSE(recognizer.EstimateSun(FeaturesOf(Texture(640, 480, 5)), vertical).value());
}

// In a wide field of view the azimuth of the line of sight, and with it the relative sun, varies.
TEST_P(VotesTest, SunIsRelativeToTheLineOfSight) {
  constexpr std::size_t kView = 2;
  constexpr std::size_t kSunView = 3;
  const Eigen::Vector2d at(560, 240);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(SunDependentTemplates::ImageOf(kSunView, kView), 1.0, 0, at, scene);
  const FeatureSet features = FeaturesOf(scene);
  RecognizeOptions options = RecognisedBy(GetParam());
  options.search.max_tilt_rad = 0.6;  // the scene does not model the lean of the object there
  options.search.sun_step_rad = 0.1;  // much finer than the suns of this test
  const Recognizer recognizer = Recognizer::Create({ModelFromAround()}, FeatureOptions().engine, options,
                                                   {std::make_shared<const SunDependentTemplates>()})
                                    .value();
  const Vertical vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 1.1, 640, 480);
  const double relative_azimuth_rad = vertical.AzimuthAt(at);
  ASSERT_GT(relative_azimuth_rad, 0.5);

  const std::optional<SunEstimate> found_sun = recognizer.EstimateSun(features, vertical).value();
  ASSERT_TRUE(found_sun);
  EXPECT_NEAR(WrapAngle(found_sun->relative_sun.azimuth_rad - relative_azimuth_rad + 5 * kPi / 6), 0, 0.2);
  const std::vector<Detection> found =
      recognizer.Recognize(features, {.vertical = vertical, .relative_sun = found_sun->relative_sun}).value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].view, kView);
}

// Every other view is a coarse view, relit at half resolution; only the refined views, and the coarse view that they
// extend, are relit at full resolution.
TEST(Recognizer, RelitCoarseViewsHaveHalfResolution) {
  constexpr std::size_t kView = 2;
  cv::Mat scene = Texture(640, 480, 4);
  const Vertical vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480);
  const Sun sun{.azimuth_rad = -5 * kPi / 6, .elevation_rad = kPi / 4};
  Paste(SunDependentTemplates::ImageOf(3, kView), 1.0, 0, {320, 240}, scene);
  const auto templates = std::make_shared<const SunDependentTemplates>();
  RecognizeOptions options;
  options.search.max_refined_views = 1;
  const Recognizer recognizer =
      Recognizer::Create({ModelFromAround()}, FeatureOptions().engine, options, {templates}).value();
  const std::vector<Detection> found =
      recognizer.Recognize(FeaturesOf(scene), {.vertical = vertical, .relative_sun = sun}).value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].view, kView);
  EXPECT_EQ(templates->coarse().size(), kAround / 2);
  EXPECT_TRUE(templates->coarse().contains(kView));
  EXPECT_EQ(templates->sharp(), (std::set<std::size_t>{kView, kView + 1}));
}

// A model that the scene does not show is not searched at full resolution.
TEST(Recognizer, ShortlistRefinesProposalsOnly) {
  const Vertical vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480);
  const Sun sun{.azimuth_rad = -5 * kPi / 6, .elevation_rad = kPi / 4};
  const auto templates = std::make_shared<const SunDependentTemplates>();
  RecognizeOptions options = RecognisedBy(SearchMethod::kShortlist);
  options.shortlist.min_refined_neg_log10_nfa = 4;
  const Recognizer recognizer =
      Recognizer::Create({ModelFromAround()}, FeatureOptions().engine, options, {templates}).value();
  const FrameConditions conditions{.vertical = vertical, .relative_sun = sun};
  EXPECT_TRUE(recognizer.Recognize(FeaturesOf(Texture(640, 480, 4)), conditions).value().empty());
  EXPECT_EQ(templates->coarse().size(), kAround / 2);
  EXPECT_TRUE(templates->sharp().empty());
}

TEST(Recognizer, PartsOfTheViewsAreAllOfThem) {
  const auto templates = std::make_shared<const SunDependentTemplates>();
  const Recognizer recognizer = Recognizer::Create({ModelFromAround()}, FeatureOptions().engine,
                                                   RecognisedBy(SearchMethod::kShortlist), {templates})
                                    .value();
  const FrameConditions conditions{.vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480),
                                   .relative_sun = Sun{.azimuth_rad = -5 * kPi / 6, .elevation_rad = kPi / 4}};
  const FeatureSet features = FeaturesOf(Texture(640, 480, 4));
  std::size_t before = 0;
  for (std::size_t part = 0; part < 3; ++part) {
    ASSERT_TRUE(recognizer.Recognize(features, conditions, {}, {.index = part, .count = 3}));
    EXPECT_GT(templates->coarse().size(), before);
    before = templates->coarse().size();
  }
  EXPECT_EQ(before, kAround / 2) << "every coarse view";
}

// By `auto` a CAD model of many views is searched by the shortlist, one of few by all of its votes.
TEST(Recognizer, AutoIsTheShortlistForManyViews) {
  ObjectModel few = ModelFromAround();
  ObjectModel many = few;
  ModelView plain = many.views[0];  // a view without features is never matched
  plain.feature_count = 0;
  plain.neighbours.clear();
  many.views.resize(60, plain);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(SunDependentTemplates::ImageOf(3, 2), 1.0, 0, {320, 240}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const auto templates = std::make_shared<const SunDependentTemplates>();
  const FrameConditions conditions{.vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480),
                                   .relative_sun = Sun{.azimuth_rad = -5 * kPi / 6, .elevation_rad = kPi / 4}};
  const auto is_found = [&](const ObjectModel& model, const RecognizeOptions& options) {
    const Recognizer recognizer = Recognizer::Create({model}, FeatureOptions().engine, options, {templates}).value();
    return !recognizer.Recognize(features, conditions).value().empty();
  };
  RecognizeOptions options;
  EXPECT_TRUE(is_found(few, options));
  EXPECT_TRUE(is_found(many, options));
  options.shortlist.max_verified = 0;  // the shortlist finds nothing
  EXPECT_TRUE(is_found(few, options));
  EXPECT_FALSE(is_found(many, options));
  options.shortlist = {.min_verified_neg_log10_nfa = 1000};  // no proposal is worth verification
  EXPECT_FALSE(is_found(many, options));
}

// The surface samples of a flat object.
std::shared_ptr<const RelitTemplateSource> SurfaceSamplesOf(const cv::Mat& grey) {
  cv::Mat blurred;
  cv::GaussianBlur(grey, blurred, {}, kAppearanceBlur_px);
  return std::make_shared<const testing::FlatViewSource>(blurred, 3, 6);
}

TEST(Recognizer, NccScoreDecidesUncertainDetections) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {300, 220}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const auto neg_log10_nfa = [&](const RecognizeOptions& options, const cv::Mat& grey) -> std::optional<double> {
    const Recognizer recognizer =
        Recognizer::Create({ModelOf("crate", crate)}, FeatureOptions().engine, options, {SurfaceSamplesOf(crate)})
            .value();
    const std::vector<Detection> found = recognizer.Recognize(features, {}, grey).value();
    if (found.empty()) return std::nullopt;
    EXPECT_DOUBLE_EQ(found[0].score, ComputeScore(found[0].neg_log10_nfa));
    return found[0].neg_log10_nfa;
  };
  RecognizeOptions options = ByVotes();
  const double votes = neg_log10_nfa(options, {}).value();
  EXPECT_EQ(neg_log10_nfa(options, scene), votes);  // certain: not rescored
  options.ncc.max_neg_log10_nfa = 1000;
  EXPECT_GT(neg_log10_nfa(options, scene).value(), votes + 4);
  EXPECT_LT(neg_log10_nfa(options, 255 - scene).value_or(0), votes - 4);
  options.ncc.neutral_z_score = 100;
  options.ncc.decades_per_z_score = 100;
  EXPECT_EQ(neg_log10_nfa(options, scene), std::nullopt);
  RecognizeOptions none = options;
  none.ncc.max_poses = 0;
  EXPECT_EQ(neg_log10_nfa(none, scene), votes);
  none = options;
  none.ncc.max_poses_per_frame = 0;
  EXPECT_EQ(neg_log10_nfa(none, scene), votes);
}

TEST_P(VotesTest, FindNothingInUnrelatedScenes) {
  const Recognizer recognizer =
      Recognizer::Create({ModelOf("crate", Texture(120, 90, 1))}, FeatureOptions().engine, RecognisedBy(GetParam()))
          .value();
  for (std::uint64_t seed = 10; seed < 16; ++seed)
    EXPECT_TRUE(recognizer.Recognize(FeaturesOf(Texture(640, 480, seed))).value().empty()) << seed;
  EXPECT_TRUE(recognizer.Recognize(FeatureSet()).value().empty());
}

TEST(Recognizer, GrammarFindsNothingInUnrelatedScenes) {
  const Recognizer recognizer = MakeRecognizer({ModelOf("crate", Texture(120, 90, 1))});
  for (std::uint64_t seed = 10; seed < 16; ++seed)
    EXPECT_TRUE(recognizer.Recognize(FeaturesOf(Texture(640, 480, seed))).value().empty()) << seed;
  EXPECT_TRUE(recognizer.Recognize(FeatureSet()).value().empty());
}

TEST(Recognizer, EachStageKeepsASubset) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 5);
  const Similarity2 truth = Paste(crate, 0.9, 1.0, {320, 240}, scene);
  const Recognizer recognizer = MakeRecognizer({ModelOf("crate", crate)});
  const StagedMatches staged = recognizer.MatchView(FeaturesOf(scene), 0, 0);
  EXPECT_GE(staged.ratio.size(), staged.cascade.first.size());
  EXPECT_GE(staged.cascade.first.size(), staged.cascade.second.size());
  EXPECT_GE(staged.cascade.second.size(), staged.cascade.third.size());
  ASSERT_EQ(staged.fits.size(), 1U);
  EXPECT_GE(staged.cascade.third.size(), staged.fits[0].inliers.size());
  EXPECT_NEAR(staged.fits[0].scene_from_template.scale, truth.scale, 0.01);
  EXPECT_NEAR(staged.fits[0].scene_from_template.rotation_rad, truth.rotation_rad, 0.01);
}

TEST(Recognizer, RefusesModelsOfAnotherEngine) {
  const auto result = Recognizer::Create({ModelOf("crate", Texture(120, 90, 1))}, "fast", {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(result.error().message.find("crate"), std::string::npos);
}

// What each parameter changes.

// The device computes the same distances; one that fails is done without.
TEST(RecognizeDevice, FindsTheSameAsTheProcessor) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const FeatureSet features = FeaturesOf(scene);
  for (const SearchMethod method : {SearchMethod::kVotes, SearchMethod::kShortlist}) {
    const auto nfas = [&](const std::shared_ptr<kernels::NearestDevice>& device) {
      const Recognizer recognizer =
          Recognizer::Create({ModelOf("crate", crate)}, FeatureOptions().engine, RecognisedBy(method), {}, device)
              .value();
      std::vector<double> all;
      const std::vector<Detection> detections = recognizer.Recognize(features).value();
      for (const Detection& detection : detections) all.push_back(detection.neg_log10_nfa);
      return all;
    };
    const auto device = std::make_shared<testing::ProcessorDevice>();
    const std::vector<double> expected = nfas(nullptr);
    EXPECT_EQ(expected.size(), 1U);
    EXPECT_EQ(nfas(device), expected);
    EXPECT_GT(device->query_count(), 0U);
    EXPECT_EQ(nfas(std::make_shared<testing::ProcessorDevice>(testing::ProcessorDevice::Failing::kQueries)), expected);
  }
}

// Only the vote search sets a fit's own -log10 NFA.
TEST(RecognizeParameter, MethodAutoIsVotesForCadModelsOfFewViewsAndTheGrammarForPhotos) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {150, 120}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const auto is_found_by_votes = [&](ModelKind kind, SearchMethod method) {
    ObjectModel model = ModelOf("crate", crate);
    model.kind = kind;
    RecognizeOptions options;
    options.method = method;
    const Recognizer recognizer = Recognizer::Create({model}, FeatureOptions().engine, options).value();
    return recognizer.Recognize(features).value().at(0).fit.neg_log10_nfa.has_value();
  };
  EXPECT_FALSE(is_found_by_votes(ModelKind::kPhotos, SearchMethod::kAuto));
  EXPECT_TRUE(is_found_by_votes(ModelKind::kCad, SearchMethod::kAuto));
  EXPECT_TRUE(is_found_by_votes(ModelKind::kPhotos, SearchMethod::kVotes));
  EXPECT_TRUE(is_found_by_votes(ModelKind::kPhotos, SearchMethod::kShortlist));
  EXPECT_FALSE(is_found_by_votes(ModelKind::kCad, SearchMethod::kGrammar));
}

// Two instances: with one ranked match, a template keypoint is an inlier of one of them only.
TEST(RecognizeParameter, NearestIsTheNumberOfRankedMatchesOfATemplateKeypoint) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0, {150, 120}, scene);
  Paste(crate, 1.0, 0, {450, 330}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const ObjectModel model = ModelOf("crate", crate);
  const auto count_inliers = [&](int nearest) {
    RecognizeOptions options = ByVotes();
    options.search.nearest = nearest;
    const Recognizer recognizer = Recognizer::Create({model}, FeatureOptions().engine, options).value();
    std::size_t inliers = 0;
    const std::vector<Detection> detections = recognizer.Recognize(features).value();
    for (const Detection& found : detections) inliers += found.fit.inliers.size();
    return inliers;
  };
  EXPECT_LE(count_inliers(1), model.features.size());
  EXPECT_GT(count_inliers(4), model.features.size());
}

// The number of detections of an object that is seen from 60 degrees off nadir, turned in the image.
std::size_t CountTurned(double turn_rad, const FrameConditions& conditions, const RecognizeOptions& options) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, turn_rad, {320, 240}, scene);
  ObjectModel model = ModelOf("crate", crate);
  model.kind = ModelKind::kCad;
  model.views[0].angles = ViewDirection{0, kPi / 3};
  return Recognizer::Create({model}, FeatureOptions().engine, options)
      .value()
      .Recognize(FeaturesOf(scene), conditions)
      .value()
      .size();
}

class UprightParameter : public ::testing::TestWithParam<SearchMethod> {};

INSTANTIATE_TEST_SUITE_P(Methods, UprightParameter, ::testing::Values(SearchMethod::kVotes, SearchMethod::kShortlist),
                         [](const auto& test) { return std::string(ToText(kSearchMethodTexts, test.param)); });

TEST_P(UprightParameter, MaxTiltIsThatOfTheObjectsUpAxisWhereTheAttitudeIsKnown) {
  const FrameConditions known{.vertical = MakeVertical({0, kPi / 3 - kPi / 2, 0}, 0.3, 640, 480), .relative_sun = {}};
  RecognizeOptions options = RecognisedBy(GetParam());
  EXPECT_EQ(CountTurned(0, known, options), 1U);
  EXPECT_EQ(CountTurned(0.8, known, options), 0U);  // a tilt of 2 asin(sin(60 degrees) sin(0.4)) = 0.69
  options.search.max_tilt_rad = 0.75;
  EXPECT_EQ(CountTurned(0.8, known, options), 1U);
  EXPECT_EQ(CountTurned(0.8, {}, RecognisedBy(GetParam())), 1U) << "with unknown attitude the camera may be tilted";
}

TEST_P(UprightParameter, MaxHangingIsTheAngleBelowTheHorizontalWhereTheAttitudeIsUnknown) {
  RecognizeOptions options = RecognisedBy(GetParam());
  EXPECT_EQ(CountTurned(kPi, {}, options), 0U) << "upside down";
  options.search.max_hanging_rad = kPi / 2;
  EXPECT_EQ(CountTurned(kPi, {}, options), 1U);
}

}  // namespace
}  // namespace victorious
