// CAD models as training examples of a category: retrieval of photos of the category after training with CAD models,
// few photos, or both. Not a table of the thesis; its section 1.1 proposes it.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "experiments/roc.h"

namespace victorious {
namespace {

struct CadCategory {
  std::string category;
  std::vector<std::string> models;  // CAD files in the data
};

std::vector<CadCategory> Kinds() {
  return {{"helicopter", {"apache", "blackhawk", "dauphin", "mi17"}},
          {kAirplanes, {"c17", "f14_tomcat", "f4_phantom", "mig21", "mig29"}}};
}

// The training examples of a category.
struct TrainingSet {
  std::string name;
  std::size_t models;
  std::size_t photos;
};

// One value per seed.
struct TrainingFigures {
  std::vector<double> area;
  std::vector<double> first;  // precision among the first kFirst of the ranking, %
};

constexpr std::size_t kFirst = 20;

// Makes the row's image path relative to the data folder.
CategoryListRow FromData(CategoryListRow row) {
  row.image = fmt::format("caltech101/{}", row.image);
  return row;
}

std::vector<CategoryListRow> TrainingRows(std::span<const CategoryListRow> rows, const Split& split,
                                          const CadCategory& kind, const TrainingSet& way, std::uint64_t seed) {
  std::vector<CategoryListRow> train;
  std::size_t photos = 0;
  for (const std::size_t row : split.train) {
    const bool shows = rows[row].category == kind.category;
    if (shows && photos == way.photos) continue;
    if (shows) ++photos;
    train.push_back(FromData(rows[row]));
  }
  for (std::size_t m = 0; m < std::min(way.models, kind.models.size()); ++m) {
    const std::string& model = kind.models[(seed + m) % kind.models.size()];
    train.push_back({.image = fmt::format("models/{}.glb", model),
                     .category = kind.category,
                     .box = {},
                     .mark = {},
                     .where = model});
  }
  return train;
}

void MeasureInto(TrainingFigures& figures, const CaltechFeatures& features, const Split& split,
                 const CategoryModel& model, const std::string& category) {
  const auto node = std::ranges::find(model.nodes, category, &CategoryNode::name) - model.nodes.begin();
  std::vector<double> scores;
  std::vector<bool> is_positive;
  for (const std::size_t row : split.test) {
    const QuantisedImage image = QuantiseFeatures(model, features.WholeImage(row));
    scores.push_back(
        Classify(model, image, CategoryMethod::kPhrases).scores[static_cast<std::size_t>(node)].probability);
    is_positive.push_back(features.rows()[row].category == category);
  }
  figures.area.push_back(RocArea(scores, is_positive));
  std::vector<std::size_t> order(scores.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return scores[i]; });
  const std::size_t shown = std::min(kFirst, order.size());
  const auto right = std::ranges::count_if(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(shown),
                                           [&](std::size_t i) { return is_positive[i]; });
  figures.first.push_back(100.0 * static_cast<double>(right) / static_cast<double>(shown));
}

}  // namespace

Expected<Report> RunTableCad(const ExperimentSettings& settings) {
  const std::array<TrainingSet, 4> training_sets = {
      TrainingSet{"one CAD model", 1, 0}, TrainingSet{"all CAD models", 100, 0}, TrainingSet{"3 photos", 0, 3},
      TrainingSet{"3 photos and all CAD models", 100, 3}};
  Report report{.title = "CAD models as training examples of a category, photos of Caltech-101",
                .columns = {"kind", "learned from", "area under ROC", fmt::format("precision at {}, %", kFirst)}};
  for (const CadCategory& kind : Kinds()) {
    const std::array<std::string, 2> categories = {kind.category, kBackground};
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> rows, ReadCaltechRows(settings, categories));
    const CategoryTrainOptions options;
    VICTORIOUS_ASSIGN_OR_RETURN(const auto features,
                                CaltechFeatures::Load(settings, std::move(rows), options.features));
    std::array<TrainingFigures, training_sets.size()> figures;
    for (int seed = 1; seed <= settings.seeds; ++seed) {
      const auto number = static_cast<std::uint64_t>(seed);
      const Split split = MakeRandomSplit(features.rows(), number);
      for (std::size_t w = 0; w < training_sets.size(); ++w) {
        VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
        CategoryTrainOptions seeded = options;
        seeded.category.seed = number;
        const std::vector<CategoryListRow> train = TrainingRows(features.rows(), split, kind, training_sets[w], number);
        VICTORIOUS_ASSIGN_OR_RETURN(const CategoryModel model,
                                    TrainOnList(settings.data, train, seeded, [](std::size_t) {}));
        MeasureInto(figures[w], features, split, model, kind.category);
        settings.progress(fmt::format("{}, seed {}, {}: area {:.3f}, {:.0f} % precision at {}", kind.category, seed,
                                      training_sets[w].name, figures[w].area.back(), figures[w].first.back(), kFirst));
      }
    }
    for (std::size_t w = 0; w < training_sets.size(); ++w)
      report.rows.push_back(
          {kind.category, training_sets[w].name, ComputeMean(figures[w].area), ComputeMean(figures[w].first)});
  }
  report.notes = {fmt::format(
      "{} seeds. {}; background is trained too. One CAD model: chosen by the seed from those of the data, which are {} "
      "helicopters and {} military airplanes; the photos show airliners for the most part.",
      settings.seeds, kSplitNote, Kinds()[0].models.size(), Kinds()[1].models.size())};
  return report;
}

}  // namespace victorious
