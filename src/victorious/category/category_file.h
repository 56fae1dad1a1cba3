// A category model on disk: one file, versioned, checksummed, bounded. docs/formats/category.md describes every byte.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/category_model.h"

namespace victorious {

std::vector<std::byte> EncodeCategories(const CategoryModel& model);

/// Whole or not at all.
Status WriteCategories(const std::filesystem::path& path, const CategoryModel& model);

/// Errors: kNotFound; kDataLoss (not a category model, damaged, cut off); kUnsupported (a newer version).
Expected<CategoryModel> ReadCategories(const std::filesystem::path& path);

/// The same from bytes in memory. Never reads outside `bytes`, and takes memory in proportion to them, whatever they
/// hold.
Expected<CategoryModel> ParseCategories(std::span<const std::byte> bytes, const std::string& name_for_errors);

}  // namespace victorious
