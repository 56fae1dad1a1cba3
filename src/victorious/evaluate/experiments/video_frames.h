// A few frames of a video, spread over its length, without the others in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/frame.h"
#include "victorious/video/video_reader.h"

namespace victorious {

/// The numbers of the frames in the middle of `most` equal parts of so many frames, rising; each once, so that fewer
/// come where there are fewer frames.
[[nodiscard]] std::vector<std::int64_t> SpreadOver(std::int64_t frames, int most);

/// How many frames can be decoded, by decoding them: containers only estimate it.
/// Errors: kDataLoss for none, and those of VideoReader.
Expected<std::int64_t> CountFrames(const std::filesystem::path& video);

/// The frames of these numbers, which rise; those beyond the end are left out. Errors: those of VideoReader.
Expected<std::vector<Frame>> ReadFrames(const std::filesystem::path& video, std::span<const std::int64_t> numbers,
                                        FrameColor color);

}  // namespace victorious
