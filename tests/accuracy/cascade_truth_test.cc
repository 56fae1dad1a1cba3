// Accuracy of the cascade on planar scenes with known homographies: true matches kept, and false matches kept.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "tests/accuracy/real_images.h"
#include "victorious/geometry/homography.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/preset.h"

namespace victorious::testing {
namespace {

enum class Verdict { kTrue, kFalse, kNeither };

Verdict Judge(const Keypoint& scene, const Keypoint& model, const Eigen::Matrix3d& scene_from_model) {
  const Eigen::Vector2d expected = ApplyHomography(scene_from_model, {model.x, model.y});
  const double error_px = std::hypot(scene.x - expected.x(), scene.y - expected.y());
  const double scale = static_cast<double>(scene.scale_px) / model.scale_px;
  if (error_px <= 3 * std::max(1.0, scale)) return Verdict::kTrue;
  return error_px > 10 ? Verdict::kFalse : Verdict::kNeither;
}

struct Counts {
  int true_before = 0;
  int true_left = 0;
  int false_left = 0;
  int left = 0;

  Counts& operator+=(const Counts& other) {
    true_before += other.true_before;
    true_left += other.true_left;
    false_left += other.false_left;
    left += other.left;
    return *this;
  }
  [[nodiscard]] double TrueKept() const { return static_cast<double>(true_left) / true_before; }
  [[nodiscard]] double FalseFraction() const { return left > 0 ? static_cast<double>(false_left) / left : 0; }
};

void Print(const std::string& name, const Counts& counts) {
  fmt::print("{:<24} true kept {:>5} of {:>5} ({:6.2f} %), false {:>3} of {:>5} left ({:5.2f} %)\n", name,
             counts.true_left, counts.true_before, 100 * counts.TrueKept(), counts.false_left, counts.left,
             100 * counts.FalseFraction());
}

// The first image of the series is the template, each of `numbers` a scene.
Counts CountPairs(const Series& series, const std::vector<int>& numbers, const RecognizeOptions& options = {}) {
  const Recognizer recognizer = MakeRecognizer({MakeModel(series.name(), series.ReadBgr(1))}, options);
  const std::span<const Keypoint> model = recognizer.models()[0].ViewFeatures(0).keypoints;
  Counts sum;
  for (const int number : numbers) {
    const FeatureSet scene = ExtractFeatures(GreyFromBgr(series.ReadBgr(number)));
    const Eigen::Matrix3d map = series.HomographyFromFirst(number);
    const auto count = [&](const MatchSet& matches, Verdict verdict) {
      return static_cast<int>(std::ranges::count_if(matches, [&](const Match& match) {
        return Judge(scene.keypoints[match.scene_keypoint], model[match.template_keypoint], map) == verdict;
      }));
    };
    const StagedMatches staged = recognizer.MatchView(scene, 0, 0);
    const MatchSet& left = staged.cascade.third;
    const Counts counts{.true_before = count(staged.ratio, Verdict::kTrue),
                        .true_left = count(left, Verdict::kTrue),
                        .false_left = count(left, Verdict::kFalse),
                        .left = static_cast<int>(left.size())};
    Print(fmt::format("{} 1 in {}", series.name(), number), counts);
    sum += counts;
  }
  return sum;
}

TEST(CascadeTruth, KeepsTrueAndRejectsFalseMatchesOnPlanarScenes) {
  VICTORIOUS_DATA_OR_SKIP(data, kRecognitionData);
  // The image pairs in which the object must be found.
  Counts easy = CountPairs(Series("graf"), {2, 3});
  easy += CountPairs(Series("boat"), {2, 3, 4});
  Print("these five", easy);
  EXPECT_GE(easy.TrueKept(), 0.98);
  EXPECT_LE(easy.FalseFraction(), 0.005);

  // Harder views of the same series, in which the matched part of the scene is planar.
  Counts flat = easy;
  flat += CountPairs(Series("graf"), {4, 5, 6});
  flat += CountPairs(Series("boat"), {5});
  flat += CountPairs(Series("wall"), {5});
  Print("these ten", flat);
  EXPECT_GE(flat.TrueKept(), 0.98);
  EXPECT_LE(flat.FalseFraction(), 0.005);

  // Two scenes are not planar: a pillar stands out of the wall, and boats and a bank are in front of the plane of
  // boat's homographies. Nearly all matches there are correct, although the homography makes them false.
  Counts all = flat;
  all += CountPairs(Series("boat"), {6});
  all += CountPairs(Series("wall"), {3});
  Print("all twelve", all);
  EXPECT_GE(all.TrueKept(), 0.98);
  EXPECT_LE(all.FalseFraction(), 0.01);
}

// Thresholds learnt from simulated images of vehicles generalise to unrelated photographs.
TEST(CascadeTruth, LearntThresholdsGeneralizeToPhotographs) {
  VICTORIOUS_DATA_OR_SKIP(data, kRecognitionData);
  RecognizeOptions learnt;
  ASSERT_TRUE(ApplyPreset(Preset::kLearnt, learnt));
  Counts all = CountPairs(Series("graf"), {2, 3, 4, 5, 6}, learnt);
  all += CountPairs(Series("boat"), {2, 3, 4, 5, 6}, learnt);
  all += CountPairs(Series("wall"), {3, 5}, learnt);
  Print("all twelve, learnt", all);
  EXPECT_GE(all.TrueKept(), 0.98);
  EXPECT_LE(all.FalseFraction(), 0.005);
}

}  // namespace
}  // namespace victorious::testing
