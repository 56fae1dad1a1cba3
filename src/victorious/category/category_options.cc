#include "victorious/category/category_options.h"

namespace victorious {

void CategoryOptions::ListFields(FieldList& fields) {
  fields.Add("scoring", scoring,
             {.choices = {"linear", "likelihood"},
              .reason = "linear: regularised least-squares classifier on words and phrases; likelihood: the thesis's "
                        "method, pLSA for words and equation 3.3 for phrases"});
  fields.Add("seed", seed, {.reason = "seed of all random sampling"});
  fields.Add("words_per_keypoint", words_per_keypoint,
             {.min = 1, .max = 8, .reason = "nearest words that a keypoint is assigned to; thesis: 1"});
  fields.Add("assignment_sigma", assignment_sigma,
             {.min = 1,
              .max = 1000,
              .reason = "sigma of the soft assignment, in descriptor distance (descriptors have length 512): a word "
                        "farther than the nearest by sigma has exp(-1/2) of its weight"});
  fields.Add("lambda", lambda,
             {.min = 1e-6, .max = 1e6, .reason = "linear: regularisation of the weights; larger is smoother"});
  fields.AddGroup("vocabulary", vocabulary);
  fields.AddGroup("phrases", phrases);
  fields.AddGroup("fisher", fisher);
  fields.AddGroup("shapes", shapes);
  fields.AddGroup("plsa", plsa);
  fields.AddGroup("grammar", grammar);
}

}  // namespace victorious
