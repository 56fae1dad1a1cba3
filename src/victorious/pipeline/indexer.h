// The main job: video -> features -> recognition -> tracklets -> objects -> store.
//
// Frames are searched in parallel on all cores. Linking and storing are serial in frame order, so the result does not
// depend on the number of threads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/pipeline/index_job.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/recognize/category_finder.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/store/index_store.h"
#include "victorious/types/object_model.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// Searches videos, one at a time, for a set of models and categories, and stores what it finds.
class Indexer {
 public:
  /// @param categories  searched for in addition to the models; optional
  /// @param warn        receives warnings about the given ground, and if the models are of another feature engine than
  ///                    options.features: the models' engine is used
  /// Errors: kInvalidArgument for parameters out of range, models of different feature engines, or a model and a
  /// category with the same name; those of CategoryFinder and of MakeGround.
  [[nodiscard]] static Expected<Indexer> Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                                std::optional<CategoryModel> categories = {},
                                                const WarningSink& warn = {});

  /// Indexes one video. Resumes where an earlier call stopped; in a video indexed before searches for new models only;
  /// stores nothing twice. Commits results and progress together every 2 s, so that a kill loses no more than that. At
  /// the end, finished or cancelled, updates the objects of the whole index (update_objects.h).
  /// The video is stored by its name as given, with the current folder if that is relative.
  /// Errors: those of VideoReader, IndexStore, and of a telemetry file that was given; kInvalidArgument if the video
  /// was indexed with other parameters and `redo` is false; kConflict if another process is indexing the same video;
  /// kCancelled, after what was done is stored. A cancelled live source, which cannot be resumed, ends normally,
  /// without an error. One indexer serves one index.
  [[nodiscard]] Expected<IndexReport> Index(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                            const WarningSink& warn = {}) const;

 private:
  struct OpenedVideo;
  struct PlannedPass;

  // All steps before data association.
  [[nodiscard]] Expected<IndexReport> Search(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                             const WarningSink& warn) const;
  // Opens the video, reads its telemetry, and registers it in the store.
  [[nodiscard]] Expected<OpenedVideo> OpenVideo(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                                const WarningSink& warn) const;
  // Corrects the clock of the telemetry, unless its offset is given.
  [[nodiscard]] Status CorrectClockOf(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                                      const WarningSink& warn, OpenedVideo& video) const;
  // Groups the searches that are not finished by their first frame.
  [[nodiscard]] Expected<std::vector<PlannedPass>> PlanPasses(const IndexJob& job, const OpenedVideo& video,
                                                              const std::vector<ModelRecord>& models_before,
                                                              IndexStore& store, const WarningSink& warn) const;
  [[nodiscard]] Expected<Recognizer> MakeRecognizer(const PlannedPass& plan, const IndexJob& job) const;
  // Estimates the sun's direction, and searches the video.
  [[nodiscard]] Status RunPass(const PlannedPass& plan, const IndexJob& job, OpenedVideo& video,
                               const CancelToken& cancel, IndexStore& store, const WarningSink& warn,
                               IndexReport& report) const;
  [[nodiscard]] VideoReaderOptions MakeReaderOptions(const IndexJob& job) const;

  Indexer(std::vector<ObjectModel> models, const IndexOptions& options,
          std::unique_ptr<const FeatureExtractor> extractor, std::unique_ptr<const FeatureExtractor> kept_extractor,
          std::optional<CategoryFinder> categories);

  std::vector<ObjectModel> models_;
  IndexOptions options_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::unique_ptr<const FeatureExtractor> kept_extractor_;  // of the features kept for search by example image
  std::optional<CategoryFinder> categories_;
  std::vector<ModelRecord> targets_;  // models, then categories, as stored
};

}  // namespace victorious
