// pipeline/, the main job: video -> features -> recognize -> objects -> store. A frame's way through the program, in
// the order the data flows. Frames are searched on all cores; what they gave is linked and stored in their order, so
// that the result does not depend on the number of threads.
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
#include "victorious/store/index_store.h"
#include "victorious/types/lit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct IndexReport {
  std::int64_t frames_searched = 0;  ///< in this run
  std::int64_t sightings = 0;        ///< found in this run
  bool stopped_live = false;         ///< that end is where a live source was cancelled
  std::optional<Sun> sun;            ///< where it stands, azimuth from north, if objects were sought as it lights them
};

/// One video to be indexed, and how.
struct IndexJob {
  std::string video;                     ///< a path or URL, also the name under which it is stored
  std::optional<std::string> telemetry;  ///< a file; unless given, the video's own, or what lies beside it
  bool redo = false;                     ///< forget what was found of what is sought in it, and search again
  int threads = 0;                       ///< 0: as many as the machine has
  /// One a model (MakeLitViews): what is made of them stays with the caller, for other jobs with the same models.
  /// Empty: made anew for this video, and forgotten after it.
  std::vector<std::shared_ptr<const LitTemplates>> lit = {};
};

/// Searches videos for a set of models and of categories, and keeps what it finds. One video at a time.
class Indexer {
 public:
  /// @param categories  sought beside the models
  /// @param warn        of the ground that the options tell
  /// Errors: parameters out of range; a model of another feature engine, or of a category's name; those of
  /// CategoryFinder and of MakeGround.
  static Expected<Indexer> Create(std::vector<ObjectModel> models, const IndexOptions& options,
                                  std::optional<CategoryModel> categories = {}, const WarningSink& warn = {});

  /// Goes on where an earlier run stopped, searches new models alone in what was indexed before, and doubles nothing.
  /// Progress is stored every few seconds together with what was found, so that a kill loses no more than that.
  /// At its end, done or stopped, the objects of the whole index are made anew (object_list.h).
  /// Errors: those of VideoReader, IndexStore, and a telemetry file that was named; kInvalidArgument if the video was
  /// indexed with other parameters and redo is not asked for; kCancelled, after what was done is stored. A live source,
  /// which cannot be gone on with, ends where it is cancelled: no error.
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
  std::vector<ModelRecord> sought_;  // what the store is to know: the models, then the categories
};

}  // namespace victorious
