// Reads selected frames of a video without keeping the others in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/types/frame.h"

namespace victorious {

/// Returns evenly spaced frame numbers, rising: the middle frame of each of N equal parts of the video. Numbers are
/// unique, so that fewer than N are returned for a short video.
/// @param frames  length of the video
[[nodiscard]] std::vector<std::int64_t> EvenlySpaced(std::int64_t frames, int max_count);

/// Counts the frames by decoding all of them, because containers only estimate the number.
/// Errors: kDataLoss if no frame can be decoded, and those of VideoReader.
[[nodiscard]] Expected<std::int64_t> CountFrames(const std::filesystem::path& video);

/// Reads the frames of these numbers, which must rise; numbers beyond the end are left out. Errors: those of
/// VideoReader.
[[nodiscard]] Expected<std::vector<Frame>> ReadNumberedFrames(const std::filesystem::path& video,
                                                              std::span<const std::int64_t> numbers, FrameColor color);

}  // namespace victorious
