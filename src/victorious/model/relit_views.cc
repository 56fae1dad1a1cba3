#include "victorious/model/relit_views.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/model/cad_model.h"
#include "victorious/model/template_features.h"
#include "victorious/model/view_picture.h"
#include "victorious/model/view_surface.h"
#include "victorious/geometry/view_sphere.h"

namespace victorious {
namespace {

// Downsamples by 2: the mean of four grey values, but the depth of one pixel, because the mean depth of two surfaces
// lies on neither.
ViewSurface Halved(const ViewSurface& surface) {
  ViewSurface half;
  const cv::Size size(surface.grey.cols / 2, surface.grey.rows / 2);
  const cv::Rect even(0, 0, 2 * size.width, 2 * size.height);
  cv::resize(surface.grey(even), half.grey, size, 0, 0, cv::INTER_AREA);
  cv::resize(surface.seen.depth_m(even), half.seen.depth_m, size, 0, 0, cv::INTER_NEAREST);
  half.seen.camera = surface.seen.camera;
  PinholeCamera& pinhole = half.seen.camera.pinhole;
  pinhole.fx /= 2;
  pinhole.fy /= 2;
  pinhole.cx /= 2;
  pinhole.cy /= 2;
  pinhole.width = size.width;
  pinhole.height = size.height;
  return half;
}

class LitViews : public LitTemplates {
 public:
  LitViews(const ObjectModel& model, const CadModelOptions& options, std::unique_ptr<const FeatureExtractor> extractor,
           std::size_t most_kept)
      : model_(model), options_(options), extractor_(std::move(extractor)), most_kept_(most_kept) {}

  std::shared_ptr<const LitTemplate> Under(const LitView& wanted) const override {
    const std::shared_ptr<Slot> slot = SlotOf(wanted);
    MakeIfUnclaimed(wanted, *slot);
    slot->made.wait(false);
    return slot->lit;
  }

  void Prepare(std::span<const LitView> wanted) const override {
    oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
      oneapi::tbb::parallel_for(std::size_t{0}, wanted.size(),
                                [&](std::size_t i) { MakeIfUnclaimed(wanted[i], *SlotOf(wanted[i])); });
    });
  }

  std::shared_ptr<const ViewPicture> Picture(std::size_t view, int half_octaves) const override {
    const std::pair key(view, half_octaves);
    {
      const std::scoped_lock lock(mutex_);
      if (const auto known = pictures_.find(key); known != pictures_.end()) return known->second;
    }
    const Expected<ViewSurface> surface = DecodeSurface(model_.views[view].surface, model_.name);
    auto made = std::make_shared<const ViewPicture>(surface ? PictureOf(*surface, std::exp2(half_octaves / 2.0))
                                                            : ViewPicture());
    const std::scoped_lock lock(mutex_);  // another thread may have added the same entry meanwhile
    if (pictures_.size() >= most_kept_) pictures_.clear();
    return pictures_.try_emplace(key, std::move(made)).first->second;
  }

 private:
  struct Slot {
    std::atomic<bool> claimed = false;
    std::atomic<bool> made = false;
    std::shared_ptr<const LitTemplate> lit;  // valid once `made` is true
  };

  struct Kept {
    std::shared_ptr<Slot> slot;  // co-owned by waiting threads
    std::uint64_t last_use = 0;
  };

  std::shared_ptr<Slot> SlotOf(const LitView& wanted) const {
    const std::scoped_lock lock(mutex_);
    Kept& kept = kept_[wanted];
    if (!kept.slot) kept.slot = std::make_shared<Slot>();
    kept.last_use = ++uses_;
    std::shared_ptr<Slot> slot = kept.slot;
    if (kept_.size() > most_kept_) ForgetOlderHalf();
    return slot;
  }

  // Evicts the least recently used half of the cache. Needed because a circling camera requests every view under every
  // sun.
  void ForgetOlderHalf() const {
    std::vector<std::uint64_t> uses;
    for (const auto& [view, kept] : kept_) uses.push_back(kept.last_use);
    const auto middle = uses.begin() + static_cast<std::ptrdiff_t>(uses.size() / 2);
    std::ranges::nth_element(uses, middle);
    std::erase_if(kept_, [&](const auto& one) { return one.second.last_use < *middle; });
  }

  void MakeIfUnclaimed(const LitView& wanted, Slot& slot) const {
    if (slot.claimed.exchange(true)) return;
    try {
      slot.lit = std::make_shared<const LitTemplate>(Make(wanted));
    } catch (...) {         // out of memory, as reported by the libraries
      slot.lit = nothing_;  // waiting threads must be released
    }
    slot.made = true;
    slot.made.notify_all();
  }

  [[nodiscard]] LitTemplate Make(const LitView& wanted) const {
    const Expected<ViewSurface> surface = DecodeSurface(model_.views[wanted.view].surface, model_.name);
    const Expected<ViewSurface> from_sun = DecodeSurface(model_.views[wanted.sun_view].surface, model_.name);
    if (!surface || !from_sun) return {};  // a damaged file whose checksums are nevertheless right
    const ViewAngles& sun = *model_.views[wanted.sun_view].angles;
    const bool halved = wanted.coarse && std::min(surface->grey.cols, surface->grey.rows) >= 2;
    const ViewSurface shown = halved ? Halved(*surface) : *surface;
    const double share = halved ? 0.5 : 1.0;
    const cv::Mat grey =
        Relight(shown.grey, shown.seen, options_.light, ClearDay({sun.azimuth_rad, sun.off_nadir_rad}), from_sun->seen);
    const cv::Mat mask = shown.seen.depth_m == shown.seen.depth_m;  // not NaN
    Polygon outline = model_.views[wanted.view].outline;
    for (Eigen::Vector2d& corner : outline) corner *= share;
    auto made = TemplateFeaturesOf({.grey = grey, .mask = mask, .outline = outline}, shown.seen, *extractor_, options_);
    if (!made) return {};
    FeatureSet& features = made->features;
    features.image_width = surface->grey.cols;
    features.image_height = surface->grey.rows;
    for (Keypoint& keypoint : features.keypoints) {
      keypoint.x = static_cast<float>(keypoint.x / share);
      keypoint.y = static_cast<float>(keypoint.y / share);
      keypoint.scale_px = static_cast<float>(keypoint.scale_px / share);
    }
    return *std::move(made);
  }

  ObjectModel model_;
  CadModelOptions options_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::size_t most_kept_;
  std::shared_ptr<const LitTemplate> nothing_ = std::make_shared<const LitTemplate>();
  mutable std::mutex mutex_;
  mutable std::map<LitView, Kept> kept_;
  mutable std::uint64_t uses_ = 0;
  mutable std::map<std::pair<std::size_t, int>, std::shared_ptr<const ViewPicture>> pictures_;
};

bool HasSurface(const ModelView& view) { return view.angles && !view.surface.empty(); }

}  // namespace

Expected<std::unique_ptr<const LitTemplates>> MakeLitViews(const ObjectModel& model, std::size_t most_kept) {
  if (model.views.empty() || !std::ranges::all_of(model.views, HasSurface)) return nullptr;
  CadModelOptions options;
  const auto json = nlohmann::json::parse(model.options_json, nullptr, /*allow_exceptions=*/false);
  if (Status status = SetFromJson(json, FieldsOf(options)); !status) {
    return std::unexpected(std::move(status).error().WithContext(fmt::format("model {}", model.name)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(auto extractor, MakeFeatureExtractor(options.features));
  return std::make_unique<const LitViews>(model, options, std::move(extractor), most_kept);
}

}  // namespace victorious
