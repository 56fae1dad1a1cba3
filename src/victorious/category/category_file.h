// Serialisation of a CategoryModel: a single file with a version number, a checksum and bounded allocations. Written
// by `category train` and read by classification. docs/formats/category.md describes the format byte by byte.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/category_model.h"

namespace victorious {

/// True if the bytes start as those of a category model's file.
[[nodiscard]] bool IsCategoryModelFile(std::span<const std::byte> bytes);

/// Returns the bytes of the file: header and payload.
std::vector<std::byte> EncodeCategoryModel(const CategoryModel& model);

/// Writes the file atomically: on an error, `path` is unchanged. Errors: those of WriteFileAtomically (base/file.h).
[[nodiscard]] Status WriteCategoryModel(const std::filesystem::path& path, const CategoryModel& model);

/// Reads a model. Errors: kNotFound; kDataLoss (not a category model, damaged or truncated); kUnsupported (written by a
/// newer or older version of the format).
[[nodiscard]] Expected<CategoryModel> ReadCategoryModel(const std::filesystem::path& path);

/// Parses a model from memory. Reads only inside `bytes` and allocates memory proportional to their number, also for
/// hostile input.
/// @param name_for_errors  prefix of error messages, e.g. the file's path
[[nodiscard]] Expected<CategoryModel> ParseCategoryModel(std::span<const std::byte> bytes,
                                                         const std::string& name_for_errors);

}  // namespace victorious
