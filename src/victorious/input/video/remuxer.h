// Private to video/: copies the H.264 packets of a file into an MP4 file, without decoding them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

/// Returns the number of frames; std::nullopt, without a file, if the packets cannot simply be copied: another codec,
/// not 8 bits 4:2:0, interlaced, rotated or non-square pixels, a packet without sound time stamps, a beginning that is
/// no key frame, or nothing that FFmpeg can demultiplex. Reads the file twice. Errors: those of writing; kDataLoss if
/// the second reading gives other packets; kCancelled.
[[nodiscard]] Expected<std::optional<std::int64_t>> Remux(const std::string& source, const std::filesystem::path& path,
                                                          const CancelToken& cancel);

}  // namespace victorious
