// The thesis's classifier: pLSA learns one topic per category; the method kWords scores an image by its topic mixture,
// the method kPhrases by equation 3.3. A node's raw score is the log ratio of the likelihood of its topics to that of
// all others. With grammar.word_prior, the topic mixture is the prior of the phrases: the score of phrases is that of
// words plus grammar.likelihood_exponent times that of equation 3.3. Source: thesis, sections 2.1.2, 3.4 and 3.6.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/category/common/category_node.h"
#include "victorious/category/common/quantised_image.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/thesis/phrase_grammar.h"
#include "victorious/category/thesis/plsa.h"

namespace victorious {

struct ThesisOptions {
  PlsaOptions plsa;
  GrammarOptions grammar;

  void ListFields(FieldList& fields);
};

struct ThesisModel {
  std::vector<std::uint32_t> topic_nodes;  ///< node index of each topic
  TopicModel topics;
  std::vector<PhraseGrammar> grammars;  ///< one per topic
};

struct ThesisFit {
  ThesisModel model;
  std::vector<CategoryNode> nodes;  ///< with their calibrations
};

/// Learns topics and grammars, and calibrates by five-fold cross-validation over images. Each fold learns its own
/// vocabulary, because words that were learned from an image overfit it.
/// @param examples    at least one with features
/// @param nodes       their calibrations are ignored
/// @param vocabulary  learned from the examples
/// @param words       the options that it was learned with
ThesisFit TrainThesis(std::span<const CategoryExample> examples, std::vector<CategoryNode> nodes,
                      const Vocabulary& vocabulary, const VocabularyOptions& words, const ThesisOptions& options,
                      std::uint64_t seed);

/// Returns the raw score of each node (natural logarithm).
/// @param image  quantised with the vocabulary that the model was trained with
std::vector<double> ThesisScores(const ThesisModel& model, std::span<const CategoryNode> nodes,
                                 const ThesisOptions& options, const QuantisedImage& image, CategoryMethod method);

}  // namespace victorious
