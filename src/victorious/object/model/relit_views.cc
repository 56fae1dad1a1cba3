#include "victorious/object/model/relit_views.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/core/mat.hpp>

#include "victorious/base/mapped_pages.h"
#include "victorious/base/stage_time.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/features/descriptor_cells.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/template_features.h"
#include "victorious/object/model/view_appearance.h"
#include "victorious/object/model/view_contours.h"
#include "victorious/object/model/view_surface.h"
#include "victorious/object/render/relight.h"

namespace victorious {
namespace {

// Allocated bytes.
template <typename T>
std::size_t Bytes(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}
std::size_t Bytes(const RelitTemplate& made) {
  return sizeof(made) + Bytes(made.features.keypoints) + Bytes(made.features.descriptors) +
         Bytes(made.points_in_model) + Bytes(made.shortened.rows) + Bytes(made.shortened.cells);
}
std::size_t Bytes(const ViewAppearance& made) { return sizeof(made) + Bytes(made.points); }
std::size_t Bytes(const SurfacePart& made) {
  return sizeof(made) + made.surface.grey.total() * (sizeof(std::uint8_t) + sizeof(float));
}
std::size_t Bytes(const HalfSurfacePart& made) {
  return sizeof(made) + made.grey.total() * (sizeof(std::uint8_t) + sizeof(std::uint16_t));
}

// What the cache holds: an item that one thread makes and others wait for.
template <typename Item>
struct Slot {
  std::atomic<bool> claimed = false;
  std::atomic<bool> made = false;
  Expected<std::shared_ptr<const Item>> result;  // valid once `made` is true
};

// What a template is made from. The rest of the model is not copied: the recogniser holds it.
struct UnlitView {
  ViewDirection angles;
  Polygon outline;
  std::span<const std::byte> surface;
};

std::vector<UnlitView> RenderedViewsOf(const ObjectModel& model) {
  std::vector<UnlitView> views;
  views.reserve(model.views.size());
  for (const ModelView& view : model.views) views.push_back({*view.angles, view.outline, view.surface});
  return views;
}

class RelitViews : public RelitTemplateSource {
 public:
  RelitViews(const ObjectModel& model, const CadModelOptions& options,
             std::shared_ptr<const FeatureExtractor> extractor, std::shared_ptr<RelitViewCache> cache,
             std::unique_ptr<const StoredRelitTemplates> stored)
      : name_(model.name),
        centre_m_(model.box_m.value_or(Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero())).center()),
        diagonal_m_(model.box_m ? model.box_m->sizes().norm() : 0),
        views_(RenderedViewsOf(model)),
        storage_(model.storage),
        options_(options),
        extractor_(std::move(extractor)),
        cache_(std::move(cache)),
        stored_(std::move(stored)),
        number_(cache_->AddModel()) {}

  Expected<std::shared_ptr<const RelitTemplate>> GetTemplate(const RelitTemplateKey& wanted) const override {
    using enum RelitViewCache::Kind;
    return Get<RelitTemplate>(
        {number_, wanted.half_resolution ? kHalfTemplate : kTemplate, wanted.view, wanted.sun_view}, [&] {
          const StageScope scope(Stage::kRelitTemplates);
          return FindOrMakeTemplate(wanted);
        });
  }

  void Prepare(std::span<const RelitTemplateKey> wanted) const override {
    oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
      oneapi::tbb::parallel_for(std::size_t{0}, wanted.size(),
                                [&](std::size_t i) { static_cast<void>(GetTemplate(wanted[i])); });
    });
  }

  Expected<std::shared_ptr<const ViewAppearance>> GetAppearance(std::size_t view, int half_octaves) const override {
    const RelitViewCache::Key key{number_, RelitViewCache::Kind::kAppearance, view,
                                  static_cast<std::size_t>(half_octaves)};
    return Get<ViewAppearance>(key, [&]() -> Expected<ViewAppearance> {
      VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface, DecodeSurface(views_[view].surface, NameOf(view)));
      return SampleTemplatePoints(surface, std::exp2(half_octaves / 2.0));
    });
  }

  Expected<RenderedSurface> GetSurface(std::size_t view) const override {
    constexpr int kShrink = 2;
    VICTORIOUS_ASSIGN_OR_RETURN(const ShownPart part,
                                GetShownPart({.sun_view = view, .view = view, .half_resolution = true}));
    const PosedCamera& camera = part.surface.depth_map.camera;
    RenderedSurface made{.centre_in_model_m = centre_m_};
    made.surface.points = ReadSurface(part.surface.grey, part.surface.depth_map, options_.light);
    for (SurfacePoint& point : made.surface.points) point.position_m -= centre_m_.cast<float>();
    const Eigen::Vector3d centre = camera.camera_from_world.Apply(centre_m_);
    const Eigen::Vector2d centre_in_part = camera.pinhole.Project(centre).value_or(Eigen::Vector2d::Zero());
    made.centre_px = kShrink * (centre_in_part + Eigen::Vector2d(part.origin.x, part.origin.y));
    made.pixels_per_m = kShrink * camera.pinhole.fx / centre.z();
    made.surface.spacing_m = kShrink / made.pixels_per_m;
    return made;
  }

  Expected<std::vector<ContourPoint>> GetContours(std::size_t view) const override {
    VICTORIOUS_ASSIGN_OR_RETURN(const SurfacePart part, DecodeSurfacePart(views_[view].surface, NameOf(view)));
    return ReadContours(part.surface.depth_map, centre_m_, diagonal_m_);
  }

  [[nodiscard]] std::optional<std::vector<std::byte>> FindKept(const std::string& name) const override {
    return stored_ ? stored_->FindBytes(name) : std::nullopt;
  }

  void Keep(const std::string& name, std::span<const std::byte> bytes) const override {
    if (stored_) stored_->PutBytes(name, bytes);
  }

 private:
  // The item of a key; the first thread that asks for it makes it. @param make  returns Expected<Item>
  template <typename Item, typename Make>
  Expected<std::shared_ptr<const Item>> Get(const RelitViewCache::Key& key, const Make& make) const {
    const std::shared_ptr<Slot<Item>> slot = cache_->FindOrAdd<Slot<Item>>(key);
    if (!slot->claimed.exchange(true)) {
      slot->result = MakeShared<Item>(key.view, make);
      slot->made = true;
      slot->made.notify_all();
      cache_->SetSize(key, sizeof(*slot) + (slot->result ? Bytes(**slot->result) : 0));
    }
    slot->made.wait(false);
    return slot->result;
  }

  template <typename Item, typename Make>
  Expected<std::shared_ptr<const Item>> MakeShared(std::size_t view, const Make& make) const {
    try {
      VICTORIOUS_ASSIGN_OR_RETURN(Item made, make());
      return std::make_shared<const Item>(std::move(made));
    } catch (const std::exception& error) {  // of OpenCV, or out of memory: the waiting threads must be released, too
      return Fail(ErrorCode::kInternal, fmt::format("{}: {}", NameOf(view), error.what()));
    }
  }

  [[nodiscard]] std::string NameOf(std::size_t view) const { return fmt::format("model {}: view {}", name_, view); }

  // Error: kDataLoss for a rendering that was damaged before its model file was written: the file's checksums are
  // verified when it is read.
  [[nodiscard]] Expected<std::shared_ptr<const SurfacePart>> GetRendering(std::size_t view) const {
    return Get<SurfacePart>({number_, RelitViewCache::Kind::kRendering, view, 0}, [&] {
      Expected<SurfacePart> part = DecodeSurfacePart(views_[view].surface, NameOf(view));
      ReleaseMappedPages(views_[view].surface);  // most of a model file
      return part;
    });
  }

  // The part of a rendering that a template is made from.
  struct ShownPart {
    ViewSurface surface;
    cv::Point origin;  // px of the surface
    cv::Size rendering_px;
  };

  [[nodiscard]] Expected<ShownPart> GetShownPart(const RelitTemplateKey& wanted) const {
    if (!wanted.half_resolution) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const SurfacePart> part, GetRendering(wanted.view));
      return ShownPart{part->surface, part->origin, part->rendering_px};
    }
    // Each new sun needs new templates of all coarse views: without their renderings, most of the time would go to
    // decoding.
    const RelitViewCache::Key key{number_, RelitViewCache::Kind::kHalfRendering, wanted.view, 0};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const HalfSurfacePart> part, Get<HalfSurfacePart>(key, [&] {
                                  const UnlitView& view = views_[wanted.view];
                                  Expected<HalfSurfacePart> half =
                                      DecodeHalfSurfacePart(view.surface, NameOf(wanted.view));
                                  ReleaseMappedPages(view.surface);
                                  return half;
                                }));
    return ShownPart{part->Surface(), part->origin, part->rendering_px};
  }

  [[nodiscard]] Expected<RelitTemplate> FindOrMakeTemplate(const RelitTemplateKey& wanted) const {
    if (!stored_) return MakeTemplate(wanted);
    if (std::optional<RelitTemplate> found = stored_->Find(wanted)) return *std::move(found);
    Expected<RelitTemplate> made = MakeTemplate(wanted);
    if (made) stored_->Put(wanted, *made);
    return made;
  }

  [[nodiscard]] Expected<RelitTemplate> MakeTemplate(const RelitTemplateKey& wanted) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const ShownPart part, GetShownPart(wanted));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const SurfacePart> from_sun, GetRendering(wanted.sun_view));
    const ViewDirection& sun = views_[wanted.sun_view].angles;
    const ViewSurface& shown = part.surface;
    const int shrink = wanted.half_resolution ? 2 : 1;
    const cv::Mat grey = Relight(shown.grey, shown.depth_map, options_.light,
                                 ClearDayLight({sun.azimuth_rad, sun.off_nadir_rad}), from_sun->surface.depth_map);
    const cv::Mat mask = shown.depth_map.depth_m == shown.depth_map.depth_m;  // not NaN
    Polygon outline = views_[wanted.view].outline;
    for (Eigen::Vector2d& corner : outline) corner /= shrink;
    VICTORIOUS_ASSIGN_OR_RETURN(
        RelitTemplate made,
        ExtractTemplateFeatures({.grey = grey, .mask = mask, .outline = outline, .origin = part.origin},
                                shown.depth_map, *extractor_, options_));
    FeatureSet& features = made.features;
    features.image_width = part.rendering_px.width;
    features.image_height = part.rendering_px.height;
    for (Keypoint& keypoint : features.keypoints) {
      keypoint.x *= static_cast<float>(shrink);
      keypoint.y *= static_cast<float>(shrink);
      keypoint.scale_px *= static_cast<float>(shrink);
    }
    made.shortened = ShortenDescriptors(features.descriptors);
    features.keypoints.shrink_to_fit();  // it stays in the cache
    features.descriptors.shrink_to_fit();
    made.points_in_model.shrink_to_fit();
    return made;
  }

  std::string name_;
  Eigen::Vector3d centre_m_;  // of the bounding box, model frame
  double diagonal_m_;         // of the bounding box; 0: unknown
  std::vector<UnlitView> views_;
  std::shared_ptr<const void> storage_;  // of the surfaces
  CadModelOptions options_;
  std::shared_ptr<const FeatureExtractor> extractor_;
  std::shared_ptr<RelitViewCache> cache_;
  std::unique_ptr<const StoredRelitTemplates> stored_;  // null: none
  std::uint32_t number_;                                // of the model in the cache
};

bool HasSurface(const ModelView& view) { return view.angles && !view.surface.empty(); }

// The extractors of the models of one search: models of equal options share one, with its tables.
class SharedExtractors {
 public:
  Expected<std::shared_ptr<const FeatureExtractor>> Of(const FeatureOptions& options) {
    std::shared_ptr<const FeatureExtractor>& extractor = extractors_[OptionsToJsonText(options)];
    if (!extractor) {
      VICTORIOUS_ASSIGN_OR_RETURN(extractor, MakeFeatureExtractor(options));
    }
    return extractor;
  }

 private:
  std::map<std::string, std::shared_ptr<const FeatureExtractor>> extractors_;  // by options
};

Expected<std::unique_ptr<const RelitTemplateSource>> MakeViews(const ObjectModel& model,
                                                               std::shared_ptr<RelitViewCache> cache,
                                                               const RelitTemplateFolder* folder,
                                                               SharedExtractors& extractors) {
  if (model.views.empty() || !std::ranges::all_of(model.views, HasSurface)) return nullptr;
  CadModelOptions options;
  if (Status status = SetFromJsonText(model.options_json, CollectFields(options)); !status) {
    return std::unexpected(std::move(status).error().WithContext(fmt::format("model {}", model.name)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(auto extractor, extractors.Of(options.features));
  return std::make_unique<const RelitViews>(model, options, std::move(extractor), std::move(cache),
                                            folder == nullptr ? nullptr : folder->Of(model.id));
}

}  // namespace

Expected<std::unique_ptr<const RelitTemplateSource>> MakeRelitViews(const ObjectModel& model,
                                                                    std::shared_ptr<RelitViewCache> cache) {
  SharedExtractors extractors;
  return MakeViews(model, std::move(cache), nullptr, extractors);
}

Expected<std::vector<std::shared_ptr<const RelitTemplateSource>>> MakeRelitViews(std::span<const ObjectModel> models,
                                                                                 const RelitTemplateFolder* folder) {
  const auto cache = std::make_shared<RelitViewCache>(
      folder == nullptr ? RelitViewCache::kDefaultMaxBytes : RelitViewCache::MaxBytesWithFolder(models.size()));
  SharedExtractors extractors;
  std::vector<std::shared_ptr<const RelitTemplateSource>> views;
  for (const ObjectModel& model : models) {
    VICTORIOUS_ASSIGN_OR_RETURN(views.emplace_back(), MakeViews(model, cache, folder, extractors));
  }
  return views;
}

}  // namespace victorious
