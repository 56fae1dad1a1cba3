#include "victorious/category/explanation.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <variant>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

std::vector<PhraseContribution> ContributionsTo(const LinearModel& model, const QuantisedImage& image,
                                                std::span<const CategoryNode> /*nodes*/, std::size_t node) {
  const auto phrases = FindPhrases(image, model.cluster_of_word, model.word_clusters);
  const SparseVector counts = CountPhrases(phrases, model.word_clusters);
  const SparseVector values = Hellinger(counts);
  std::vector<float> each(PhraseCount(model.word_clusters));  // contribution of one occurrence of each phrase
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const auto [phrase, value] = values[k];
    each[phrase] = model.phrase_weights[node].phrases(phrase) * value / counts[k].second;
  }
  std::vector<PhraseContribution> contributions;
  for (const PhraseOccurrence& phrase : phrases)
    if (each[phrase.phrase] != 0) contributions.push_back({phrase.i, phrase.j, each[phrase.phrase]});
  return contributions;
}

std::vector<PhraseContribution> ContributionsTo(const ThesisModel& model, const QuantisedImage& image,
                                                std::span<const CategoryNode> nodes, std::size_t node) {
  std::vector<PhraseContribution> contributions;
  double sum = 0;
  for (std::size_t z = 0; z < model.topic_nodes.size(); ++z) {
    if (!IsWithin(nodes[model.topic_nodes[z]].name, nodes[node].name)) continue;
    for (const FoundPhrase& phrase : model.grammars[z].Phrases(image)) {
      contributions.push_back({phrase.i, phrase.j, phrase.likelihood});
      sum += phrase.likelihood;
    }
  }
  for (PhraseContribution& one : contributions) one.weight /= sum;
  return contributions;
}

constexpr int kCellsAcross = 32;  // of the grid, along the longer side

// Contributions summed per grid cell of the image, minus the mean over cells.
cv::Mat_<double> ContributionGrid(const std::vector<PhraseContribution>& contributions, const QuantisedImage& image,
                                  double cell_px) {
  cv::Mat_<double> grid(std::max(1, static_cast<int>(std::ceil(image.height / cell_px))),
                        std::max(1, static_cast<int>(std::ceil(image.width / cell_px))), 0.0);
  const auto add = [&](const Keypoint& keypoint, double weight) {
    const int row = std::clamp(static_cast<int>(keypoint.y / cell_px), 0, grid.rows - 1);
    const int column = std::clamp(static_cast<int>(keypoint.x / cell_px), 0, grid.cols - 1);
    grid(row, column) += weight;
  };
  for (const PhraseContribution& one : contributions) {
    add(image.keypoints[one.i], one.weight / 2);
    add(image.keypoints[one.j], one.weight / 2);
  }
  grid -= cv::mean(grid)[0];
  return grid;
}

// The rectangle of cells with the maximum sum: Kadane's algorithm over the columns for each pair of rows.
cv::Rect BestRectangle(const cv::Mat_<double>& grid) {
  cv::Rect best(0, 0, grid.cols, grid.rows);
  double best_sum = 0;
  for (int top = 0; top < grid.rows; ++top) {
    std::vector<double> column_sums(static_cast<std::size_t>(grid.cols), 0.0);
    for (int bottom = top; bottom < grid.rows; ++bottom) {
      double run = 0;
      int left = 0;
      for (int column = 0; column < grid.cols; ++column) {
        double& sum = column_sums[static_cast<std::size_t>(column)];
        sum += grid(bottom, column);
        if (run <= 0) {
          run = 0;
          left = column;
        }
        run += sum;
        constexpr double kRounding = 1e-9;
        if (run > best_sum + kRounding) {
          best_sum = run;
          best = {left, top, column - left + 1, bottom - top + 1};
        }
      }
    }
  }
  return best;
}

}  // namespace

std::vector<PhraseContribution> ComputeContributions(const CategoryModel& model, const QuantisedImage& image,
                                                     std::size_t node) {
  VICTORIOUS_CHECK(node < model.nodes.size());
  auto contributions = std::visit(
      [&](const auto& classifier) { return ContributionsTo(classifier, image, model.nodes, node); }, model.classifier);
  std::ranges::stable_sort(contributions, std::ranges::greater(), &PhraseContribution::weight);
  return contributions;
}

Box SupportingBox(const std::vector<PhraseContribution>& contributions, const QuantisedImage& image) {
  const double cell_px = std::max(1.0, std::max(image.width, image.height) / static_cast<double>(kCellsAcross));
  const cv::Rect cells = BestRectangle(ContributionGrid(contributions, image, cell_px));
  const Box box{cells.x * cell_px, cells.y * cell_px, cells.width * cell_px, cells.height * cell_px};
  return Intersection(box, FrameBox(image.width, image.height));
}

cv::Mat DrawContributions(const cv::Mat& bgr, const QuantisedImage& image,
                          const std::vector<PhraseContribution>& contributions, const std::string& caption) {
  constexpr double kDim = 0.55;
  constexpr std::size_t kDrawn = 150;
  constexpr int kMinWidthPx = 480;  // smaller images are enlarged to keep lines distinguishable
  const double zoom = std::max(1.0, static_cast<double>(kMinWidthPx) / std::max(1, bgr.cols));
  cv::Mat canvas;
  cv::resize(bgr, canvas, {}, zoom, zoom, cv::INTER_LINEAR);
  canvas *= kDim;
  const auto place = [&](const Keypoint& keypoint) { return cv::Point2f(keypoint.x, keypoint.y) * zoom; };
  // In order of increasing weight, so that the strongest are on top.
  const std::size_t count = std::min(kDrawn, contributions.size());
  for (std::size_t k = count; k-- > 0;) {
    if (contributions[k].weight <= 0) continue;
    const double strength = contributions[k].weight / contributions.front().weight;
    const cv::Scalar colour(0, 100 + 155 * strength, 255 * strength);
    const cv::Point2f a = place(image.keypoints[contributions[k].i]);
    const cv::Point2f b = place(image.keypoints[contributions[k].j]);
    cv::line(canvas, a, b, colour, 1, cv::LINE_AA);
    cv::circle(canvas, a, 2, colour, cv::FILLED, cv::LINE_AA);
    cv::circle(canvas, b, 2, colour, cv::FILLED, cv::LINE_AA);
  }
  const Box box = SupportingBox(contributions, image);
  cv::rectangle(canvas, cv::Rect2d(box.x * zoom, box.y * zoom, box.width * zoom, box.height * zoom), {255, 255, 0}, 2);
  constexpr int kCaptionPx = 26;
  cv::Mat framed;
  cv::copyMakeBorder(canvas, framed, 0, kCaptionPx, 0, 0, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  cv::putText(framed, caption, {6, framed.rows - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(0), 1, cv::LINE_AA);
  return framed;
}

}  // namespace victorious
