// The file of an imported detector: the network as it came, its classes, and how it is used. Written by `category
// import`; a category model like those of `category train` to everything that searches for categories.
// docs/formats/detector.md describes the format.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/network/detector_settings.h"
#include "victorious/category/network/network_request.h"

namespace victorious {

/// The largest file of a network that is read: 512 MiB.
inline constexpr std::size_t kMaxNetworkBytes = std::size_t{1} << 29;

struct DetectorModel {
  std::string program_version;       ///< that imported it
  std::string source;                ///< name of the network's file
  std::string trained_on;            ///< what a person says of it; may be empty
  std::vector<std::string> classes;  ///< in the order of the network's outputs
  DetectorSettings settings;
  NetworkFiles files;
};

/// Error: kInvalidArgument for a name that a class cannot have: an empty one, one with control characters or with more
/// than 100 bytes.
[[nodiscard]] Status CheckClassName(std::string_view name);

/// One name a line; empty lines at the end are left out. Errors: kInvalidArgument for no names, too many, an empty one,
/// one that comes twice, and one with control characters or more than 100 bytes.
[[nodiscard]] Expected<std::vector<std::string>> ParseClassList(std::string_view text,
                                                                const std::string& name_for_errors);

/// The names in a file. Errors: those of ParseClassList and of ReadFile.
[[nodiscard]] Expected<std::vector<std::string>> ReadClassList(const std::string& path);

/// True if the bytes start as those of a detector's file.
[[nodiscard]] bool IsDetectorFile(std::span<const std::byte> bytes);

[[nodiscard]] std::vector<std::byte> EncodeDetector(const DetectorModel& model);

/// Writes the file atomically: on an error, `path` is unchanged.
[[nodiscard]] Status WriteDetector(const std::filesystem::path& path, const DetectorModel& model);

/// Errors: kNotFound; kDataLoss (not a detector, damaged or truncated); kUnsupported (another version of the format).
[[nodiscard]] Expected<DetectorModel> ReadDetector(const std::filesystem::path& path);

/// Reads only inside `bytes`, and allocates memory in proportion to their number. The network is not looked at.
[[nodiscard]] Expected<DetectorModel> ParseDetector(std::span<const std::byte> bytes,
                                                    const std::string& name_for_errors);

}  // namespace victorious
