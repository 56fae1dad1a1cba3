// A model without its features, as the JSON text that stands in a model file.
#pragma once

#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// `model` must pass ValidateMetadata. Bytes of a text that are not UTF-8 become U+FFFD.
std::string EncodeMetadata(const ObjectModel& model);

/// The model without id, features and storage. Errors: kDataLoss, whatever the text is; without the file's name.
Expected<ObjectModel> ParseMetadata(std::string_view json);

/// Everything about a model but its features: texts, sizes, finite numbers, and views whose features follow each other
/// from 0 up to `feature_count`. kInvalidArgument with the first fault.
Status ValidateMetadata(const ObjectModel& model, std::size_t feature_count);

}  // namespace victorious
