#include "victorious/model/relit_views.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/model/cad_model.h"
#include "victorious/model/template_features.h"
#include "victorious/model/view_appearance.h"
#include "victorious/model/view_surface.h"

namespace victorious {
namespace {

// Downsamples by 2: the mean of four grey values, but the depth of one pixel, because the mean depth of two surfaces
// lies on neither.
ViewSurface Downsample2(const ViewSurface& surface) {
  ViewSurface half;
  const cv::Size size(surface.grey.cols / 2, surface.grey.rows / 2);
  const cv::Rect even(0, 0, 2 * size.width, 2 * size.height);
  cv::resize(surface.grey(even), half.grey, size, 0, 0, cv::INTER_AREA);
  cv::resize(surface.depth_map.depth_m(even), half.depth_map.depth_m, size, 0, 0, cv::INTER_NEAREST);
  half.depth_map.camera = surface.depth_map.camera;
  PinholeCamera& pinhole = half.depth_map.camera.pinhole;
  pinhole.fx /= 2;
  pinhole.fy /= 2;
  pinhole.cx /= 2;
  pinhole.cy /= 2;
  pinhole.width = size.width;
  pinhole.height = size.height;
  return half;
}

class RelitViews : public RelitTemplateSource {
 public:
  RelitViews(const ObjectModel& model, const CadModelOptions& options,
             std::unique_ptr<const FeatureExtractor> extractor, std::size_t max_kept)
      : model_(model), options_(options), extractor_(std::move(extractor)), max_kept_(max_kept) {}

  Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(const RelitTemplateKey& wanted) const override {
    const std::shared_ptr<Slot> slot = FindOrAddSlot(wanted);
    MakeIfUnclaimed(wanted, *slot);
    slot->made.wait(false);
    return slot->result;
  }

  void Prepare(std::span<const RelitTemplateKey> wanted) const override {
    oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
      oneapi::tbb::parallel_for(std::size_t{0}, wanted.size(),
                                [&](std::size_t i) { MakeIfUnclaimed(wanted[i], *FindOrAddSlot(wanted[i])); });
    });
  }

  Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t view, int half_octaves) const override {
    const std::pair key(view, half_octaves);
    {
      const std::scoped_lock lock(mutex_);
      if (const auto known = appearances_.find(key); known != appearances_.end()) return known->second;
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface, Decode(view));
    auto made = std::make_shared<const ViewAppearance>(SampleTemplatePoints(surface, std::exp2(half_octaves / 2.0)));
    const std::scoped_lock lock(mutex_);  // another thread may have added the same entry meanwhile
    if (appearances_.size() >= max_kept_) appearances_.clear();
    return appearances_.try_emplace(key, std::move(made)).first->second;
  }

 private:
  struct Slot {
    std::atomic<bool> claimed = false;
    std::atomic<bool> made = false;
    Expected<std::shared_ptr<const RelitTemplate>> result;  // valid once `made` is true
  };

  struct CacheEntry {
    std::shared_ptr<Slot> slot;  // co-owned by waiting threads
    std::uint64_t last_use = 0;
  };

  std::shared_ptr<Slot> FindOrAddSlot(const RelitTemplateKey& wanted) const {
    const std::scoped_lock lock(mutex_);
    CacheEntry& entry = cache_[wanted];
    if (!entry.slot) entry.slot = std::make_shared<Slot>();
    entry.last_use = ++uses_;
    std::shared_ptr<Slot> slot = entry.slot;
    if (cache_.size() > max_kept_) EvictOlderHalf();
    return slot;
  }

  // Evicts the least recently used half of the cache. Needed because a circling camera requests every view under every
  // sun.
  void EvictOlderHalf() const {
    std::vector<std::uint64_t> uses;
    for (const auto& [view, entry] : cache_) uses.push_back(entry.last_use);
    const auto middle = uses.begin() + static_cast<std::ptrdiff_t>(uses.size() / 2);
    std::ranges::nth_element(uses, middle);
    std::erase_if(cache_, [&](const auto& one) { return one.second.last_use < *middle; });
  }

  void MakeIfUnclaimed(const RelitTemplateKey& wanted, Slot& slot) const {
    if (slot.claimed.exchange(true)) return;
    const StageScope scope(Stage::kRelitTemplates);
    try {
      slot.result = Make(wanted);
    } catch (const std::exception& error) {  // of OpenCV, or out of memory: the waiting threads must be released, too
      slot.result = Fail(ErrorCode::kInternal,
                         fmt::format("model {}: relit view {}: {}", model_.name, wanted.view, error.what()));
    }
    slot.made = true;
    slot.made.notify_all();
  }

  // Error: kDataLoss for a rendering that was damaged before its model file was written: the file's checksums are
  // verified when it is read.
  [[nodiscard]] Expected<ViewSurface> Decode(std::size_t view) const {
    return DecodeSurface(model_.views[view].surface, fmt::format("model {}: view {}", model_.name, view));
  }

  [[nodiscard]] Expected<std::shared_ptr<const RelitTemplate>> Make(const RelitTemplateKey& wanted) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface, Decode(wanted.view));
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface from_sun, Decode(wanted.sun_view));
    const ViewAngles& sun = *model_.views[wanted.sun_view].angles;
    const bool halved = wanted.half_resolution && std::min(surface.grey.cols, surface.grey.rows) >= 2;
    const ViewSurface shown = halved ? Downsample2(surface) : surface;
    const double scale = halved ? 0.5 : 1.0;
    const cv::Mat grey = Relight(shown.grey, shown.depth_map, options_.light,
                                 ClearDayLight({sun.azimuth_rad, sun.off_nadir_rad}), from_sun.depth_map);
    const cv::Mat mask = shown.depth_map.depth_m == shown.depth_map.depth_m;  // not NaN
    Polygon outline = model_.views[wanted.view].outline;
    for (Eigen::Vector2d& corner : outline) corner *= scale;
    VICTORIOUS_ASSIGN_OR_RETURN(
        RelitTemplate made, ExtractTemplateFeatures({.grey = grey, .mask = mask, .outline = outline}, shown.depth_map,
                                                    *extractor_, options_));
    FeatureSet& features = made.features;
    features.image_width = surface.grey.cols;
    features.image_height = surface.grey.rows;
    for (Keypoint& keypoint : features.keypoints) {
      keypoint.x = static_cast<float>(keypoint.x / scale);
      keypoint.y = static_cast<float>(keypoint.y / scale);
      keypoint.scale_px = static_cast<float>(keypoint.scale_px / scale);
    }
    return std::make_shared<const RelitTemplate>(std::move(made));
  }

  ObjectModel model_;
  CadModelOptions options_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::size_t max_kept_;
  mutable std::mutex mutex_;
  mutable std::map<RelitTemplateKey, CacheEntry> cache_;
  mutable std::uint64_t uses_ = 0;
  mutable std::map<std::pair<std::size_t, int>, std::shared_ptr<const ViewAppearance>> appearances_;
};

bool HasSurface(const ModelView& view) { return view.angles && !view.surface.empty(); }

}  // namespace

Expected<std::unique_ptr<const RelitTemplateSource>> MakeRelitViews(const ObjectModel& model, std::size_t max_kept) {
  if (model.views.empty() || !std::ranges::all_of(model.views, HasSurface)) return nullptr;
  CadModelOptions options;
  const auto json = nlohmann::json::parse(model.options_json, nullptr, /*allow_exceptions=*/false);
  if (Status status = SetFromJson(json, CollectFields(options)); !status) {
    return std::unexpected(std::move(status).error().WithContext(fmt::format("model {}", model.name)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(auto extractor, MakeFeatureExtractor(options.features));
  return std::make_unique<const RelitViews>(model, options, std::move(extractor), max_kept);
}

}  // namespace victorious
