#include "victorious/jobs/index/indexer.h"

#include <string>
#include <utility>

#include "victorious/base/options.h"
#include "victorious/jobs/association_options.h"
#include "victorious/jobs/index/index_run.h"
#include "victorious/jobs/index/segmented_run.h"
#include "victorious/jobs/model_engine.h"
#include "victorious/place/associate/update_objects.h"

namespace victorious {
namespace {

// Updates the objects of the whole index, and passes on the warnings about the job's video.
Status UpdateObjectsOf(const IndexSetup& setup, const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                       const WarningSink& warn) {
  const auto tell_of_own = [&](const VideoRecord& video, const FlightNotes& notes) {
    if (video.name != job.StoredName()) return;
    for (const std::string& warning : notes.warnings) warn(warning);
    if (!job.inform) return;
    for (const std::string& line : notes.telemetry_errors) job.inform("error of telemetry: " + line);
  };
  return UpdateObjects(setup.options.objects, store, cancel, tell_of_own);
}

WarningSink OrSilence(const WarningSink& warn) {
  return warn ? warn : [](const std::string&) {};
}

}  // namespace

Expected<Indexer> Indexer::Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                  std::optional<CategorySourceInput> categories, const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  IndexSetup setup{
      .models = {}, .options = options, .extractor = {}, .kept_extractor = {}, .categories = {}, .targets = {}};
  IndexOptions& used = setup.options;
  VICTORIOUS_RETURN_IF_ERROR(AdoptEngineOfModels(models, used.features, warn));
  VICTORIOUS_ASSIGN_OR_RETURN(setup.extractor, MakeFeatureExtractor(used.features));
  VICTORIOUS_ASSIGN_OR_RETURN(setup.kept_extractor, MakeFeatureExtractor(MakeKeptFeatureOptions(used.features)));
  VICTORIOUS_ASSIGN_OR_RETURN(used.objects, PrepareAssociation(used.objects, options.ground, warn));
  for (const ObjectModel& model : models) {
    setup.targets.push_back({.name = model.name, .content_id = model.id, .kind = model.kind});
  }
  setup.models = std::make_shared<const std::vector<ObjectModel>>(std::move(models));
  if (categories) {
    VICTORIOUS_ASSIGN_OR_RETURN(setup.categories,
                                MakeCategorySource(*std::move(categories), options.categories, options.detector));
    if (setup.categories->IsDetector()) used.category_interval_s = options.detector.interval_s;
    if (setup.categories->IsListed()) {
      used.every = 0;  // all frames
      used.keep.interval_s = -1;
      used.tracklets.are_tracks_given = true;
    }
    for (const std::string& name : setup.categories->names()) {
      setup.targets.push_back(
          {.name = name, .content_id = setup.categories->content_id(), .kind = ModelKind::kCategory});
    }
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckNames(setup.targets, setup.targets));
  return Indexer(std::make_unique<const IndexSetup>(std::move(setup)));
}

Expected<bool> Indexer::IsRedone(const IndexJob& job, const VideoInfo& info, const std::string& content_id,
                                 IndexStore& store) const {
  return victorious::IsRedone(*setup_, job, info, content_id, store);
}

Expected<IndexReport> Indexer::Index(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                     const WarningSink& warn) const {
  const WarningSink emit_warning = OrSilence(warn);
  Expected<IndexReport> report = IndexRun(*setup_, job, cancel, store, emit_warning).Search();
  if (report || report.error().code == ErrorCode::kCancelled) {
    VICTORIOUS_RETURN_IF_ERROR(UpdateObjectsOf(*setup_, job, cancel, store, emit_warning));
  }
  return report;
}

Expected<SegmentedReport> Indexer::IndexBySegments(const IndexJob& job, double segment_s, const CancelToken& cancel,
                                                   IndexStore& store, SegmentStore& segments,
                                                   const WarningSink& warn) const {
  const WarningSink emit_warning = OrSilence(warn);
  IndexRun run(*setup_, job, cancel, store, emit_warning);
  Expected<SegmentedReport> report = SegmentedRun(run, segments).Search(segment_s);
  const bool is_ended = report ? !report->waits_for : report.error().code == ErrorCode::kCancelled;
  if (is_ended) VICTORIOUS_RETURN_IF_ERROR(UpdateObjectsOf(*setup_, job, cancel, store, emit_warning));
  return report;
}

Expected<IndexReport> Indexer::IndexSegment(const IndexJob& job, FrameInterval frames, const CancelToken& cancel,
                                            IndexStore& store, SegmentStore& segments, const WarningSink& warn) const {
  const WarningSink emit_warning = OrSilence(warn);
  IndexRun run(*setup_, job, cancel, store, emit_warning);
  return SegmentedRun(run, segments).SearchSegment(frames);
}

}  // namespace victorious
