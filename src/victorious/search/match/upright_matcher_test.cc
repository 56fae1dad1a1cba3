#include "victorious/search/match/upright_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

float RandomAngle(Random& random) { return static_cast<float>(2 * kPi * random.Uniform() - kPi); }

// The descriptors lie on few levels, so that many scene keypoints are nearly equally near, and none too far.
FeatureSet RandomUprightFeatures(Random& random, std::size_t count) {
  FeatureSet features;
  for (std::size_t i = 0; i < count; ++i) features.keypoints.push_back({1, 1, 2, RandomAngle(random)});
  features.descriptors.resize(count * kDescriptorSize);
  for (std::uint8_t& byte : features.descriptors) byte = static_cast<std::uint8_t>(random.Below(70));
  return features;
}

// A template and its shortened descriptors.
struct ShortenedFeatures {
  explicit ShortenedFeatures(const FeatureView& view)
      : features(view), shortened(ShortenDescriptors(view.descriptors)) {}
  [[nodiscard]] UprightTemplate View() const { return {features, &shortened}; }

  FeatureView features;
  ShortDescriptors shortened;
};

bool IsAllowed(const Keypoint& scene, float lean_rad, const Keypoint& model, double max_turn_rad) {
  return std::abs(WrapAngle(WrapAngle(scene.orientation_rad - lean_rad) - model.orientation_rad)) <= max_turn_rad;
}

// Every scene keypoint has its copy in a template: whatever the orientations and the numbers, the copy is found exactly
// if its turn is allowed, also across pi and for intervals of nearly the whole circle.
TEST(UprightMatcher, FindsAllAllowedCopiesAndNoOthers) {
  Random random(1);
  for (const std::size_t count : {1, 15, 16, 17, 33, 200}) {
    const FeatureSet scene = RandomUprightFeatures(random, count);
    std::vector<float> lean_rad;
    for (std::size_t i = 0; i < count; ++i) lean_rad.push_back(0.3F * RandomAngle(random));
    FeatureSet copies = scene;
    for (Keypoint& keypoint : copies.keypoints) keypoint.orientation_rad = RandomAngle(random);
    const ShortenedFeatures first(copies.View().Slice(0, count / 2));
    const ShortenedFeatures second(copies.View().Slice(count / 2, count - count / 2));
    const UprightTemplate halves[] = {first.View(), second.View()};
    const UprightMatcher matcher(scene.View(), lean_rad);
    for (const double max_turn_rad : {0.0, 0.4, 1.5, 3.0, 3.1, kPi}) {
      const std::vector<std::vector<RankedMatch>> matches = matcher.Match(halves, max_turn_rad, 1);
      ASSERT_EQ(matches.size(), 2U);
      for (std::size_t i = 0; i < count; ++i) {
        const bool in_second = i >= count / 2;
        const auto number = static_cast<std::uint32_t>(in_second ? i - count / 2 : i);
        const std::vector<RankedMatch>& of_template = matches[in_second ? 1 : 0];
        const auto match = std::ranges::find(of_template, number, &RankedMatch::template_keypoint);
        const bool finds_copy = match != of_template.end() && match->scene_keypoint == i;
        EXPECT_EQ(finds_copy, IsAllowed(scene.keypoints[i], lean_rad[i], copies.keypoints[i], max_turn_rad))
            << i << " of " << count << ", turn " << max_turn_rad;
        if (match != of_template.end()) {
          EXPECT_TRUE(IsAllowed(scene.keypoints[match->scene_keypoint], lean_rad[match->scene_keypoint],
                                copies.keypoints[i], max_turn_rad));
        }
      }
    }
  }
}

TEST(UprightMatcher, RanksByWholeDescriptors) {
  Random random(2);
  FeatureSet scene = RandomUprightFeatures(random, 100);
  for (Keypoint& keypoint : scene.keypoints) keypoint.orientation_rad = 0.1F;
  FeatureSet model = RandomUprightFeatures(random, 1);
  model.keypoints[0].orientation_rad = 0;
  // Two copies, one of them changed a little.
  for (const std::size_t i : {std::size_t{20}, std::size_t{40}}) {
    std::ranges::copy(model.descriptors, scene.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorSize));
  }
  scene.descriptors[20 * kDescriptorSize] ^= 3;
  const std::vector<float> lean_rad(scene.size(), 0.0F);
  const ShortenedFeatures shortened(model.View());
  const UprightTemplate view = shortened.View();
  const std::vector<RankedMatch> matches = UprightMatcher(scene.View(), lean_rad).Match({&view, 1}, 0.5, 2).front();
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0], (RankedMatch{40, 0, 1}));
  EXPECT_EQ(matches[1], (RankedMatch{20, 0, 2}));
}

// Descriptors of the norm 512 at an angle of 42 degrees are just near enough.
TEST(UprightMatcher, DropsDissimilarDescriptors) {
  for (const auto& [turned, count] : {std::pair{339, 1U}, {347, 0U}}) {
    FeatureSet scene;
    scene.keypoints.push_back({1, 1, 2, 0});
    scene.descriptors.resize(kDescriptorSize);
    FeatureSet model = scene;
    // 16 values of 128, and the same turned towards 16 others.
    for (std::size_t i = 0; i < 16; ++i) {
      model.descriptors[i] = 128;
      scene.descriptors[i] = static_cast<std::uint8_t>(std::lround(std::sqrt(512.0 * 512 - turned * turned) / 4));
      scene.descriptors[16 + i] = static_cast<std::uint8_t>(std::lround(turned / 4.0));
    }
    const ShortenedFeatures shortened(model.View());
    const UprightTemplate view = shortened.View();
    const std::vector<float> lean_rad(1, 0.0F);
    EXPECT_EQ(UprightMatcher(scene.View(), lean_rad).Match({&view, 1}, 1, 1).front().size(), count) << turned;
  }
}

// A list is limited; in a large scene the nearest are kept, whatever their orientation.
TEST(UprightMatcher, LargeScenesHaveMatchesOfEveryOrientation) {
  Random random(4);
  const FeatureSet scene = RandomUprightFeatures(random, 40'000);
  FeatureSet model = RandomUprightFeatures(random, 64);
  for (std::size_t i = 0; i < model.size(); ++i) {
    model.keypoints[i].orientation_rad = static_cast<float>(kPi * (static_cast<double>(i) + 0.5) / 32 - kPi);
  }
  const ShortenedFeatures shortened(model.View());
  const UprightTemplate view = shortened.View();
  const std::vector<float> lean_rad(scene.size(), 0.0F);
  const std::vector<RankedMatch> matches = UprightMatcher(scene.View(), lean_rad).Match({&view, 1}, 0.3, 1).front();
  EXPECT_EQ(matches.size(), model.size());
}

// Descriptors as of real keypoints: few large values, a norm of 512.
FeatureSet RealisticFeatures(Random& random, std::size_t count) {
  FeatureSet features;
  for (std::size_t i = 0; i < count; ++i) {
    features.keypoints.push_back({1, 1, 2, RandomAngle(random)});
    std::array<double, kDescriptorSize> values{};
    double sum = 0;
    for (double& value : values) {
      value = std::pow(std::abs(random.Normal()), 1.5);
      sum += value * value;
    }
    for (const double value : values)
      features.descriptors.push_back(
          static_cast<std::uint8_t>(std::lround(std::min(255.0, 512 * value / std::sqrt(sum)))));
  }
  return features;
}

// A cell's list holds a part of a large scene: nearly all keypoints that are as near to theirs as true matches are.
TEST(UprightMatcher, ListsHoldNearlyAllTrueMatches) {
  Random random(6);
  const FeatureSet scene = RealisticFeatures(random, 12'000);
  FeatureSet model;
  std::vector<std::uint32_t> truth;
  for (std::uint32_t i = 0; i < 400; ++i) {
    truth.push_back(random.Below(12'000));
    model.keypoints.push_back(scene.keypoints[truth.back()]);
    for (const std::uint8_t value : scene.View().Descriptor(truth.back())) {
      const double changed = value + 18 * random.Normal();  // 200 away
      model.descriptors.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(changed, 0.0, 255.0))));
    }
  }
  const ShortenedFeatures shortened(model.View());
  const UprightTemplate view = shortened.View();
  const std::vector<float> lean_rad(scene.size(), 0.0F);
  std::size_t found = 0;
  const auto matches = UprightMatcher(scene.View(), lean_rad).Match({&view, 1}, kPi, 1);
  for (const RankedMatch& match : matches.front())
    found += match.scene_keypoint == truth[match.template_keypoint] ? 1U : 0U;
  EXPECT_GT(found, 340U);
}

TEST(UprightMatcher, AnEmptySceneGivesNoMatches) {
  Random random(3);
  const FeatureSet model = RandomUprightFeatures(random, 5);
  const ShortenedFeatures shortened(model.View());
  const UprightTemplate view = shortened.View();
  const std::vector<std::vector<RankedMatch>> matches = UprightMatcher({}, {}).Match({&view, 1}, 1, 2);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_TRUE(matches[0].empty());
}

}  // namespace
}  // namespace victorious
