#include "victorious/category/thesis/phrase_grammar.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "victorious/base/check.h"
#include "victorious/category/thesis/visit_pairs.h"
#include "victorious/geometry/pair_measures.h"

namespace victorious {
namespace {

// Range of a measure; values outside are clamped, angles wrap. Ratios are natural logarithms.
struct Grid {
  double low;
  double high;
  bool wraps;

  [[nodiscard]] double CellWidth() const { return (high - low) / kMeasureCells; }
};

constexpr double kPiD = std::numbers::pi;
constexpr std::array<Grid, kMeasures> kGrids = {Grid{-2.5, 2.5, false}, Grid{-5.5, 0.9, false}, Grid{-kPiD, kPiD, true},
                                                Grid{-kPiD, kPiD, true}};

std::uint8_t QuantiseMeasure(const Grid& grid, double value) {
  const double cell = std::floor((value - grid.low) / grid.CellWidth());
  if (grid.wraps) return static_cast<std::uint8_t>(static_cast<int>(cell) & (kMeasureCells - 1));
  return static_cast<std::uint8_t>(std::clamp(cell, 0.0, kMeasureCells - 1.0));
}

int CellDistance(std::size_t measure, std::uint8_t a, std::uint8_t b) {
  const int distance = std::abs(static_cast<int>(a) - static_cast<int>(b));
  return kGrids[measure].wraps ? std::min(distance, kMeasureCells - distance) : distance;
}

// Integral of min(1 / x^2, cap) from 0 to x.
double KernelIntegral(double x, double cap) {
  const double edge = 1 / std::sqrt(cap);
  const double size = std::abs(x);
  const double value = size <= edge ? cap * size : 2 * std::sqrt(cap) - 1 / size;
  return x < 0 ? -value : value;
}

std::uint32_t PairKey(std::uint16_t first, std::uint16_t second) {
  return (static_cast<std::uint32_t>(first) << 16) | second;
}

bool IsOrdered(std::uint16_t a, const Keypoint& i, std::uint16_t b, const Keypoint& j) {
  return std::tuple(a, -i.scale_px, i.x, i.y) <= std::tuple(b, -j.scale_px, j.x, j.y);
}

// Visits the ordered pairs within R whose words are both in the grammar. Returns the number of all pairs within R.
template <typename Visit>
std::size_t VisitWordPairs(const QuantisedImage& image,
                           const std::unordered_map<std::uint32_t, std::uint16_t>& index_of_word, double radius_px,
                           const Visit& visit) {
  constexpr std::uint16_t kNone = 0xFFFF;
  std::vector<std::uint16_t> index(image.size(), kNone);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const auto found = index_of_word.find(image.NearestWord(i));
    if (found != index_of_word.end()) index[i] = found->second;
  }
  std::size_t pairs = 0;
  VisitPairs(image.keypoints, radius_px, [&](std::uint32_t i, std::uint32_t j) {
    ++pairs;
    if (index[i] == kNone || index[j] == kNone) return;
    if (!IsOrdered(index[i], image.keypoints[i], index[j], image.keypoints[j])) std::swap(i, j);
    visit(i, j, index[i], index[j]);
  });
  return pairs;
}

}  // namespace

void GrammarOptions::ListFields(FieldList& fields) {
  fields.Add("radius_px", radius_px,
             {.min = 1, .max = 10000, .unit = "px", .reason = "R: maximum distance of a phrase"});
  fields.Add("kernel_cap", kernel_cap,
             {.min = 1, .max = 1e8, .reason = "maximum contribution of one sample to equation 3.1 (thesis: 10000)"});
  fields.Add("word_prior", word_prior,
             {.reason = "use the pLSA topic mixture of an image's words as the prior of its phrases"});
  fields.Add("likelihood_exponent", likelihood_exponent,
             {.min = 0,
              .max = 1,
              .reason = "exponent of the likelihood of equation 3.3; below 1 because pairs share keypoints and are "
                        "not independent of each other or of the words"});
}

double CellKernel(std::size_t measure, int cells, double cap) {
  const double width = kGrids[measure].CellWidth();
  return (KernelIntegral((cells + 0.5) * width, cap) - KernelIntegral((cells - 0.5) * width, cap)) / width;
}

MeasureCells QuantiseMeasures(const Keypoint& i, const Keypoint& j) {
  const PairMeasures measures = MeasurePair(i, j);
  return {QuantiseMeasure(kGrids[0], std::log(measures.scale_ratio)),
          QuantiseMeasure(kGrids[1], std::log(measures.mean_scale_to_distance)),
          QuantiseMeasure(kGrids[2], measures.orientation_difference_rad),
          QuantiseMeasure(kGrids[3], measures.mean_orientation_to_line_rad)};
}

PhraseGrammar::PhraseGrammar(std::vector<std::uint32_t> words, std::vector<float> likelihoods,
                             std::vector<PhraseSample> samples, const GrammarOptions& options)
    : words_(std::move(words)), likelihoods_(std::move(likelihoods)), samples_(std::move(samples)), options_(options) {
  VICTORIOUS_CHECK(words_.size() == likelihoods_.size() && words_.size() < 0xFFFF);
  for (std::size_t i = 0; i < words_.size(); ++i) index_of_word_[words_[i]] = static_cast<std::uint16_t>(i);
  BuildTables();
}

PhraseGrammar PhraseGrammar::Learn(std::span<const QuantisedImage* const> images,
                                   std::span<const float> word_likelihoods, const GrammarOptions& options) {
  std::vector<std::uint32_t> order(word_likelihoods.size());
  std::iota(order.begin(), order.end(), 0U);
  constexpr double kMaxWords = 0xFFFE;
  const auto count =
      static_cast<std::size_t>(std::clamp(std::round(options.word_fraction * static_cast<double>(order.size())), 1.0,
                                          std::min(kMaxWords, static_cast<double>(order.size()))));
  std::ranges::sort(order, {}, [&](std::uint32_t word) { return std::pair(-word_likelihoods[word], word); });
  order.resize(count);
  std::unordered_map<std::uint32_t, std::uint16_t> index_of_word;
  std::vector<float> likelihoods;
  for (std::size_t i = 0; i < count; ++i) {
    index_of_word[order[i]] = static_cast<std::uint16_t>(i);
    likelihoods.push_back(word_likelihoods[order[i]]);
  }
  std::vector<PhraseSample> samples;
  for (const QuantisedImage* image : images) {
    VisitWordPairs(*image, index_of_word, options.radius_px,
                   [&](std::uint32_t i, std::uint32_t j, std::uint16_t first, std::uint16_t second) {
                     samples.push_back({first, second, QuantiseMeasures(image->keypoints[i], image->keypoints[j])});
                   });
  }
  return {std::move(order), std::move(likelihoods), std::move(samples), options};
}

void PhraseGrammar::BuildTables() {
  for (std::size_t measure = 0; measure < kMeasures; ++measure) {
    kernels_[measure].resize(kMeasureCells);
    for (int cells = 0; cells < kMeasureCells; ++cells)
      kernels_[measure][static_cast<std::size_t>(cells)] =
          static_cast<float>(CellKernel(measure, cells, options_.kernel_cap));
  }
  std::ranges::stable_sort(samples_, {}, [](const PhraseSample& s) { return PairKey(s.first, s.second); });
  constexpr std::size_t kFewSamples = 16;  // a table takes the memory of 400 samples
  for (std::size_t first = 0; first < samples_.size();) {
    const std::uint32_t key = PairKey(samples_[first].first, samples_[first].second);
    std::size_t end = first;
    while (end < samples_.size() && PairKey(samples_[end].first, samples_[end].second) == key) ++end;
    Entry entry{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first), 0};
    if (end - first > kFewSamples) {
      std::vector<float> table;
      for (std::size_t measure = 0; measure < kMeasures; ++measure)
        for (int cell = 0; cell < kMeasureCells; ++cell)
          table.push_back(static_cast<float>(Density(entry, measure, static_cast<std::uint8_t>(cell))));
      tables_.insert(tables_.end(), table.begin(), table.end());
      entry.table = static_cast<std::uint32_t>(tables_.size() / table.size());
    }
    entries_[key] = entry;
    first = end;
  }
}

double PhraseGrammar::Density(const Entry& entry, std::size_t measure, std::uint8_t cell) const {
  if (entry.table > 0) return tables_[((entry.table - 1) * kMeasures + measure) * kMeasureCells + cell];
  double sum = 0;
  for (std::size_t s = entry.first_sample; s < entry.first_sample + entry.sample_count; ++s) {
    const int distance = CellDistance(measure, cell, samples_[s].cells[measure]);
    sum += kernels_[measure][static_cast<std::size_t>(distance)];
  }
  return sum / entry.sample_count;
}

double PhraseGrammar::PairLikelihood(std::uint16_t first, std::uint16_t second, const MeasureCells& cells) const {
  const auto entry = entries_.find(PairKey(first, second));
  if (entry == entries_.end()) return 0;
  double likelihood = static_cast<double>(likelihoods_[first]) * likelihoods_[second];
  for (std::size_t measure = 0; measure < kMeasures; ++measure)
    likelihood *= Density(entry->second, measure, cells[measure]);
  return likelihood;
}

double PhraseGrammar::Likelihood(const QuantisedImage& image) const {
  double sum = 0;
  const std::size_t pairs =
      VisitWordPairs(image, index_of_word_, options_.radius_px,
                     [&](std::uint32_t i, std::uint32_t j, std::uint16_t first, std::uint16_t second) {
                       sum += PairLikelihood(first, second, QuantiseMeasures(image.keypoints[i], image.keypoints[j]));
                     });
  return pairs > 0 ? sum / static_cast<double>(pairs) : 0.0;
}

std::vector<FoundPhrase> PhraseGrammar::Phrases(const QuantisedImage& image) const {
  std::vector<FoundPhrase> found;
  VisitWordPairs(image, index_of_word_, options_.radius_px,
                 [&](std::uint32_t i, std::uint32_t j, std::uint16_t first, std::uint16_t second) {
                   const double likelihood =
                       PairLikelihood(first, second, QuantiseMeasures(image.keypoints[i], image.keypoints[j]));
                   if (likelihood > 0) found.push_back({i, j, likelihood});
                 });
  return found;
}

}  // namespace victorious
