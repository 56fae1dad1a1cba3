#include "victorious/category/category_options.h"

namespace victorious {

void CategoryOptions::ListFields(FieldList& fields) {
  fields.Add("scoring", scoring,
             {.choices = {"linear", "likelihood"},
              .reason = "linear: words and phrases are weighted so that categories come apart; likelihood: as the "
                        "thesis, pLSA for words and equation 3.3 for phrases"});
  fields.Add("seed", seed, {.reason = "of every random draw"});
  fields.Add("soft_words", soft_words,
             {.min = 1, .max = 8, .reason = "the nearest words that a keypoint counts for; the thesis: 1"});
  fields.Add("softness", softness,
             {.min = 1,
              .max = 1000,
              .reason = "how much farther than the nearest a word may be (as a distance of descriptors, whose length "
                        "is 512) and still get exp(-1/2) of its share"});
  fields.Add("lambda", lambda,
             {.min = 1e-6, .max = 1e6, .reason = "linear: penalty of large weights; the larger, the smoother"});
  fields.AddGroup("vocabulary", vocabulary);
  fields.AddGroup("phrases", phrases);
  fields.AddGroup("fisher", fisher);
  fields.AddGroup("shapes", shapes);
  fields.AddGroup("plsa", plsa);
  fields.AddGroup("grammar", grammar);
}

}  // namespace victorious
