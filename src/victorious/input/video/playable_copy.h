// A copy of a video that browsers play: MP4 with H.264, whose frames are those of the source at the same times. Input:
// a source as for VideoReader. Output: a file for a viewer, which looks frames up by the table of the source
// (frame_times.h).
//
// H.264 of 8 bits in another container (MPEG-TS, MKV, …) is remuxed: its packets are copied, with their time stamps.
// Anything else (MPEG-1 and MPEG-2, H.265, packets without time stamps, rotated or non-square pixels, …) is decoded and
// encoded again: upright, with square pixels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

struct PlayableCopy {
  bool is_remuxed = false;  ///< false: encoded again
  std::int64_t frames = 0;
};

/// Writes the copy and shows progress in frames. Times differ by at most half a tick of the copy, 1/180000 s. A side of
/// an odd number of pixels is scaled to the next even one, as H.264 needs it. Writes to a temporary file; `path` is
/// created or replaced only at the end.
/// @param path  ends in .mp4
/// Errors: those of VideoReader::Open and VideoWriter; kUnsupported for a live source; kCancelled.
[[nodiscard]] Expected<PlayableCopy> WritePlayableCopy(const std::string& source, const std::filesystem::path& path,
                                                       const CancelToken& cancel);

}  // namespace victorious
