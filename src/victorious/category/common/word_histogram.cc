#include "victorious/category/common/word_histogram.h"

namespace victorious {

double Dot(const SparseVector& a, const SparseVector& b) {
  double sum = 0;
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end()) {
    if (i->first == j->first) {
      sum += static_cast<double>(i->second) * j->second;
      ++i;
      ++j;
    } else if (i->first < j->first) {
      ++i;
    } else {
      ++j;
    }
  }
  return sum;
}

SparseVector CountWords(const QuantisedImage& image, std::size_t words) {
  std::vector<float> counts(words);
  for (const WordAssignment& weight : image.assignments) counts[weight.word] += weight.weight;
  SparseVector sparse;
  for (std::uint32_t word = 0; word < words; ++word)
    if (counts[word] > 0) sparse.emplace_back(word, counts[word]);
  return sparse;
}

}  // namespace victorious
