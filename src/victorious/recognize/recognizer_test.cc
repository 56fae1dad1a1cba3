#include "victorious/recognize/recognizer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// A random image full of corners, different for each seed.
cv::Mat Texture(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(random.Below(256)));
  for (int i = 0; i < width * height / 250; ++i) {
    const cv::Rect patch(static_cast<int>(random.Below(static_cast<std::uint32_t>(width))),
                         static_cast<int>(random.Below(static_cast<std::uint32_t>(height))),
                         3 + static_cast<int>(random.Below(22)), 3 + static_cast<int>(random.Below(22)));
    cv::rectangle(image, patch, cv::Scalar(random.Below(256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(), 1.0);
  return image;
}

FeatureSet FeaturesOf(const cv::Mat& image) { return MakeFeatureExtractor({}).value()->Extract(image).value(); }

ObjectModel ModelOf(const std::string& name, const cv::Mat& image) {
  const auto storage = std::make_shared<FeatureSet>(FeaturesOf(image));
  ObjectModel model;
  model.name = name;
  model.engine = "opencv";
  model.features = storage->View();
  model.storage = storage;
  model.views.push_back(
      {.source = name,
       .width = image.cols,
       .height = image.rows,
       .first_feature = 0,
       .feature_count = storage->size(),
       .outline = BoxCorners({0, 0, static_cast<double>(image.cols), static_cast<double>(image.rows)}),
       .angles = {}});
  return model;
}

// Pastes `object` into `scene` by a similarity.
Similarity2 Paste(const cv::Mat& object, double scale, double rotation_rad, const Eigen::Vector2d& centre,
                  cv::Mat& scene) {
  Similarity2 fit{scale, rotation_rad, Eigen::Vector2d::Zero()};
  fit.translation = centre - fit.Linear() * Eigen::Vector2d(object.cols / 2.0, object.rows / 2.0);
  const Eigen::Matrix2d a = fit.Linear();
  // cv::warpAffine puts pixel centres at integers.
  const Eigen::Vector2d t = fit.translation + a * Eigen::Vector2d(0.5, 0.5) - Eigen::Vector2d(0.5, 0.5);
  const cv::Matx23d matrix(a(0, 0), a(0, 1), t.x(), a(1, 0), a(1, 1), t.y());
  cv::Mat warped;
  cv::Mat mask;
  cv::warpAffine(object, warped, matrix, scene.size(), cv::INTER_AREA);
  cv::warpAffine(cv::Mat(object.size(), CV_8UC1, cv::Scalar(255)), mask, matrix, scene.size(), cv::INTER_NEAREST);
  warped.copyTo(scene, mask);
  return fit;
}

Recognizer MakeRecognizer(std::vector<ObjectModel> models) {
  return Recognizer::Create(std::move(models), "opencv", {}).value();
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

RecognizeOptions ByVotes() {
  RecognizeOptions options;
  options.method = SearchMethod::kVotes;
  return options;
}

TEST(Recognizer, VotesFindEachInstance) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  // More instances than the maximum number of seeds.
  const std::vector<Similarity2> truth = {
      Paste(crate, 1.0, 0.5, {110, 110}, scene), Paste(crate, 0.8, -2.0, {270, 100}, scene),
      Paste(crate, 0.9, 0.5, {430, 120}, scene), Paste(crate, 1.0, 3.0, {120, 340}, scene),
      Paste(crate, 0.9, 1.4, {310, 350}, scene), Paste(crate, 0.8, 0.5, {500, 330}, scene)};
  const Recognizer recognizer =
      Recognizer::Create({ModelOf("crate", crate), ModelOf("absent", Texture(110, 100, 3))}, "opencv", ByVotes())
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
  for (const RecognizeOptions& options : {ByVotes(), RecognizeOptions()}) {
    const Recognizer recognizer =
        Recognizer::Create({ModelOf("absent", Texture(110, 100, 3)), ModelOf("crate", crate)}, "opencv", options)
            .value();
    const std::vector<Detection> found = recognizer.RecognizeViews(features, 1, views, {}).value();
    ASSERT_EQ(found.size(), 1U) << ToText(kSearchMethodTexts, options.method);
    EXPECT_EQ(found[0].model_index, 1U);
    EXPECT_LT((found[0].fit.scene_from_template.Apply({60, 45}) - centre).norm(), 3);
    EXPECT_TRUE(recognizer.RecognizeViews(features, 0, views, {}).value().empty());
    EXPECT_TRUE(recognizer.RecognizeViews(features, 1, {}, {}).value().empty());
  }
}

// A view without features is no coarse view and does not cover its neighbours.
TEST(Recognizer, ViewWithoutFeaturesIsNoCoarseView) {
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
  EXPECT_EQ(MakeRecognizer({model}).Recognize(FeaturesOf(scene)).value().size(), 1U);
}

// A ring of views, each a neighbour of the adjacent two; only one shows the object in the scene, and it is no coarse
// view.
TEST(Recognizer, VotesReachViewsBetweenCoarseViews) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat blurred;
  cv::GaussianBlur(crate, blurred, cv::Size(), 2.0);
  const auto storage = std::make_shared<FeatureSet>();
  ObjectModel model;
  model.name = "crate";
  model.engine = "opencv";
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
  const std::vector<Detection> detections = MakeRecognizer({model}).Recognize(FeaturesOf(scene)).value();
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].view, 1U);
}

// A model with views from twelve azimuths at 40 degrees off nadir. In diffuse light it has another texture;
// each sun above one of the azimuths gives it its own texture.
constexpr double kOffNadir_rad = 40 * kPi / 180;
constexpr std::size_t kAround = 12;

ObjectModel PlainFromAround() {
  ObjectModel model = ModelOf("crate", Texture(120, 90, 99));
  model.kind = ModelKind::kCad;
  const ModelView view = model.views[0];
  model.views.clear();
  for (std::size_t i = 0; i < kAround; ++i) {
    model.views.push_back(view);
    model.views.back().angles = ViewAngles{2 * kPi * static_cast<double>(i) / kAround, kOffNadir_rad};
    model.views.back().neighbours = {static_cast<std::uint32_t>((i + 1) % kAround)};
  }
  return model;
}

class Painted : public RelitTemplateSource {
 public:
  Painted() {
    for (std::size_t i = 0; i < kAround * kAround; ++i) {
      auto relit = std::make_shared<RelitTemplate>();
      relit->features = FeaturesOf(PaintOf(i / kAround, i % kAround));
      relit_templates_.push_back(std::move(relit));
    }
  }
  static cv::Mat PaintOf(std::size_t sun_view, std::size_t view) {
    return Texture(120, 90, 1000 + kAround * sun_view + view);
  }

  [[nodiscard]] Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(
      const RelitTemplateKey& wanted) const override {
    (wanted.half_resolution ? coarse_ : sharp_).insert(wanted.view);
    return relit_templates_[kAround * wanted.sun_view + wanted.view];
  }
  void Prepare(std::span<const RelitTemplateKey> /*wanted*/) const override {}
  [[nodiscard]] Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t /*view*/,
                                                                              int /*half_octaves*/) const override {
    return std::make_shared<const ViewAppearance>();
  }

  // The views queried under a sun, at half and at full resolution.
  [[nodiscard]] const std::set<std::size_t>& coarse() const { return coarse_; }
  [[nodiscard]] const std::set<std::size_t>& sharp() const { return sharp_; }

 private:
  std::vector<std::shared_ptr<const RelitTemplate>> relit_templates_;
  mutable std::set<std::size_t> coarse_;
  mutable std::set<std::size_t> sharp_;
};

TEST(Recognizer, EstimatesSunFromRelitTemplates) {
  constexpr std::size_t kView = 2;
  constexpr std::size_t kSunView = 3;
  cv::Mat scene = Texture(640, 480, 4);
  Paste(Painted::PaintOf(kSunView, kView), 1.0, 0, {320, 240}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const Recognizer recognizer =
      Recognizer::Create({PlainFromAround()}, "opencv", {}, {std::make_shared<const Painted>()}).value();
  ASSERT_TRUE(recognizer.HasRelitTemplates());
  const Vertical vertical = MakeVertical({0, kOffNadir_rad - kPi / 2, 0}, 0.3, 640, 480);

  const std::optional<SunEstimate> found_sun = recognizer.EstimateSun(features, vertical).value();
  ASSERT_TRUE(found_sun);
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
TEST(Recognizer, SunIsRelativeToTheLineOfSight) {
  constexpr std::size_t kView = 2;
  constexpr std::size_t kSunView = 3;
  const Eigen::Vector2d at(560, 240);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(Painted::PaintOf(kSunView, kView), 1.0, 0, at, scene);
  const FeatureSet features = FeaturesOf(scene);
  RecognizeOptions options;
  options.search.max_tilt_rad = 0.6;  // the scene does not model the lean of the object there
  options.search.sun_step_rad = 0.1;  // much finer than the suns of this test
  const Recognizer recognizer =
      Recognizer::Create({PlainFromAround()}, "opencv", options, {std::make_shared<const Painted>()}).value();
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
  Paste(Painted::PaintOf(3, kView), 1.0, 0, {320, 240}, scene);
  const auto painted = std::make_shared<const Painted>();
  RecognizeOptions options;
  options.search.max_refined_views = 1;
  const Recognizer recognizer = Recognizer::Create({PlainFromAround()}, "opencv", options, {painted}).value();
  const std::vector<Detection> found =
      recognizer.Recognize(FeaturesOf(scene), {.vertical = vertical, .relative_sun = sun}).value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].view, kView);
  EXPECT_EQ(painted->coarse().size(), kAround / 2);
  EXPECT_TRUE(painted->coarse().contains(kView));
  EXPECT_EQ(painted->sharp(), (std::set<std::size_t>{kView, kView + 1}));
}

// A crate with surface samples.
class SquareAppearanceSource : public RelitTemplateSource {
 public:
  explicit SquareAppearanceSource(const cv::Mat& grey) {
    cv::Mat blurred;
    cv::GaussianBlur(grey, blurred, {}, kAppearanceBlur_px);
    auto image = std::make_shared<ViewAppearance>();
    image->centre_px = {grey.cols / 2.0, grey.rows / 2.0};
    for (int row = 3; row < grey.rows; row += 6) {
      for (int column = 3; column < grey.cols; column += 6) {
        const Eigen::Vector2d at = Eigen::Vector2d(column + 0.5, row + 0.5) - image->centre_px;
        image->points.push_back({Eigen::Vector3d(at.x(), at.y(), 0).cast<float>(),
                                 static_cast<float>(blurred.at<std::uint8_t>(row, column))});
      }
    }
    image_ = std::move(image);
  }
  [[nodiscard]] Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(
      const RelitTemplateKey& /*wanted*/) const override {
    return std::make_shared<const RelitTemplate>();
  }
  void Prepare(std::span<const RelitTemplateKey> /*wanted*/) const override {}
  [[nodiscard]] Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t /*view*/,
                                                                              int /*half_octaves*/) const override {
    return image_;
  }

 private:
  std::shared_ptr<const ViewAppearance> image_;
};

TEST(Recognizer, NccScoreDecidesUncertainDetections) {
  const cv::Mat crate = Texture(120, 90, 1);
  cv::Mat scene = Texture(640, 480, 4);
  Paste(crate, 1.0, 0.5, {300, 220}, scene);
  const FeatureSet features = FeaturesOf(scene);
  const auto neg_log10_nfa = [&](const RecognizeOptions& options, const cv::Mat& grey) -> std::optional<double> {
    const Recognizer recognizer = Recognizer::Create({ModelOf("crate", crate)}, "opencv", options,
                                                     {std::make_shared<const SquareAppearanceSource>(crate)})
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
  options.ncc.min_neg_log10_nfa = 1001;
  EXPECT_EQ(Recognizer::Create({}, "opencv", options).error().code, ErrorCode::kInvalidArgument);
}

TEST(Recognizer, VotesFindNothingInUnrelatedScenes) {
  const Recognizer recognizer =
      Recognizer::Create({ModelOf("crate", Texture(120, 90, 1))}, "opencv", ByVotes()).value();
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

}  // namespace
}  // namespace victorious
