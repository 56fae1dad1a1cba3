// The main job: video -> features -> recognition -> tracklets -> objects -> store.
//
// Frames are searched in parallel on all cores. Linking and storing are serial in frame order, so the result does not
// depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_job.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/index/index_pass.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/store/index_store.h"
#include "victorious/store/segment_store.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// What one call of Indexer::IndexBySegments did.
struct SegmentedReport {
  IndexReport index;
  /// The cut whose segments are open: IndexSegment searches them, then IndexBySegments is called again. std::nullopt:
  /// the video is indexed.
  std::optional<std::int64_t> waits_for;
};

/// Searches videos, one at a time, for a set of models and categories, and stores what it finds.
class Indexer {
 public:
  /// @param categories  searched for in addition to the models; optional
  /// @param warn        receives warnings about the given ground, and if the models are of another feature engine than
  ///                    options.features: the models' engine is used
  /// Errors: kInvalidArgument for parameters out of range, models of different feature engines, or a model and a
  /// category with the same name; those of MakeCategorySource and of MakeGround.
  [[nodiscard]] static Expected<Indexer> Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                                std::optional<CategorySourceModel> categories = {},
                                                const WarningSink& warn = {});

  /// Whether Index deletes the results that the store has of the targets in a video, and searches it again.
  /// @param info        of the job's video
  /// @param content_id  of it (VideoReader::ContentId)
  /// Errors: kInvalidArgument if they were made with other parameters and the job's `redo` is kNever; those of the
  /// store.
  [[nodiscard]] Expected<bool> IsRedone(const IndexJob& job, const VideoInfo& info, const std::string& content_id,
                                        IndexStore& store) const;

  /// What is searched for, models before categories, as the store has it but for the ids.
  [[nodiscard]] std::span<const ModelRecord> targets() const { return targets_; }

  /// Indexes one video. Resumes where an earlier call stopped; in a video indexed before searches for new models only;
  /// stores nothing twice. Commits results and progress together every 2 s, so that a kill loses no more than that. At
  /// the end, finished or cancelled, updates the objects of the whole index (update_objects.h).
  /// The video is stored by its name as given, with the current folder if that is relative.
  /// Errors: those of VideoReader, IndexStore and of a telemetry file that was given; that of IsRedone, before anything
  /// is changed; kConflict if another process is indexing the same video; kCancelled, after what was done is stored. A
  /// cancelled live source, which cannot be resumed, ends normally, without an error. One indexer serves one index.
  [[nodiscard]] Expected<IndexReport> Index(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                            const WarningSink& warn = {}) const;

  /// Does the same with help of other processes. At first it prepares the video (telemetry, clock, the sun's direction)
  /// and cuts it into segments (video_cut.h); once all of these are searched, it joins their results. What is then in
  /// the index equals what Index writes, to the last bit. A video that is too short for two segments, or that cannot be
  /// cut, is indexed at once. Each call goes as far as it can.
  /// @param segment_s  length of a segment, s
  /// Errors: as Index.
  [[nodiscard]] Expected<SegmentedReport> IndexBySegments(const IndexJob& job, double segment_s,
                                                          const CancelToken& cancel, IndexStore& store,
                                                          SegmentStore& segments, const WarningSink& warn = {}) const;

  /// Searches one open segment, and stores its results in `segments` at its end. No effect on one that is done, or that
  /// is none of these models and parameters any more because the video was cut anew.
  /// Errors: as Index.
  [[nodiscard]] Expected<IndexReport> IndexSegment(const IndexJob& job, FrameInterval frames, const CancelToken& cancel,
                                                   IndexStore& store, SegmentStore& segments,
                                                   const WarningSink& warn = {}) const;

 private:
  struct OpenedVideo;
  struct PlannedPass;
  struct PlannedCut;

  // All steps before data association.
  [[nodiscard]] Expected<IndexReport> Search(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                             const WarningSink& warn) const;
  // Opens the video, reads its telemetry, and registers it in the store.
  [[nodiscard]] Expected<OpenedVideo> OpenVideo(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                                const WarningSink& warn) const;
  // Corrects the clock of the telemetry, unless its offset is given.
  [[nodiscard]] Status CorrectTelemetryOf(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                          const WarningSink& warn, OpenedVideo& video) const;
  // Groups the searches that are not finished by their first frame.
  [[nodiscard]] Expected<std::vector<PlannedPass>> PlanPasses(const IndexJob& job, const OpenedVideo& video,
                                                              const std::vector<ModelRecord>& models_before,
                                                              IndexStore& store, const WarningSink& warn) const;
  // The models that the plan searches for, in the order of its targets: those of the indexer if they are all, else
  // copies.
  [[nodiscard]] std::shared_ptr<const std::vector<ObjectModel>> SearchedModels(const PlannedPass& plan) const;
  [[nodiscard]] Expected<Recognizer> MakeRecognizer(const PlannedPass& plan, const IndexJob& job) const;
  // Database ids of the categories of the finder, for those that the plan searches for.
  [[nodiscard]] std::vector<std::optional<std::int64_t>> CategoryIds(const PlannedPass& plan) const;
  // The references outlive the pass.
  [[nodiscard]] FollowOptions MakeFollowOptions(const IndexJob& job, const OpenedVideo& video) const;
  [[nodiscard]] IndexPass MakePass(const PlannedPass& plan, const Recognizer& recognizer,
                                   std::span<const std::optional<std::int64_t>> category_ids, const IndexJob& job,
                                   OpenedVideo& video) const;
  // Null: the models are not searched for by their shape.
  [[nodiscard]] Expected<std::unique_ptr<const ShapeSearch>> MakeShapeSearch(const Recognizer& recognizer,
                                                                             const IndexJob& job,
                                                                             const CameraStates& cameras,
                                                                             const VideoInfo& info,
                                                                             const CancelToken& cancel) const;
  // Sets the sun of the report. The reader is then at its first frame.
  [[nodiscard]] Status EstimateSun(const Recognizer& recognizer, const IndexJob& job, OpenedVideo& video,
                                   const CancelToken& cancel, const WarningSink& warn, IndexReport& report) const;
  // The same for a short video without telemetry: by assumed attitudes, which the cameras then have for the search.
  [[nodiscard]] Status AssumeSun(const Recognizer& recognizer, const IndexJob& job, OpenedVideo& video,
                                 const CancelToken& cancel, const WarningSink& warn, IndexReport& report) const;
  // Updates the objects of the whole index, and passes on the warnings about the job's video.
  [[nodiscard]] Status UpdateObjectsOf(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                       const WarningSink& warn) const;
  [[nodiscard]] Status CheckNamesOf(const std::vector<ModelRecord>& models_before) const;
  // Estimates the sun's direction, and searches the video.
  [[nodiscard]] Status RunPass(const PlannedPass& plan, const IndexJob& job, OpenedVideo& video,
                               const CancelToken& cancel, IndexStore& store, const WarningSink& warn,
                               IndexReport& report) const;
  [[nodiscard]] VideoReaderOptions MakeReaderOptions(const IndexJob& job) const;

  // indexer_segments.cc
  [[nodiscard]] Expected<SegmentedReport> SearchBySegments(const IndexJob& job, double segment_s,
                                                           const CancelToken& cancel, IndexStore& store,
                                                           SegmentStore& segments, const WarningSink& warn) const;
  // The text that identifies a pass: VideoCut::plan.
  [[nodiscard]] Expected<std::string> CutPlan(const PlannedPass& pass, const SearchIntervals& intervals,
                                              const IndexJob& job) const;
  [[nodiscard]] Expected<std::optional<PlannedCut>> ReadCutPlan(const VideoRecord& video, const VideoCut& cut,
                                                                const IndexJob& job, IndexStore& store) const;
  [[nodiscard]] int MinInterval(const PlannedPass& pass, const SearchIntervals& intervals) const;
  // The cut of the job's video by this indexer, or one like it.
  // @param frames  of a segment: reads only what that needs; std::nullopt: all that was prepared
  [[nodiscard]] Expected<std::optional<PlannedCut>> FindCut(const IndexJob& job, std::optional<FrameInterval> frames,
                                                            IndexStore& store, SegmentStore& segments) const;
  [[nodiscard]] Expected<bool> IsFinished(const VideoRecord& video, IndexStore& store) const;
  // Returns the id of the cut; std::nullopt if the pass is not to be cut.
  [[nodiscard]] Expected<std::optional<std::int64_t>> CutPass(const PlannedPass& plan, const std::string& text,
                                                              const IndexJob& job, double segment_s, OpenedVideo& video,
                                                              const CancelToken& cancel, IndexStore& store,
                                                              SegmentStore& segments, const WarningSink& warn,
                                                              IndexReport& report) const;
  // Joins the segments up to the first open one; after the last one, the cut is finished.
  // Returns false if the video has another content than the cut: nothing is joined.
  [[nodiscard]] Expected<bool> JoinSegments(PlannedCut& found, const IndexJob& job, const CancelToken& cancel,
                                            IndexStore& store, SegmentStore& segments, IndexReport& report) const;

  Indexer(std::vector<ObjectModel> models, const IndexOptions& options,
          std::unique_ptr<const FeatureExtractor> extractor, std::unique_ptr<const FeatureExtractor> kept_extractor,
          std::shared_ptr<const CategorySource> categories);

  std::shared_ptr<const std::vector<ObjectModel>> models_;  // shared with the recognisers of all of them
  IndexOptions options_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::unique_ptr<const FeatureExtractor> kept_extractor_;  // of the features kept for search by example image
  std::shared_ptr<const CategorySource> categories_;        // null: none
  std::vector<ModelRecord> targets_;                        // models, then categories, as stored
};

}  // namespace victorious
