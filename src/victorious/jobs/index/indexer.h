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
#include <utility>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_job.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/index/index_setup.h"
#include "victorious/store/index_store.h"
#include "victorious/store/segment_store.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Searches videos, one at a time, for a set of models and categories, and stores what it finds.
class Indexer {
 public:
  /// @param categories  searched for in addition to the models; optional
  /// @param warn        receives warnings about the given ground, and if the models are of another feature engine than
  ///                    options.features: the models' engine is used
  /// Errors: kInvalidArgument for parameters out of range, models of different feature engines, or a model and a
  /// category with the same name; those of MakeCategorySource and of MakeGround.
  [[nodiscard]] static Expected<Indexer> Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                                std::optional<CategorySourceInput> categories = {},
                                                const WarningSink& warn = {});

  /// Whether Index deletes the results that the store has of the targets in a video, and searches it again.
  /// @param info        of the job's video
  /// @param content_id  of it (VideoReader::ContentId)
  /// Errors: kInvalidArgument if they were made with other parameters and the job's `redo` is kNever; those of the
  /// store.
  [[nodiscard]] Expected<bool> IsRedone(const IndexJob& job, const VideoInfo& info, const std::string& content_id,
                                        IndexStore& store) const;

  /// What is searched for, models before categories, as the store has it but for the ids.
  [[nodiscard]] std::span<const ModelRecord> targets() const { return setup_->targets; }

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

  /// Searches one open segment, and stores its results in `segments` at its end. Does nothing if the segment is
  /// finished, or if the video has since been cut with other models or parameters.
  /// Errors: as Index.
  [[nodiscard]] Expected<IndexReport> IndexSegment(const IndexJob& job, FrameInterval frames, const CancelToken& cancel,
                                                   IndexStore& store, SegmentStore& segments,
                                                   const WarningSink& warn = {}) const;

 private:
  explicit Indexer(std::unique_ptr<const IndexSetup> setup) : setup_(std::move(setup)) {}

  std::unique_ptr<const IndexSetup> setup_;
};

}  // namespace victorious
