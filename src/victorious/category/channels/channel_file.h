// The file of a detector by channels, written by `category train` with the method `channels`: a version number, a
// checksum, bounded allocations. docs/formats/channels.md describes the format.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/channels/channel_detector.h"

namespace victorious {

inline constexpr std::size_t kMaxChannelCategories = 1000;

/// True if the bytes start as those of a detector by channels.
[[nodiscard]] bool IsChannelModelFile(std::span<const std::byte> bytes);

[[nodiscard]] std::vector<std::byte> EncodeChannelModel(const ChannelModel& model);

/// Writes the file atomically: on an error, `path` is unchanged.
[[nodiscard]] Status WriteChannelModel(const std::filesystem::path& path, const ChannelModel& model);

/// Errors: kNotFound; kDataLoss (not such a detector, damaged or truncated); kUnsupported (another version).
[[nodiscard]] Expected<ChannelModel> ReadChannelModel(const std::filesystem::path& path);

/// Reads only inside `bytes`, and allocates memory in proportion to their number. What it returns can search images.
[[nodiscard]] Expected<ChannelModel> ParseChannelModel(std::span<const std::byte> bytes,
                                                       const std::string& name_for_errors);

}  // namespace victorious
