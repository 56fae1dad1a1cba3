// The main job: video -> features -> recognition -> tracklets -> objects -> store.
//
// Frames are searched in parallel on all cores. Linking and storing are serial in frame order, so the result does not
// depend on the number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/sun.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/pipeline/warning_sink.h"
#include "victorious/recognize/relit_templates.h"
#include "victorious/store/index_store.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct IndexReport {
  std::int64_t frames_searched = 0;  ///< number of frames searched as a whole by this call
  std::int64_t sightings = 0;        ///< number found by this call
  bool stopped_live = false;         ///< true if a cancelled live source ends here
  std::optional<Sun> sun;            ///< sun direction, azimuth from north, if relit templates were used
};

/// One video to index, and how.
struct IndexJob {
  std::string video;                     ///< path or URL; also the name under which it is stored
  std::optional<std::string> telemetry;  ///< telemetry file; if not given, the video's own, or a file beside it
  bool redo = false;                     ///< drop the stored results of these models in this video, and search again
  int threads = 0;                       ///< 0: one per hardware thread
  /// Relit templates (MakeLitViews), one entry per model. The caller keeps them, to share them between jobs with the
  /// same models. If empty, they are made for this video and released after it.
  std::vector<std::shared_ptr<const RelitTemplateSource>> lit = {};
};

/// Searches videos, one at a time, for a set of models and categories, and stores what it finds.
class Indexer {
 public:
  /// @param categories  searched for in addition to the models; optional
  /// @param warn        receives warnings about the given ground
  /// Errors: kInvalidArgument for parameters out of range, a model of another feature engine, or a model and a category
  /// with the same name; those of CategoryFinder and of MakeGround.
  static Expected<Indexer> Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                  std::optional<CategoryModel> categories = {}, const WarningSink& warn = {});

  /// Indexes one video. Resumes where an earlier call stopped; in a video indexed before searches for new models only;
  /// stores nothing twice. Commits results and progress together every 2 s, so that a kill loses no more than that. At
  /// the end, finished or cancelled, recomputes the objects of the whole index (associate_objects.h).
  /// Errors: those of VideoReader, IndexStore, and of a telemetry file that was given; kInvalidArgument if the video
  /// was indexed with other parameters and `redo` is false; kCancelled, after what was done is stored. A cancelled live
  /// source, which cannot be resumed, ends normally, without an error.
  Expected<IndexReport> Index(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                              const WarningSink& warn = {}) const;

 private:
  Expected<IndexReport> Search(const IndexJob& job, const CancelToken& cancel, IndexStore& store,
                               const WarningSink& warn) const;

  Indexer(std::vector<ObjectModel> models, const IndexOptions& options,
          std::unique_ptr<const FeatureExtractor> extractor, std::optional<CategoryFinder> categories);

  std::vector<ObjectModel> models_;
  IndexOptions options_;
  std::unique_ptr<const FeatureExtractor> extractor_;
  std::optional<CategoryFinder> categories_;
  std::vector<ModelRecord> targets_;  // models, then categories, as stored
};

}  // namespace victorious
