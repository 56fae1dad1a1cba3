// The presentation times of all frames of a video, without decoding it where the container gives them. Input: a source
// as for VideoReader. Output: the time_s that VideoReader gives each frame, by frame index. A viewer looks frames and
// times up in this table: frame rates vary, so a frame is not at index / rate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

/// Returns strictly increasing times, s; the first is 0. Reads the packets of the file once and sorts their time stamps
/// (edit lists are obeyed). Decodes the whole video instead if stamps are missing or damaged, or if their number is not
/// `frame_count`.
/// @param frame_count  delivered by a VideoReader, if known
/// Errors: those of VideoReader::Open; kCancelled.
[[nodiscard]] Expected<std::vector<double>> ReadFrameTimes(const std::string& source,
                                                           std::optional<std::int64_t> frame_count,
                                                           const CancelToken& cancel);

/// The frames of a video as its container lists them.
struct FrameTable {
  std::vector<double> times_s;      ///< of all frames, strictly increasing; the first is 0
  std::vector<double> key_times_s;  ///< of those from which a decoder can start
};

/// Reads the packets of the file once, as ReadFrameTimes; std::nullopt if they do not tell the times of all frames, and
/// for what is no file. Errors: kCancelled.
[[nodiscard]] Expected<std::optional<FrameTable>> ReadFrameTable(const std::string& source, const CancelToken& cancel);

}  // namespace victorious
