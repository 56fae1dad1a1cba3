// One video on its way into an index, by one process: Open, Plan, Begin, then SearchPass for each pass of the plan.
// Only Begin and SearchPass write to the store. segmented_run.h does the same with help of other processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_job.h"
#include "victorious/jobs/index/index_pass.h"
#include "victorious/jobs/index/index_setup.h"
#include "victorious/jobs/index/stored_parameters.h"
#include "victorious/place/cameras/camera_states.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/recognize/recognizer.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// A video that was opened for indexing.
struct OpenedVideo {
  std::unique_ptr<VideoReader> reader;  ///< null after a pass that read it
  CameraStates cameras;
  VideoRecord record;  ///< without an id before IndexRun::Begin
  SearchIntervals intervals;
  FollowOptions follow;
  bool is_redone = false;  ///< its results are deleted by IndexRun::Begin
};

/// The searches of one pass over the video.
struct PlannedPass {
  std::vector<std::size_t> targets;    ///< indices into those of the setup, ascending
  std::vector<SearchRecord> searches;  ///< one per target, all with the same next_frame
};

/// Whether results of the targets in a video, which the store has, are deleted, and the video is searched again.
/// Errors: kInvalidArgument if they were made with other parameters and the job's `redo` is kNever; those of the store.
[[nodiscard]] Expected<bool> IsRedone(const IndexSetup& setup, const IndexJob& job, const VideoInfo& info,
                                      const std::string& content_id, IndexStore& store);

/// The reader's content id; shows a progress bar for large files.
[[nodiscard]] Expected<std::string> ContentIdOf(const VideoReader& reader, const std::string& video,
                                                const CancelToken& cancel);

class IndexRun {
 public:
  /// The references outlive it.
  /// @param warn  not empty
  IndexRun(const IndexSetup& setup, const IndexJob& job, const CancelToken& cancel, IndexStore& store,
           const WarningSink& warn);

  /// Opens the video and reads its telemetry.
  /// Errors: those of VideoReader, of a telemetry file that was given, of the store and of IsRedone; kInvalidArgument
  /// for a name that the index has of another kind of target; kDataLoss for another content than the job's.
  [[nodiscard]] Status Open();

  /// The searches of the opened video that are not finished, grouped by their first frame. Corrects the telemetry's
  /// clock if there are any.
  [[nodiscard]] Expected<std::vector<PlannedPass>> Plan();

  /// Enters the video, deletes what is redone or is of another content, and gives the searches their ids.
  [[nodiscard]] Status Begin(std::vector<PlannedPass>& plan);

  /// Estimates the sun's direction, searches the video, and commits what it finds.
  [[nodiscard]] Status SearchPass(const PlannedPass& plan);

  /// Open, Plan, Begin, and all passes.
  [[nodiscard]] Expected<IndexReport> Search();

  // The parts of SearchPass.
  [[nodiscard]] Expected<Recognizer> MakeRecognizer(const PlannedPass& plan) const;
  /// The models that the plan searches for, in the order of its targets.
  [[nodiscard]] std::shared_ptr<const std::vector<ObjectModel>> SearchedModels(const PlannedPass& plan) const;
  /// Database ids of the categories of the source; std::nullopt for those that the plan does not search for.
  [[nodiscard]] std::vector<std::optional<std::int64_t>> CategoryIds(const PlannedPass& plan) const;
  /// The references outlive the pass.
  [[nodiscard]] IndexPass MakePass(const PlannedPass& plan, const Recognizer& recognizer,
                                   std::span<const std::optional<std::int64_t>> category_ids, OpenedVideo& video) const;
  /// Null: the models are not searched for by their shape.
  [[nodiscard]] Expected<std::unique_ptr<const ShapeSearch>> MakeShapeSearch(const Recognizer& recognizer,
                                                                             const CameraStates& cameras,
                                                                             const VideoInfo& info) const;
  /// Sets the sun of the report. The reader is then at its first frame.
  [[nodiscard]] Status EstimateSun(const Recognizer& recognizer);
  /// Opens the video again, if a pass has read it.
  [[nodiscard]] Status Reopen();
  [[nodiscard]] VideoReaderOptions ReaderOptions() const;
  [[nodiscard]] FollowOptions FollowOptionsFor(int tracked, bool is_live) const;

  [[nodiscard]] const IndexSetup& setup() const { return setup_; }
  [[nodiscard]] const IndexJob& job() const { return job_; }
  [[nodiscard]] const CancelToken& cancel() const { return cancel_; }
  [[nodiscard]] IndexStore& store() const { return store_; }
  [[nodiscard]] const WarningSink& warn() const { return warn_; }
  [[nodiscard]] OpenedVideo& video() { return video_; }
  [[nodiscard]] IndexReport& report() { return report_; }

 private:
  // Corrects the clock of the telemetry, unless its offset is given.
  [[nodiscard]] Status CorrectClock();
  [[nodiscard]] Status DeleteListedBefore();
  // For a short video without telemetry: by assumed attitudes, which the cameras then have for the search.
  [[nodiscard]] Status AssumeSun(const Recognizer& recognizer);

  const IndexSetup& setup_;
  const IndexJob& job_;
  const CancelToken& cancel_;
  IndexStore& store_;
  const WarningSink& warn_;
  OpenedVideo video_;
  std::vector<ModelRecord> models_before_;  // of the store, when the video was opened
  StoredParameters parameters_;             // of the searches of the plan
  IndexReport report_;
};

}  // namespace victorious
