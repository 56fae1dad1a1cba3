// For tests only: flat textured objects pasted into random scenes, and a model whose templates depend on the sun.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"
#include "victorious/object/features/descriptor_cells.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious::testing {

/// A random image full of corners, different for each seed.
inline cv::Mat Texture(int width, int height, std::uint64_t seed) {
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

inline FeatureSet FeaturesOf(const cv::Mat& image) { return MakeFeatureExtractor({}).value()->Extract(image).value(); }

/// A model of one view, with the keypoints of the image.
inline ObjectModel ModelOf(const std::string& name, const cv::Mat& image) {
  const auto storage = std::make_shared<FeatureSet>(FeaturesOf(image));
  ObjectModel model;
  model.name = name;
  model.engine = FeatureOptions().engine;
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

/// Pastes `object` into `scene` by a similarity.
inline Similarity2 Paste(const cv::Mat& object, double scale, double rotation_rad, const Eigen::Vector2d& centre,
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

/// Off-nadir angle and number of the views of ModelFromAround: one every 30 degrees of azimuth.
inline constexpr double kOffNadir_rad = 40 * kPi / 180;
inline constexpr std::size_t kAround = 12;

/// A CAD model that has one texture from everywhere under diffuse light; SunDependentTemplates gives it another under
/// each sun.
inline ObjectModel ModelFromAround() {
  ObjectModel model = ModelOf("crate", Texture(120, 90, 99));
  model.kind = ModelKind::kCad;
  const ModelView view = model.views[0];
  model.views.clear();
  for (std::size_t i = 0; i < kAround; ++i) {
    model.views.push_back(view);
    model.views.back().angles = ViewDirection{2 * kPi * static_cast<double>(i) / kAround, kOffNadir_rad};
    model.views.back().neighbours = {static_cast<std::uint32_t>((i + 1) % kAround)};
  }
  return model;
}

/// The relit templates of ModelFromAround: a texture of its own for each view and each sun above the azimuth of a view.
/// Thread-safe.
class SunDependentTemplates : public RelitTemplateSource {
 public:
  SunDependentTemplates() {
    for (std::size_t i = 0; i < kAround * kAround; ++i) {
      auto lit = std::make_shared<RelitTemplate>();
      lit->features = FeaturesOf(ImageOf(i / kAround, i % kAround));
      lit->shortened = ShortenDescriptors(lit->features.descriptors);
      lit_.push_back(std::move(lit));
    }
  }
  static cv::Mat ImageOf(std::size_t sun_view, std::size_t view) {
    return Texture(120, 90, 1000 + kAround * sun_view + view);
  }

  [[nodiscard]] Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(
      const RelitTemplateKey& wanted) const override {
    const std::scoped_lock lock(mutex_);
    (wanted.half_resolution ? coarse_ : sharp_).insert(wanted.view);
    return lit_[kAround * wanted.sun_view + wanted.view];
  }
  void Prepare(std::span<const RelitTemplateKey> /*wanted*/) const override {}
  [[nodiscard]] Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t /*view*/,
                                                                              int /*half_octaves*/) const override {
    return std::make_shared<const ViewAppearance>();
  }
  [[nodiscard]] Expected<RenderedSurface> GetSurface(std::size_t /*view*/) const override { return RenderedSurface{}; }

  /// The views queried under a sun, at half and at full resolution.
  [[nodiscard]] const std::set<std::size_t>& coarse() const { return coarse_; }
  [[nodiscard]] const std::set<std::size_t>& sharp() const { return sharp_; }

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const RelitTemplate>> lit_;
  mutable std::set<std::size_t> coarse_;
  mutable std::set<std::size_t> sharp_;
};

}  // namespace victorious::testing
