// Scoring "likelihood", the thesis's: a topic a category, learned by pLSA; words are scored by a picture's topic
// shares, phrases by equation 3.3. A node's raw score is the logarithm of how much likelier its topics are than the
// others. With grammar.word_prior, a picture's topic shares are the prior of its phrases: the score of phrases is that
// of words, plus grammar.power times that of equation 3.3.
#pragma once

#include <span>

#include "victorious/category/category_model.h"

namespace victorious {

/// Learns topics and grammars with the model's vocabulary, and calibrates on pictures held out in five parts. Each part
/// has a vocabulary of its own: words that were learned from a picture fit it too well.
void LearnLikelihoods(std::span<const CategoryExample> examples, CategoryModel& model);

/// The raw score of each node.
std::vector<double> LikelihoodScores(const CategoryModel& model, const WordedPicture& picture, CategoryMethod method);

}  // namespace victorious
