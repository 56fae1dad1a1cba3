// What this program tells the process that started it: one JSON object a line on the descriptor of `--events`
// (docs/formats/events.md). The writer and the only parser of these lines are here: a parent (child_task.h) reads
// values, never messages for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "victorious/base/error.h"

namespace victorious {

/// How far a step of the work is.
struct ProgressEvent {
  std::string label;  ///< the item being processed, e.g. a file name
  std::int64_t done = 0;
  std::optional<std::int64_t> total;  ///< std::nullopt: not known
  std::string unit;                   ///< of both, in the plural: "frames"
  double elapsed_s = 0;               ///< since the step began
  /// Of a live source: how long after its arrival the last unit was done, against the unit that waited least before it
  /// was read.
  std::optional<double> behind_s = {};

  bool operator==(const ProgressEvent&) const = default;
};

struct InfoEvent {
  std::string message;  ///< one line, as in the log

  bool operator==(const InfoEvent&) const = default;
};

struct WarningEvent {
  std::string message;  ///< one line, as in the log

  bool operator==(const WarningEvent&) const = default;
};

/// Why the program ends without success; its exit status follows.
struct ErrorEvent {
  Error error;

  bool operator==(const ErrorEvent&) const = default;
};

/// `victorious index` left a video out because another process indexes it at this moment.
struct VideoLeftEvent {
  std::string video;

  bool operator==(const VideoLeftEvent&) const = default;
};

/// `victorious index --cut` ends before the video is indexed: its segments are to be searched first.
struct VideoCutEvent {
  std::string video;
  std::int64_t cut = 0;  ///< VideoCut::id

  bool operator==(const VideoCutEvent&) const = default;
};

using ProgramEvent = std::variant<ProgressEvent, InfoEvent, WarningEvent, ErrorEvent, VideoLeftEvent, VideoCutEvent>;

/// No line is longer: the writer cuts texts to kMaxEventTextBytes.
inline constexpr std::size_t kMaxEventBytes = std::size_t{1} << 20;
inline constexpr std::size_t kMaxEventTextBytes = std::size_t{1} << 16;

/// Returns the line of an event, without its end. Control characters of its texts become '?', bytes that are not UTF-8
/// U+FFFD.
[[nodiscard]] std::string FormatEvent(const ProgramEvent& event);

/// Safe for any bytes. Error: kInvalidArgument for a line that FormatEvent does not write, with what is wrong. Members
/// that it does not know are ignored.
[[nodiscard]] Expected<ProgramEvent> ParseEvent(std::string_view line);

/// From now on the events of this process go to `descriptor`, which programs that it starts do not inherit. Error:
/// kInvalidArgument for one that is not open for writing.
[[nodiscard]] Status OpenEventOutput(int descriptor);

[[nodiscard]] bool HasEventOutput();

/// Writes the event, if OpenEventOutput was called. A reader that went away does not stop the work. Thread-safe.
void ReportEvent(const ProgramEvent& event);

}  // namespace victorious
