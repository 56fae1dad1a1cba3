// Scoring "likelihood", the thesis's method: pLSA learns one topic per category; the method kWords scores an image by
// its topic mixture, the method kPhrases by equation 3.3. A node's raw score is the log ratio of the likelihood of its
// topics to that of all others. With grammar.word_prior, the topic mixture is the prior of the phrases: the score of
// phrases is that of words plus grammar.likelihood_exponent times that of equation 3.3.
#pragma once

#include <span>

#include "victorious/category/category_model.h"

namespace victorious {

/// Learns topics and grammars with the model's vocabulary, and calibrates by five-fold cross-validation over images.
/// Each fold learns its own vocabulary, because words that were learned from an image overfit it.
void LearnLikelihoods(std::span<const CategoryExample> examples, CategoryModel& model);

/// Returns the raw score of each node (natural logarithm).
std::vector<double> LikelihoodScores(const CategoryModel& model, const QuantisedImage& picture, CategoryMethod method);

}  // namespace victorious
