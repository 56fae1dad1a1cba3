// Private to telemetry/: the texts of subtitles with their times: SubRip (.srt), also without times, and Advanced
// SubStation Alpha (.ass).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

struct Cue {
  std::optional<double> start_s;
  std::string text;
};

/// Whether the text is of the format ASS.
[[nodiscard]] bool IsAss(std::string_view text);

[[nodiscard]] std::vector<Cue> SplitCues(std::string_view text);

/// Whether the text ends within its last cue: there it has the form of the cue before, but only the beginning of it.
[[nodiscard]] bool IsLastCueCut(std::span<const Cue> cues, std::string_view text);

/// The text with line ends for the "\\N" of ASS.
[[nodiscard]] std::string WithLineBreaks(std::string_view text);

/// The first line of a text that is a date and time, as microseconds UTC. In "11:51,393,525" thousandths and millionths
/// follow the seconds; the latter are ignored.
[[nodiscard]] std::optional<std::int64_t> FindUtc(std::string_view text);

}  // namespace victorious
