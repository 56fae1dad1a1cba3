#include "victorious/search/recognize/common_view.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

const cv::Size kCommonFrame(1280, 720);
constexpr double kPixelsPerM = 10;
constexpr double kCommonOffNadir_rad = RadiansFromDegrees(50);
constexpr double kFocal_px = 4000;

// Matches of objects that stand in one flight, with errors of 4 % and 3 degrees.
std::vector<ShapeMatch> Standing(std::size_t models, std::size_t of_each, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<ShapeMatch> matches;
  for (std::size_t i = 0; i < models * of_each; ++i) {
    const double y_px = random.Uniform(-300, 300);
    ShapeMatch match{.model_index = i % models, .centre_px = {640, 360 + y_px}, .neg_log10_nfa = 4};
    match.pixels_per_m =
        kPixelsPerM * std::exp(std::tan(kCommonOffNadir_rad) * y_px / kFocal_px + 0.04 * random.Normal());
    match.to_camera.off_nadir_rad = kCommonOffNadir_rad - y_px / kFocal_px + RadiansFromDegrees(3) * random.Normal();
    matches.push_back(match);
  }
  return matches;
}

// Matches of one model with a pattern that repeats itself, in another size.
void AddPattern(std::size_t model, std::size_t count, std::vector<ShapeMatch>& matches) {
  for (std::size_t i = 0; i < count; ++i) {
    matches.push_back({.model_index = model, .centre_px = {640, 360}, .pixels_per_m = 3, .neg_log10_nfa = 6});
    matches.back().to_camera.off_nadir_rad = RadiansFromDegrees(20);
  }
}

TEST(FindCommonView, IsThatOfTheObjectsThatStandThere) {
  std::vector<ShapeMatch> matches = Standing(5, 6);
  AddPattern(7, 30, matches);
  const auto view = FindCommonView(matches, kCommonFrame);
  ASSERT_TRUE(view);
  EXPECT_NEAR(view->pixels_per_m, kPixelsPerM, 0.3);
  EXPECT_NEAR(view->off_nadir_rad, kCommonOffNadir_rad, RadiansFromDegrees(3));
  EXPECT_NEAR(std::log(view->focal_px / kFocal_px), 0, 0.4);
}

TEST(FindCommonView, TwoModelsAreTooFew) { EXPECT_FALSE(FindCommonView(Standing(2, 20), kCommonFrame)); }

TEST(FindCommonView, AWeakAgreementIsTooLittle) {
  std::vector<ShapeMatch> matches = Standing(5, 2);
  EXPECT_FALSE(FindCommonView(matches, kCommonFrame));
  EXPECT_FALSE(FindCommonView({}, kCommonFrame));
}

TEST(FindCommonView, OfTwoViewsThatAgreeAsWellNeitherIsTaken) {
  std::vector<ShapeMatch> matches = Standing(5, 6);
  for (const ShapeMatch& match : Standing(4, 6, 2)) {
    matches.push_back(match);
    matches.back().pixels_per_m *= 2;
  }
  EXPECT_FALSE(FindCommonView(matches, kCommonFrame));
}

TEST(ConditionsOf, HaveTheViewInTheMiddleAndLargerObjectsBelow) {
  const CommonView view{.off_nadir_rad = kCommonOffNadir_rad, .pixels_per_m = kPixelsPerM, .focal_px = kFocal_px};
  const FrameConditions conditions = ConditionsOf(view, kCommonFrame);
  ASSERT_TRUE(conditions.vertical && conditions.height_above_ground_m);
  const auto down_at = [&](double y_px) {
    return -conditions.vertical->up_in_camera.dot(conditions.vertical->pinhole.Unproject({640, y_px}));
  };
  const auto pixels_per_m_at = [&](double y_px) {
    return conditions.vertical->pinhole.fx * down_at(y_px) / *conditions.height_above_ground_m;
  };
  EXPECT_NEAR(std::acos(down_at(360)), kCommonOffNadir_rad, 1e-6);
  EXPECT_NEAR(pixels_per_m_at(360), kPixelsPerM, 1e-6);
  EXPECT_NEAR(std::log(pixels_per_m_at(460) / pixels_per_m_at(360)), std::tan(kCommonOffNadir_rad) * 100 / kFocal_px,
              0.002);
}

}  // namespace
}  // namespace victorious
