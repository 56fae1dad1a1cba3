// Options of category training (`victorious params category`). The thesis's method is `scoring` "likelihood" with the
// thesis's features; docs/results.md contains these parameters as a file.
#pragma once

#include <cstdint>
#include <string>

#include "victorious/base/options.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/linear/fisher.h"
#include "victorious/category/linear/histogram.h"
#include "victorious/category/linear/shape.h"
#include "victorious/category/thesis/phrase_grammar.h"
#include "victorious/category/thesis/plsa.h"

namespace victorious {

struct CategoryOptions {
  std::string scoring = "linear";
  std::uint64_t seed = 1;
  int words_per_keypoint = 4;
  double assignment_sigma = 50.0;
  double lambda = 0.1;
  VocabularyOptions vocabulary;
  PhraseOptions phrases;
  FisherOptions fisher;
  ShapeOptions shapes;
  PlsaOptions plsa;
  GrammarOptions grammar;

  void ListFields(FieldList& fields);
};

}  // namespace victorious
