#include "victorious/category/category_options.h"

namespace victorious {

void CategoryOptions::ListFields(FieldList& fields) {
  fields.Add("scoring", scoring, kCategoryScoringTexts,
             {.reason = "linear: regularised least-squares classifier on words and phrases; likelihood: the thesis's "
                        "method, pLSA for words and equation 3.3 for phrases"});
  fields.Add("seed", seed, {.reason = "seed of all random sampling"});
  fields.Add("words_per_keypoint", vocabulary.words_per_keypoint,
             {.min = 1, .max = 8, .reason = "nearest words that a keypoint is assigned to; thesis: 1"});
  fields.AddGroup("vocabulary", vocabulary);
  linear.ListFields(fields);
  thesis.ListFields(fields);
}

}  // namespace victorious
