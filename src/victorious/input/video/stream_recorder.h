// Records a live source: its packets are copied as they come, video and data (telemetry), into files that each begin at
// a key frame. What is recorded does not depend on who else reads the source. Input: a live URL. Output: MPEG-TS files
// in a folder, named by the time of their first frame:
//
//   DIR/2026-05-27T13-14-22.911042Z.ts        complete; the oldest ones are removed first
//   DIR/2026-05-27T13-15-23.004512Z.ts.part   being written: completed by the next recorder if this one is killed
//   DIR/lock                                  held by the recorder
//
// The time is that at which a frame comes to this machine, by its clock: the frame that waited least before it was read
// tells the offset of the source's time stamps (LiveDelay, frame_loop.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"

namespace victorious {

struct RecordOptions {
  std::filesystem::path folder;  ///< created if it does not exist
  double segment_s = 60;         ///< length of a file: until the first key frame after it
  std::int64_t max_bytes = 0;    ///< of all files of the folder
  double timeout_s = 10;         ///< maximum wait for the source; then it is opened again
};

/// A complete file of a recording.
struct RecordedFile {
  std::filesystem::path path;
  std::int64_t start_utc_us = 0;  ///< microseconds since 1970, of the first frame
  std::int64_t bytes = 0;
};

/// The start of a complete file by its name; std::nullopt for any other name.
[[nodiscard]] std::optional<std::int64_t> RecordingStart(const std::filesystem::path& file);

/// The complete files of a folder, oldest first. Error: that of reading the folder.
[[nodiscard]] Expected<std::vector<RecordedFile>> ListRecordings(const std::filesystem::path& folder);

/// Records until `cancel` is set. A source that ends or sends nothing is opened again, for ever once it was read.
/// @param on_file  called with each file that is complete
/// Errors: those of VideoReader::Open for a source that was never read; kUnsupported for a file, or video that MPEG-TS
/// cannot hold; kConflict if another process records into the folder; those of writing, kNoSpace among them.
[[nodiscard]] Status RecordStream(const std::string& url, const RecordOptions& options, const CancelToken& cancel,
                                  const std::function<void(const RecordedFile&)>& on_file, const WarningSink& warn);

}  // namespace victorious
