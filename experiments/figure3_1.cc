// Figure 3.1: an image and a shuffle of its tiles. Test images are cut into tiles and shuffled. The keypoints move with
// their tiles, so that the bag of words is unchanged and only the spatial arrangement differs.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "victorious/base/random.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

constexpr int kTilesAcross = 6;
constexpr int kTilesDown = 4;
constexpr int kTiles = kTilesAcross * kTilesDown;

// Returns the destination of each tile; no tile stays in place.
std::array<int, kTiles> Shuffle(Random& random) {
  std::array<int, kTiles> order{};
  std::iota(order.begin(), order.end(), 0);
  // Sattolo's algorithm: a single cycle through all tiles.
  for (std::uint32_t i = kTiles - 1; i > 0; --i) std::swap(order[i], order[random.Below(i)]);
  return order;
}

struct Tiling {
  double width_px;
  double height_px;

  explicit Tiling(cv::Size size)
      : width_px(size.width / static_cast<double>(kTilesAcross)),
        height_px(size.height / static_cast<double>(kTilesDown)) {}
  [[nodiscard]] int TileAt(double x, double y) const {
    const int column = std::clamp(static_cast<int>(x / width_px), 0, kTilesAcross - 1);
    const int row = std::clamp(static_cast<int>(y / height_px), 0, kTilesDown - 1);
    return row * kTilesAcross + column;
  }
  [[nodiscard]] cv::Point2d Corner(int tile) const {
    return {tile % kTilesAcross * width_px, tile / kTilesAcross * height_px};
  }
};

FeatureSet ShuffleKeypoints(const FeatureSet& image, const std::array<int, kTiles>& order) {
  const Tiling tiling({image.image_width, image.image_height});
  FeatureSet shuffled = image;
  for (Keypoint& keypoint : shuffled.keypoints) {
    const int tile = tiling.TileAt(keypoint.x, keypoint.y);
    const cv::Point2d shift = tiling.Corner(order[static_cast<std::size_t>(tile)]) - tiling.Corner(tile);
    keypoint.x += static_cast<float>(shift.x);
    keypoint.y += static_cast<float>(shift.y);
  }
  return shuffled;
}

cv::Mat ShufflePixels(const cv::Mat& image, const std::array<int, kTiles>& order) {
  const Tiling tiling(image.size());
  cv::Mat shuffled = image.clone();
  const cv::Size size(static_cast<int>(tiling.width_px), static_cast<int>(tiling.height_px));
  for (int tile = 0; tile < kTiles; ++tile) {
    const cv::Rect from(cv::Point(tiling.Corner(tile)), size);
    const cv::Rect to(cv::Point(tiling.Corner(order[static_cast<std::size_t>(tile)])), size);
    image(from).copyTo(shuffled(to));
  }
  return shuffled;
}

struct ShuffleResults {
  std::vector<double> phrases_fall;
  std::vector<double> words_unchanged;
  std::vector<double> phrase_drop;
};

Status MeasureInto(ShuffleResults& results, const CaltechFeatures& features, const CategoryOptions& options,
                   std::uint64_t seed) {
  const Split split = MakeRandomSplit(features.rows(), seed);
  CategoryOptions seeded = options;
  seeded.seed = seed;
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryModel model, TrainCategories(features.ExamplesOf(split.train), seeded));
  Random random(seed);
  double falls = 0;
  double unchanged = 0;
  double drop = 0;
  for (const std::size_t row : split.test) {
    const std::string& category = features.rows()[row].category;
    const auto node =
        static_cast<std::size_t>(std::ranges::find(model.nodes, category, &CategoryNode::name) - model.nodes.begin());
    const QuantisedImage whole = QuantiseFeatures(model, features.WholeImage(row));
    const QuantisedImage shuffled =
        QuantiseFeatures(model, ShuffleKeypoints(features.WholeImage(row), Shuffle(random)));
    const auto score = [&](const QuantisedImage& image, CategoryMethod method) {
      return Classify(model, image, method).scores[node].raw;
    };
    const double change = score(shuffled, CategoryMethod::kPhrases) - score(whole, CategoryMethod::kPhrases);
    falls += change < 0 ? 1 : 0;
    drop -= change;
    unchanged += score(shuffled, CategoryMethod::kWords) == score(whole, CategoryMethod::kWords) ? 1 : 0;
  }
  const auto count = static_cast<double>(split.test.size());
  results.phrases_fall.push_back(100 * falls / count);
  results.words_unchanged.push_back(100 * unchanged / count);
  results.phrase_drop.push_back(drop / count);
  return {};
}

Status DrawExample(const ExperimentSettings& settings, const CaltechFeatures& features) {
  const auto car = std::ranges::find(features.rows(), std::string(kCars), &CategoryListRow::category);
  VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(settings.data / "caltech101" / car->image));
  Random random(1);
  cv::Mat both;
  cv::hconcat(image.bgr, ShufflePixels(image.bgr, Shuffle(random)), both);
  return WriteImage(settings.out / "figure3.1.png", both);
}

}  // namespace

Expected<Report> RunFigure31(const ExperimentSettings& settings) {
  const std::array<std::string, 2> pair = {kAirplanes, kCars};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCaltechRows(settings, pair));
  Report report{.title = fmt::format("Test images cut into {} x {} tiles and shuffled", kTilesAcross, kTilesDown),
                .columns = {"method", "phrase score falls, % of images", "mean fall of the raw score",
                            "word score unchanged, % of images"}};
  report.plot = {.title = "Shuffled images whose phrase score falls",
                 .x = {.label = "seed"},
                 .y = {.label = "fraction (%)", .low = 50, .high = 100}};
  for (const auto& [name, options] :
       {std::pair{std::string("ours"), CategoryTrainOptions()}, std::pair{std::string("thesis"), ThesisCategories()}}) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto features, CaltechFeatures::Load(settings, rows, options.features));
    if (report.rows.empty()) VICTORIOUS_RETURN_IF_ERROR(DrawExample(settings, features));
    ShuffleResults results;
    PlotLine line{.name = name};
    for (int seed = 1; seed <= settings.seeds; ++seed) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      VICTORIOUS_RETURN_IF_ERROR(MeasureInto(results, features, options.category, static_cast<std::uint64_t>(seed)));
      line.points.push_back({static_cast<double>(seed), results.phrases_fall.back()});
    }
    report.rows.push_back({name, ComputeMean(results.phrases_fall), ComputeMean(results.phrase_drop),
                           ComputeMean(results.words_unchanged)});
    report.plot.lines.push_back(line);
    settings.progress(name);
  }
  report.notes = {
      fmt::format("{} seeds; airplanes and cars, 30 training images each; the score of each test image for its own "
                  "category, whole and shuffled. Keypoints move with their tiles.",
                  settings.seeds)};
  return report;
}

}  // namespace victorious
