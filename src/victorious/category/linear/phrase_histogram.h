// Input of the linear classifier: histograms of an image's visual words and of its phrases.
//
// A phrase is a pair of words with a quantised relative geometry: the thesis's bag of phrases, used as counts. To make
// counts repeatable between images, similar words share a word cluster, and the four pair measures are quantised
// coarsely: the two keypoints have the same scale level (scale ratio), are near or far in units of that scale (scale to
// distance), lie in one of four directions relative to their mean orientation (theta_b), and have similar orientations
// (theta_a). Histograms are compared by the Hellinger kernel, i.e. the square roots of counts with L2 normalisation: it
// damps bursts of one word within an image and cancels the image's size.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/category/common/word_histogram.h"

namespace victorious {

/// Distances of the two keypoints of a phrase, in cells of their descriptors (kDenseMinCell_px at the smallest scale).
/// Nearer patches overlap by more than half (a patch has 4 cells), so that a pair repeats one word; farther pairs vary
/// with the background. Chosen by area under ROC on Caltech-101; the trial is not recorded.
inline constexpr double kMinPhraseDistance_cells = 1.5;
inline constexpr double kFarPhraseDistance_cells = 2.75;  ///< from here on a pair counts as far, not near
inline constexpr double kMaxPhraseDistance_cells = 4.0;   ///< R in the thesis

struct PhraseOptions {
  int word_clusters = 128;
  double weight = 2.5;

  void ListFields(FieldList& fields);
};

/// Maps counts to Hellinger features: square roots, normalised to unit L2 norm.
SparseVector Hellinger(SparseVector counts);

/// An occurrence of a phrase in an image.
struct PhraseOccurrence {
  std::uint32_t i = 0;       ///< index of the first keypoint
  std::uint32_t j = 0;       ///< index of the second keypoint
  std::uint32_t phrase = 0;  ///< below PhraseCount
};

inline constexpr std::size_t kPhraseGeometryBins =
    8;  ///< geometry bins per pair of clusters: 4 directions x {near, far}

/// Number of distinct phrases: word_clusters^2 x kPhraseGeometryBins.
std::size_t PhraseCount(std::size_t word_clusters);

/// Finds all phrases of an image. A keypoint's cluster is that of its nearest word.
/// @param cluster_of_word  cluster index of each word, below the number of clusters
/// Cost: linear in the number of keypoint pairs of one scale level within kMaxPhraseDistance_cells of each other.
std::vector<PhraseOccurrence> FindPhrases(const QuantisedImage& image, std::span<const std::uint16_t> cluster_of_word,
                                          std::size_t word_clusters);

/// Histogram of phrases; counts saturate at 65535.
SparseVector CountPhrases(std::span<const PhraseOccurrence> phrases, std::size_t word_clusters);

}  // namespace victorious
