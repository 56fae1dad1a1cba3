// Options of category training (`victorious params category`). `--params thesis` sets the thesis's features and method.
#pragma once

#include <array>
#include <cstdint>

#include "victorious/base/enum_text.h"
#include "victorious/base/options.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/linear/linear_model.h"
#include "victorious/category/thesis/thesis_model.h"

namespace victorious {

/// The classifier to train: the shipped one (linear/) or that of the thesis (thesis/).
enum class CategoryScoring { kLinear, kLikelihood };

inline constexpr auto kCategoryScoringTexts = std::to_array<EnumText<CategoryScoring>>(
    {{CategoryScoring::kLinear, "linear"}, {CategoryScoring::kLikelihood, "likelihood"}});

struct CategoryOptions {
  CategoryScoring scoring = CategoryScoring::kLinear;
  std::uint64_t seed = 1;
  VocabularyOptions vocabulary;
  LinearOptions linear;
  ThesisOptions thesis;

  void ListFields(FieldList& fields);
};

}  // namespace victorious
