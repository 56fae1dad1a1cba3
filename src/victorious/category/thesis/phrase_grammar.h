// The thesis's bag of phrases (section 3.4): the likelihood of an image's word pairs, each with its four geometric
// measures, under the distributions of a category's training images.
//
//   P(g(w1, w2) = a | z) ~ 1/n sum over i of min(1 / (a - a_i)^2, 10000)                (3.1)
//   P(w1, w2 | z) = P(w1|z) P(w2|z) product over the four measures g of P(g = a_g | z)    (3.2)
//   P(d | z) = sum over pairs within R whose words are both in W(z) of P(w1, w2 | z)      (3.3)
//
// Equation 3.1 sums over every training sample. Here each measure is quantised to a grid of kMeasureCells cells: ratios
// are taken in logarithms, angles wrap, and the kernel is averaged over a cell. Word pairs with many samples keep the
// sums as a table, so that the cost of a pair does not depend on the number of samples. A pair is ordered by word; two
// equal words are ordered by decreasing scale. The sum of equation 3.3 grows with the image, so it is divided by the
// number of keypoint pairs within R, irrespective of their words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/category/common/quantised_image.h"

namespace victorious {

inline constexpr int kMeasureCells = 128;
inline constexpr std::size_t kMeasures = 4;

struct GrammarOptions {
  double word_fraction = 0.05;  ///< W(z): fraction of the vocabulary, the words of highest P(w|z): 150 of the thesis's
                                ///< 3000. Not a user parameter: table3.6 and tests vary it
  double radius_px = 50.0;
  double kernel_cap = 10000.0;
  bool word_prior = false;
  double likelihood_exponent = 1.0;

  void ListFields(FieldList& fields);
};

/// Quantised measures of a pair, as cell indices: log of the scale ratio, log of scale to distance, theta_a (difference
/// of the orientations), theta_b (mean orientation relative to the connecting line).
using MeasureCells = std::array<std::uint8_t, kMeasures>;

/// One word pair of a training image.
struct PhraseSample {
  std::uint16_t first = 0;   ///< index into the grammar's words
  std::uint16_t second = 0;  ///< index into the grammar's words
  MeasureCells cells{};
};

/// A phrase found in an image.
struct FoundPhrase {
  std::uint32_t i = 0;    ///< index of the first keypoint
  std::uint32_t j = 0;    ///< index of the second keypoint
  double likelihood = 0;  ///< P(w1, w2 | z)
};

class PhraseGrammar {
 public:
  PhraseGrammar() = default;
  /// @param words        W(z), distinct, at most 65535
  /// @param likelihoods  P(w|z) for each word
  /// @param samples      indices refer to `words`
  PhraseGrammar(std::vector<std::uint32_t> words, std::vector<float> likelihoods, std::vector<PhraseSample> samples,
                const GrammarOptions& options);

  /// Learns a grammar. W(z) is the fraction `options.word_fraction` of the vocabulary with the highest P(w|z).
  /// @param word_likelihoods  P(w|z) for each word of the vocabulary
  static PhraseGrammar Learn(std::span<const QuantisedImage* const> images, std::span<const float> word_likelihoods,
                             const GrammarOptions& options);

  /// Equation 3.3 divided by the number of pairs within R; 0 for an image without pairs.
  [[nodiscard]] double Likelihood(const QuantisedImage& image) const;

  /// Returns the non-zero terms of equation 3.3.
  [[nodiscard]] std::vector<FoundPhrase> Phrases(const QuantisedImage& image) const;

  [[nodiscard]] std::span<const std::uint32_t> words() const { return words_; }
  [[nodiscard]] std::span<const float> likelihoods() const { return likelihoods_; }
  [[nodiscard]] std::span<const PhraseSample> samples() const { return samples_; }

 private:
  struct Entry {
    std::uint32_t first_sample = 0;
    std::uint32_t sample_count = 0;
    std::uint32_t table = 0;  // 1 + index of the table; 0: no table, summed from the samples
  };

  void BuildTables();
  [[nodiscard]] double PairLikelihood(std::uint16_t first, std::uint16_t second, const MeasureCells& cells) const;
  [[nodiscard]] double Density(const Entry& entry, std::size_t measure, std::uint8_t cell) const;

  std::vector<std::uint32_t> words_;
  std::vector<float> likelihoods_;
  std::vector<PhraseSample> samples_;  // sorted by PairKey
  GrammarOptions options_;
  std::unordered_map<std::uint32_t, std::uint16_t> index_of_word_;
  std::unordered_map<std::uint32_t, Entry> entries_;  // by PairKey
  std::vector<float> tables_;
  std::array<std::vector<float>, kMeasures> kernels_;  // per measure, by the distance in cells
};

/// Computes and quantises the measures of the pair (i, j).
MeasureCells QuantiseMeasures(const Keypoint& i, const Keypoint& j);

/// The kernel of equation 3.1 averaged over the cell at a distance of `cells` cells, on the grid of `measure`.
/// @param cap  upper limit of the kernel (10000 in the thesis)
double CellKernel(std::size_t measure, int cells, double cap);

}  // namespace victorious
