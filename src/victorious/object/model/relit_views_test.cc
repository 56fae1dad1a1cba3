#include "victorious/object/model/relit_views.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/small_cad_model.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/view_surface.h"

namespace victorious {
namespace {

using testing::SmallCadModel;

TEST(ViewSurface, RoundTrips) {
  const ViewSurface first = DecodeSurface(SmallCadModel().views[3].surface, "slab").value();
  const auto bytes = EncodeSurface(first).value();
  const ViewSurface again = DecodeSurface(bytes, "slab").value();
  EXPECT_EQ(cv::norm(first.grey, again.grey, cv::NORM_INF), 0);
  const cv::Mat depth_map = first.depth_map.depth_m == first.depth_map.depth_m;
  ASSERT_GT(cv::countNonZero(depth_map), 1000);
  EXPECT_EQ(cv::countNonZero(depth_map != (again.depth_map.depth_m == again.depth_map.depth_m)), 0);
  cv::Mat off;
  cv::absdiff(first.depth_map.depth_m, again.depth_map.depth_m, off);
  off.setTo(0, ~depth_map);
  EXPECT_LT(cv::norm(off, cv::NORM_INF), 1e-3);
  EXPECT_LT(
      (first.depth_map.camera.camera_from_world.Matrix() - again.depth_map.camera.camera_from_world.Matrix()).norm(),
      1e-12);
}

TEST(ViewSurface, PartHasTheObjectAndABorderOfBackground) {
  const std::span<const std::byte> bytes = SmallCadModel().views[3].surface;
  const ViewSurface whole = DecodeSurface(bytes, "slab").value();
  const SurfacePart part = DecodeSurfacePart(bytes, "slab").value();
  EXPECT_EQ(part.rendering_px, whole.grey.size());
  EXPECT_EQ(part.origin.x % 2, 0);
  EXPECT_EQ(part.origin.y % 2, 0);
  const cv::Rect place(part.origin, part.surface.grey.size());
  ASSERT_EQ(place & cv::Rect({0, 0}, part.rendering_px), place);
  EXPECT_LT(place.area(), whole.grey.size().area());
  EXPECT_EQ(cv::norm(part.surface.grey, whole.grey(place), cv::NORM_INF), 0);
  cv::Mat object = part.surface.depth_map.depth_m == part.surface.depth_map.depth_m;
  const cv::Mat same = part.surface.depth_map.depth_m == whole.depth_map.depth_m(place);
  EXPECT_EQ(cv::countNonZero(same), cv::countNonZero(object));
  EXPECT_EQ(cv::countNonZero(object), cv::countNonZero(whole.depth_map.depth_m == whole.depth_map.depth_m));
  object(cv::Rect(2, 2, place.width - 4, place.height - 4)).setTo(0);
  EXPECT_EQ(cv::countNonZero(object), 0);
  const PinholeCamera& pinhole = part.surface.depth_map.camera.pinhole;
  EXPECT_EQ(pinhole.cx + part.origin.x, whole.depth_map.camera.pinhole.cx);
  EXPECT_EQ(pinhole.cy + part.origin.y, whole.depth_map.camera.pinhole.cy);
}

TEST(ViewSurface, HalfPartHasMeanGreysAndEverySecondDepth) {
  const std::span<const std::byte> bytes = SmallCadModel().views[3].surface;
  const SurfacePart part = DecodeSurfacePart(bytes, "slab").value();
  const HalfSurfacePart half_part = DecodeHalfSurfacePart(bytes, "slab").value();
  const ViewSurface half = half_part.Surface();
  EXPECT_EQ(half_part.rendering_px, part.rendering_px);
  EXPECT_EQ(2 * half_part.origin, part.origin);
  ASSERT_EQ(half.grey.size(), part.surface.grey.size() / 2);
  ASSERT_EQ(half.depth_map.depth_m.size(), half.grey.size());
  for (int row = 0; row < half.grey.rows; ++row) {
    for (int column = 0; column < half.grey.cols; ++column) {
      const cv::Mat four = part.surface.grey(cv::Rect(2 * column, 2 * row, 2, 2));
      ASSERT_NEAR(half.grey.at<std::uint8_t>(row, column), cv::mean(four)[0], 0.51);
      const float depth_m = half.depth_map.depth_m.at<float>(row, column);
      const float expected_m = part.surface.depth_map.depth_m.at<float>(2 * row, 2 * column);
      ASSERT_TRUE(depth_m == expected_m || (std::isnan(depth_m) && std::isnan(expected_m)));
    }
  }
  EXPECT_EQ(2 * half.depth_map.camera.pinhole.fx, part.surface.depth_map.camera.pinhole.fx);
  EXPECT_EQ(2 * half.depth_map.camera.pinhole.cx, part.surface.depth_map.camera.pinhole.cx);
  EXPECT_EQ(half.depth_map.camera.pinhole.width, half.grey.cols);
}

TEST(ViewSurface, DamagedSurfaceIsAnError) {
  const std::span<const std::byte> sound = SmallCadModel().views[3].surface;
  for (const std::size_t kept : {std::size_t{0}, std::size_t{50}, std::size_t{120}, sound.size() / 2}) {
    const auto result = DecodeSurface(sound.first(kept), "model slab");
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kDataLoss);
    EXPECT_NE(result.error().message.find("model slab"), std::string::npos);
    EXPECT_FALSE(DecodeHalfSurfacePart(sound.first(kept), "model slab"));
  }
  std::vector<std::byte> elsewhere(sound.begin(), sound.end());
  elsewhere[104] = std::byte{0x7F};  // the left edge of the stored crop, beyond the rendering's width
  elsewhere[105] = std::byte{0x7F};
  EXPECT_FALSE(DecodeSurface(elsewhere, "model slab"));
}

// Relit templates have features and points of the same form as the original ones; they depend on the sun, and repeated
// requests give the same ones.
TEST(RelitViews, FeaturesDependOnTheSun) {
  const auto relit = MakeRelitViews(SmallCadModel()).value();
  ASSERT_NE(relit, nullptr);
  constexpr std::size_t kView = 5;
  const auto east = relit->GetTemplate({7, kView}).value();
  const auto west = relit->GetTemplate({10, kView}).value();
  ASSERT_GT(east->features.size(), 10U);
  EXPECT_EQ(east->features.size(), east->points_in_model.size());
  EXPECT_NE(east->features.descriptors, west->features.descriptors);
  EXPECT_EQ(relit->GetTemplate({7, kView}).value(), east);
  for (const Point3& point : east->points_in_model) {
    EXPECT_LE(std::abs(point.x), 2.15F);  // the extent of the slab, and the error of a keypoint's place
    EXPECT_LE(std::abs(point.y), 1.65F);
    EXPECT_LE(point.z, 0.55F);
  }
}

// A coarse template has fewer features than the full one, with larger keypoints, at the projections of their points.
TEST(RelitViews, CoarseTemplateHasTheSamePixelFrame) {
  const auto relit = MakeRelitViews(SmallCadModel()).value();
  constexpr std::size_t kView = 5;
  const auto sharp = relit->GetTemplate({7, kView}).value();
  const auto coarse = relit->GetTemplate({7, kView, true}).value();
  ASSERT_GT(coarse->features.size(), 10U);
  EXPECT_LT(coarse->features.size(), sharp->features.size());
  EXPECT_EQ(coarse->features.image_width, sharp->features.image_width);
  EXPECT_EQ(coarse->features.image_height, sharp->features.image_height);
  const auto smallest = [](const RelitTemplate& one) {
    return std::ranges::min(one.features.keypoints, {}, &Keypoint::scale_px).scale_px;
  };
  EXPECT_GT(smallest(*coarse), 1.5F * smallest(*sharp));
  ASSERT_EQ(coarse->features.size(), coarse->points_in_model.size());
  const PosedDepthMap depth_map = DecodeSurface(SmallCadModel().views[kView].surface, "slab").value().depth_map;
  for (std::size_t i = 0; i < coarse->features.size(); ++i) {
    const Keypoint& keypoint = coarse->features.keypoints[i];
    const Point3& place = coarse->points_in_model[i];
    const auto pixel =
        depth_map.camera.pinhole.Project(depth_map.camera.camera_from_world.Apply({place.x, place.y, place.z}));
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), keypoint.x, 1.0);
    EXPECT_NEAR(pixel->y(), keypoint.y, 1.0);
  }
}

// An evicted template is made again identically; within the budget it is kept.
TEST(RelitViews, BudgetIsSharedByModels) {
  const auto cache = std::make_shared<RelitViewCache>(300'000);
  const auto relit = MakeRelitViews(SmallCadModel(), cache).value();
  const auto other = MakeRelitViews(SmallCadModel(), cache).value();
  const auto first = relit->GetTemplate({7, 1}).value();
  EXPECT_EQ(relit->GetTemplate({7, 1}).value(), first);
  EXPECT_GT(cache->size_bytes(), first->features.descriptors.size());
  for (std::size_t view = 0; view < SmallCadModel().views.size(); ++view) {
    static_cast<void>(other->GetTemplate({7, view}).value());
    EXPECT_LE(cache->size_bytes(), 300'000U);
  }
  const auto again = relit->GetTemplate({7, 1}).value();
  EXPECT_NE(again, first);
  EXPECT_EQ(again->features.descriptors, first->features.descriptors);
}

// Threads that prepare the same views concurrently share them; each is made once.
TEST(RelitViews, ConcurrentThreadsShareTemplates) {
  const auto relit = MakeRelitViews(SmallCadModel()).value();
  std::vector<RelitTemplateKey> wanted;
  for (std::size_t view = 1; view < 7; ++view) wanted.push_back({8, view});
  constexpr std::size_t kThreads = 4;
  std::vector<std::vector<std::shared_ptr<const RelitTemplate>>> got(kThreads);
  {
    std::vector<std::jthread> threads;
    for (auto& mine : got) {
      threads.emplace_back([&] {
        relit->Prepare(wanted);
        for (const RelitTemplateKey& one : wanted) mine.push_back(relit->GetTemplate(one).value());
      });
    }
  }
  for (const auto& mine : got) EXPECT_EQ(mine, got.front());
  for (const auto& one : got.front()) {
    ASSERT_NE(one, nullptr);
    EXPECT_GT(one->features.size(), 0U);
  }
  EXPECT_EQ(std::set(got.front().begin(), got.front().end()).size(), wanted.size());
}

// Each point lies on the object and projects to a pixel of its brightness.
TEST(RelitViews, AppearanceMatchesTheRendering) {
  const auto views = MakeRelitViews(SmallCadModel()).value();
  constexpr std::size_t kView = 5;
  const ViewSurface surface = DecodeSurface(SmallCadModel().views[kView].surface, "slab").value();
  cv::Mat blurred;
  cv::GaussianBlur(surface.grey, blurred, {}, kAppearanceBlur_px);
  const auto appearance = views->GetAppearance(kView, 0).value();
  ASSERT_GT(appearance->points.size(), 150U);
  const Eigen::Matrix3d turned = appearance->camera_from_model.toRotationMatrix();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double off = 0;
  for (const SurfaceSample& point : appearance->points) {
    middle += point.position_m.cast<double>();
    const Eigen::Vector2d at =
        appearance->centre_px + appearance->pixels_per_m * (turned * point.position_m.cast<double>()).head<2>();
    const cv::Point pixel(static_cast<int>(at.x()), static_cast<int>(at.y()));
    ASSERT_TRUE(cv::Rect({0, 0}, blurred.size()).contains(pixel));
    ASSERT_FALSE(std::isnan(surface.depth_map.depth_m.at<float>(pixel)));
    off += std::abs(point.brightness - static_cast<float>(blurred.at<std::uint8_t>(pixel)));
  }
  const auto n = static_cast<double>(appearance->points.size());
  EXPECT_LT(middle.norm() / n, 1e-3);
  EXPECT_LT(off / n, 6);  // weak perspective is a pixel or two off

  EXPECT_EQ(views->GetAppearance(kView, 0).value(), appearance);
  const auto coarse = views->GetAppearance(kView, 4).value();
  const auto contrast = [](const ViewAppearance& of) {
    const auto [least, most] = std::ranges::minmax(of.points, {}, &SurfaceSample::brightness);
    return most.brightness - least.brightness;
  };
  EXPECT_LT(contrast(*coarse), contrast(*appearance));
}

TEST(RelitViews, DamagedRenderingIsAnError) {
  ObjectModel model = SmallCadModel();
  model.views[3].surface = model.views[3].surface.first(50);
  const auto views = MakeRelitViews(model).value();
  const Expected<std::shared_ptr<const ViewAppearance>> appearance = views->GetAppearance(3, 0);
  ASSERT_FALSE(appearance);
  EXPECT_EQ(appearance.error().code, ErrorCode::kDataLoss);
  EXPECT_EQ(appearance.error().message, "model slab: view 3: damaged: make the model again");
  for (const RelitTemplateKey& key : {RelitTemplateKey{7, 3}, RelitTemplateKey{3, 7}}) {
    views->Prepare(std::span(&key, 1));
    const Expected<std::shared_ptr<const RelitTemplate>> relit = views->GetTemplate(key);
    ASSERT_FALSE(relit);
    EXPECT_EQ(relit.error().message, appearance.error().message);
  }
  EXPECT_TRUE(views->GetTemplate({7, 1}));
}

TEST(RelitViews, KeepTheMemoryOfTheModel) {
  auto model = std::make_unique<ObjectModel>(SmallCadModel());
  auto storage = std::make_shared<std::vector<std::vector<std::byte>>>();
  for (ModelView& view : model->views) {
    view.surface = storage->emplace_back(view.surface.begin(), view.surface.end());
  }
  model->storage = storage;
  const std::weak_ptr<const void> kept = storage;
  storage.reset();
  auto views = MakeRelitViews(*model).value();
  model.reset();
  ASSERT_FALSE(kept.expired());
  const auto expected = MakeRelitViews(SmallCadModel()).value()->GetTemplate({7, 3}).value();
  EXPECT_EQ(views->GetTemplate({7, 3}).value()->features.descriptors, expected->features.descriptors);
  views.reset();
  EXPECT_TRUE(kept.expired());
}

TEST(RelitViews, PhotoModelsHaveNoRelitViews) {
  ObjectModel model = SmallCadModel();
  model.views[2].surface = {};
  EXPECT_EQ(MakeRelitViews(model).value(), nullptr);
}

}  // namespace
}  // namespace victorious
