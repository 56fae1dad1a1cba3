// The metadata section of a model file: a model without its features, as JSON.
#pragma once

#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Returns the JSON text. `model` must pass ValidateMetadata. Bytes that are not UTF-8 become U+FFFD.
std::string EncodeMetadata(const ObjectModel& model);

/// Returns the model without id, features and storage. Error: kDataLoss for any invalid text; the message does not name
/// the file.
[[nodiscard]] Expected<ObjectModel> ParseMetadata(std::string_view json);

/// Validates everything of a model except its features: texts, sizes, finite numbers, and views whose feature ranges
/// are contiguous from 0 to `feature_count`. Error: kInvalidArgument with the first fault.
[[nodiscard]] Status ValidateMetadata(const ObjectModel& model, std::size_t feature_count);

}  // namespace victorious
