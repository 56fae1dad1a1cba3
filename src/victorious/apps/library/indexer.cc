#include "victorious/indexer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/apps/library/facade.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/object/model/relit_template_folder.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/store/open_store.h"

namespace libvictorious {
namespace {

victorious::Expected<victorious::IndexOptions> IndexOptionsOf(const IndexerSettings& settings,
                                                              const std::vector<victorious::ObjectModel>& models) {
  victorious::IndexOptions options;
  if (!settings.quality.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const victorious::Quality quality, victorious::ParseQuality(settings.quality));
    const bool cad_only = std::ranges::all_of(models, [](const auto& one) {  // as `index --quality`
      return one.kind == victorious::ModelKind::kCad;
    });
    victorious::ApplyQuality(quality, cad_only, options);
  }
  VICTORIOUS_RETURN_IF_ERROR(ApplyParams(settings.params, options));
  if (!settings.hfov_deg) return options;
  if (!(*settings.hfov_deg > 0 && *settings.hfov_deg < 180)) {
    return victorious::Fail(victorious::ErrorCode::kInvalidArgument,
                            fmt::format("hfov_deg {:g}: must be above 0 and below 180 degrees", *settings.hfov_deg));
  }
  options.telemetry.hfov_deg = *settings.hfov_deg;
  return options;
}

// Before an index is made: a wrong name leaves none.
victorious::Status CheckInputs(const std::string& video, const IndexJob& job, const victorious::IndexOptions& options) {
  if (!video.contains("://")) VICTORIOUS_RETURN_IF_ERROR(victorious::VideoReader::Open(video, {}));
  if (!job.telemetry.empty()) {
    VICTORIOUS_RETURN_IF_ERROR(victorious::ReadTelemetry(job.telemetry, options.telemetry));
  }
  return {};
}

}  // namespace

struct Indexer::Impl {
  victorious::IndexOptions options;
  victorious::Indexer indexer;
  std::shared_ptr<const victorious::RelitTemplateFolder> relit_folder;  // null: none
  std::shared_ptr<victorious::kernels::NearestDevice> device;           // null: the processor
};

Indexer::Indexer(const std::vector<Model>& models, const IndexerSettings& settings) {
  Guard([&] {
    if (models.empty() && settings.categories.empty()) {
      throw Error(ErrorCode::kInvalidArgument, "nothing to search for: give models or categories");
    }
    std::vector<victorious::ObjectModel> inner = ObjectModelsOf(models);
    const victorious::IndexOptions options = Unwrap(IndexOptionsOf(settings, inner));
    std::optional<victorious::CategorySourceModel> categories;
    if (!settings.categories.empty()) categories = Unwrap(victorious::ReadCategorySource(settings.categories));
    victorious::Indexer indexer =
        Unwrap(victorious::Indexer::Create(std::move(inner), options, std::move(categories), settings.warn));
    std::string why_not;
    impl_ = std::make_unique<Impl>(Impl{.options = options,
                                        .indexer = std::move(indexer),
                                        .relit_folder = victorious::OpenUsersRelitTemplates(),
                                        .device = victorious::kernels::OpenNearestDevice(why_not)});
  });
}

Indexer::Indexer(Indexer&& other) noexcept = default;
Indexer& Indexer::operator=(Indexer&& other) noexcept = default;
Indexer::~Indexer() = default;

IndexReport Indexer::Index(const std::string& video, const std::string& index, const IndexJob& job) {
  LongWork work(job.progress);
  victorious::Expected<victorious::IndexReport> done = Guard([&] {
    Unwrap(CheckInputs(video, job, impl_->options));
    const std::unique_ptr<victorious::IndexStore> store =
        Unwrap(victorious::OpenStore(index, victorious::StoreMode::kCreate));
    const victorious::IndexJob inner{
        .video = video,
        .telemetry = job.telemetry.empty() ? std::nullopt : std::optional(job.telemetry),
        .redo = job.redo ? victorious::Redo::kAlways : victorious::Redo::kNever,
        .threads = job.threads,
        .from_s = job.from_s,
        .to_s = job.to_s,
        .relit_folder = impl_->relit_folder.get(),
        .device = impl_->device,
    };
    const auto warn = [&](const std::string& warning) {
      if (job.warn) job.warn(warning);
    };
    return impl_->indexer.Index(inner, work.cancel(), *store, warn);
  });
  const victorious::IndexReport report = work.Finish(std::move(done));
  return {report.has_telemetry, report.frames_searched, report.sightings};
}

}  // namespace libvictorious
