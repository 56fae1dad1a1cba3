// Scoring "likelihood", the thesis's: a topic a category, learned by pLSA; words are scored by a picture's topic
// shares, phrases by equation 3.3. A node's raw score is the logarithm of how much likelier its topics are than the
// others.
#pragma once

#include <span>

#include "victorious/category/category_model.h"

namespace victorious {

/// Learns topics and grammars, and calibrates on pictures held out in five parts.
void LearnLikelihoods(std::span<const CategoryExample> examples, std::span<const WordedPicture> pictures,
                      CategoryModel& model);

/// The raw score of each node.
std::vector<double> LikelihoodScores(const CategoryModel& model, const WordedPicture& picture, CategoryMethod method);

}  // namespace victorious
