// Reads and writes model files: one file per model, versioned, checksummed, memory-mapped. docs/formats/model.md
// describes every byte.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Returns the bytes of a model file. Error: kInvalidArgument for a model that could not be read back (no view, a
/// keypoint that is not finite, …).
[[nodiscard]] Expected<std::vector<std::byte>> EncodeModel(const ObjectModel& model);

/// Writes the model atomically (ObjectModel::id is ignored: it is a checksum of the written content).
[[nodiscard]] Status WriteModelFile(const std::filesystem::path& path, const ObjectModel& model);

/// Maps the file and validates all of it (checksums, bounds, counts). The model's name is the one stored in the file.
/// Errors: kNotFound; kDataLoss (not a model, damaged, cut off); kUnsupported (a newer version, or
/// an older one whose models must be made again).
[[nodiscard]] Expected<ObjectModel> ReadModelFile(const std::filesystem::path& path);

/// The same for bytes in memory that `storage` keeps alive. Never reads outside `bytes`, for any content.
[[nodiscard]] Expected<ObjectModel> ParseModel(std::span<const std::byte> bytes, std::shared_ptr<const void> storage,
                                               const std::string& name_for_errors);

}  // namespace victorious
