// What a model of the search is: made from photos, made from a CAD file, or a category.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "victorious/base/enum_text.h"

namespace victorious {

enum class ModelKind {
  kPhotos,    ///< an object model made from photos
  kCad,       ///< an object model made from a CAD file
  kCategory,  ///< a category of a category model; never the kind of an ObjectModel
};

/// The texts in model files, in the index and in the output of the program.
inline constexpr auto kModelKindTexts = std::to_array<EnumText<ModelKind>>(
    {{ModelKind::kPhotos, "photos"}, {ModelKind::kCad, "cad"}, {ModelKind::kCategory, "category"}});

constexpr std::string_view ToText(ModelKind kind) { return ToText(kModelKindTexts, kind); }

}  // namespace victorious
