// The thesis's bag-of-phrases (section 3.4): how likely the pairs of words of a picture are, each with its four
// geometric measures, under the distributions that a category's training pictures showed.
//
//   P(g(w1, w2) = a | z) ~ 1/n sum over i of min(1 / (a - a_i)^2, 10000)                (3.1)
//   P(w1, w2 | z) = P(w1|z) P(w2|z) product over the four measures g of P(g = a_g | z)    (3.2)
//   P(d | z) = sum over pairs within R whose words are both in W(z) of P(w1, w2 | z)      (3.3)
//
// Equation 3.1 sums over every training sample; here each measure is a grid of cells. Ratios are taken in logarithms,
// angles wrap, and the kernel is averaged over a cell. Samples in one cell are merged; of a pair of words with many
// samples the sums are kept as a table, so that a pair costs the same however much was learned. The order of a pair is
// that of its words, and of equal words the larger scale first. Equation 3.3 grows with the picture: it is divided by
// the number of pairs within R, whatever their words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/category/worded_picture.h"

namespace victorious {

inline constexpr int kMeasureCells = 128;
inline constexpr std::size_t kMeasures = 4;

struct GrammarOptions {
  double word_share = 0.05;
  double radius_px = 50.0;
  double kernel_cap = 10000.0;
  bool word_prior = false;
  double power = 1.0;

  void ListFields(FieldList& fields);
};

/// A pair's four measures, each as the cell of its grid: log of the scale ratio, log of scale to distance, theta_a,
/// theta_b.
using MeasureCells = std::array<std::uint8_t, kMeasures>;

/// One pair of a training picture.
struct PhraseSample {
  std::uint16_t first = 0;  ///< index into the grammar's words
  std::uint16_t second = 0;
  MeasureCells cells{};
};

/// A phrase that a picture holds: two keypoints, and P(w1, w2 | z).
struct FoundPhrase {
  std::uint32_t i = 0;
  std::uint32_t j = 0;
  double likelihood = 0;
};

class PhraseGrammar {
 public:
  PhraseGrammar() = default;
  /// @param words        W(z), distinct, at most 65535
  /// @param likelihoods  P(w|z) of each of them
  /// @param samples      with indices into `words`
  PhraseGrammar(std::vector<std::uint32_t> words, std::vector<float> likelihoods, std::vector<PhraseSample> samples,
                const GrammarOptions& options);

  /// W(z): the share `options.word_share` of the words with the highest P(w|z).
  static PhraseGrammar Learn(std::span<const WordedPicture* const> pictures, std::span<const float> word_likelihoods,
                             const GrammarOptions& options);

  /// Equation 3.3, divided by the number of pairs within R; 0 for a picture without pairs.
  [[nodiscard]] double Likelihood(const WordedPicture& picture) const;

  /// The addends of equation 3.3 that are not 0.
  [[nodiscard]] std::vector<FoundPhrase> Phrases(const WordedPicture& picture) const;

  [[nodiscard]] std::span<const std::uint32_t> words() const { return words_; }
  [[nodiscard]] std::span<const float> likelihoods() const { return likelihoods_; }
  [[nodiscard]] std::span<const PhraseSample> samples() const { return samples_; }

 private:
  struct Entry {
    std::uint32_t first_sample = 0;
    std::uint32_t sample_count = 0;
    std::uint32_t table = 0;  // 1 + its number; 0: summed from the samples
  };

  void BuildTables();
  [[nodiscard]] double PairLikelihood(std::uint16_t first, std::uint16_t second, const MeasureCells& cells) const;
  [[nodiscard]] double Density(const Entry& entry, std::size_t measure, std::uint8_t cell) const;

  std::vector<std::uint32_t> words_;
  std::vector<float> likelihoods_;
  std::vector<PhraseSample> samples_;  // sorted by pair
  GrammarOptions options_;
  std::unordered_map<std::uint32_t, std::uint16_t> index_of_word_;
  std::unordered_map<std::uint32_t, Entry> entries_;  // by pair
  std::vector<float> tables_;
  std::array<std::vector<float>, kMeasures> kernels_;  // by distance in cells
};

/// The measures of the pair (i, j) on their grids.
MeasureCells CellsOf(const Keypoint& i, const Keypoint& j);

/// Equation 3.1's kernel, averaged over the cell that is `cells` away, of the grid of a measure.
double CellKernel(std::size_t measure, int cells, double cap);

}  // namespace victorious
