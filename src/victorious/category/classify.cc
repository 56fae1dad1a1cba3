#include "victorious/base/check.h"
#include "victorious/category/category_model.h"
#include "victorious/category/linear/linear_model.h"

namespace victorious {

QuantisedImage QuantiseFeatures(const CategoryModel& model, const FeatureSet& features) {
  const int words_per_keypoint = model.options.vocabulary.words_per_keypoint;
  if (const LinearModel* linear = model.linear(); linear != nullptr)
    return QuantiseForLinear(*linear, features, model.vocabulary, words_per_keypoint);
  return QuantiseFeatures(features, model.vocabulary, words_per_keypoint);
}

CategoryResult Classify(const CategoryModel& model, const QuantisedImage& image, CategoryMethod method) {
  VICTORIOUS_CHECK(!model.nodes.empty());
  const LinearModel* linear = model.linear();
  const std::vector<double> raw = linear != nullptr ? LinearScores(*linear, image, method)
                                                    : ThesisScores(std::get<ThesisModel>(model.classifier), model.nodes,
                                                                   model.options.thesis, image, method);
  CategoryResult result;
  double best = -1;
  for (std::size_t n = 0; n < raw.size(); ++n) {
    const CategoryNode& node = model.nodes[n];
    result.scores.push_back({raw[n], node.CalibrationFor(method).Probability(raw[n])});
    if (node.can_be_label && result.scores[n].probability > best) {
      best = result.scores[n].probability;
      result.label = n;
    }
  }
  return result;
}

}  // namespace victorious
