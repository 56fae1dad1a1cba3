// One video to be indexed, one segment of it, or a live source, as a task of the queue.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/apps/cluster/content_file.h"
#include "victorious/base/error.h"
#include "victorious/store/postgres/task_queue.h"
#include "victorious/store/segment_store.h"
#include "victorious/store/work_state.h"
#include "victorious/types/index_records.h"

namespace victorious {

inline constexpr std::string_view kIndexTaskKind = "index";
inline constexpr std::string_view kSegmentTaskKind = "segment";
inline constexpr std::string_view kLiveTaskKind = "live";

/// A part of a video that is cut (store/segment_store.h).
struct SegmentPart {
  std::int64_t cut = 0;  ///< VideoCut::id
  FrameInterval frames;
};

struct IndexTask {
  std::string video;                 ///< absolute path, the same on all machines; or the address of a live source
  std::vector<std::string> options;  ///< of `victorious index`, but for --db: "--models", "/data/models", …
  std::string program;               ///< ProgramId() of the program that submitted it: others may find other things
  /// The content ids of the models and categories by name (ModelRecord): a worker that finds others fails. Empty: of an
  /// older version, which did not say.
  std::map<std::string, std::string> targets = {};
  /// Identifies the content of the video (VideoReader::ContentId): a worker that finds another fails. Empty: likewise.
  std::string content_id = {};
  /// Those of the video, with its telemetry, and of the options, where they were published (content_file.h): a worker
  /// that does not have them can fetch them.
  std::vector<ContentFile> files = {};
  double segment_s = 0;  ///< length of the segments into which the video is cut; 0: it is not cut
  std::optional<SegmentPart> part = std::nullopt;  ///< only this segment
  /// The live source of which the video is a recording (victorious index --covers); empty: none.
  std::string covers = {};
  bool is_live = false;  ///< a live source: it has no end, no content and no segments
  /// Results that were made with other parameters are deleted, and the video is searched again (Redo::kIfDifferent).
  bool redo_other = false;
  /// Under which a worker does it; not in the payload, nor is what follows.
  std::optional<TaskAttempt> attempt = std::nullopt;
  /// The worker has the files below this folder, at their paths (TaskFiles::root); empty: at their paths.
  std::string root = {};
};

/// The targets of a task as JSON, as `victorious index --targets` reads them.
[[nodiscard]] std::string TargetsText(const std::map<std::string, std::string>& targets);

/// Compares what a task is to be searched for with what a worker has. Error: kInvalidArgument if they differ, or for a
/// text that TargetsText did not write.
[[nodiscard]] Status CheckTargets(std::string_view targets_text, std::span<const ModelRecord> present);

/// The task for the queue.
/// @param content  identifies the content of the video, the models and the categories: what was submitted with the same
///                 content and options is one task
/// Error: kInvalidArgument for a text that a task cannot hold: not UTF-8, or with a zero byte.
[[nodiscard]] Expected<postgres::NewTask> ToQueue(const IndexTask& task, const std::string& content,
                                                  postgres::TaskPriority priority);

/// The task of each open segment of a cut video.
/// @param video  the task of the video; the key of that in the queue is `key`
[[nodiscard]] std::vector<postgres::NewTask> PartsOf(const IndexTask& video, const std::string& key,
                                                     const VideoCut& cut);

/// Safe for any bytes. Error: kInvalidArgument, in one line, for a task of another kind, or a payload that is not
/// valid.
[[nodiscard]] Expected<IndexTask> FromQueue(std::string_view kind, std::string_view payload);

}  // namespace victorious
