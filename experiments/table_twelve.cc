// Accuracy of all categories of the data, trained together: phrases compared with words.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "victorious/category/category_file.h"

namespace victorious {

Expected<Report> RunTableTwelve(const ExperimentSettings& settings) {
  const CategoryTrainOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> rows, ReadCaltechRows(settings, {}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto features, CaltechFeatures::Load(settings, std::move(rows), options.features));
  struct Figures {
    std::map<std::string, std::vector<double>> of_category;
    std::vector<double> mean;
  };
  std::map<CategoryMethod, Figures> figures;
  std::vector<double> train_s;
  std::vector<double> file_mb;
  for (int seed = 1; seed <= settings.seeds; ++seed) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    CategoryModel model;
    VICTORIOUS_ASSIGN_OR_RETURN(
        const TestScores scores,
        TrainAndTest(features, options.category, static_cast<std::uint64_t>(seed), {}, {}, &model));
    for (const CategoryMethod method : {CategoryMethod::kWords, CategoryMethod::kPhrases}) {
      for (const CategoryNode& node : model.nodes)
        figures[method].of_category[node.name].push_back(100 * ComputeAccuracy(scores, model, method, node.name));
      figures[method].mean.push_back(100 * MeanAccuracy(scores, model, method));
    }
    train_s.push_back(scores.train_s);
    file_mb.push_back(static_cast<double>(EncodeCategoryModel(model).size()) / 1e6);
    settings.progress(fmt::format("seed {} of {}: phrases {:.2f} %, words {:.2f} %", seed, settings.seeds,
                                  figures[CategoryMethod::kPhrases].mean.back(),
                                  figures[CategoryMethod::kWords].mean.back()));
  }
  Report report{.title = "Accuracy (%) of the Caltech-101 categories of the data, trained together",
                .columns = {"category", "words", "phrases"}};
  const Figures& words = figures[CategoryMethod::kWords];
  const Figures& phrases = figures[CategoryMethod::kPhrases];
  for (const auto& [category, values] : words.of_category)
    report.rows.push_back({category, ComputeMean(values), ComputeMean(phrases.of_category.at(category))});
  report.rows.push_back({std::string("mean of the categories"), ComputeMean(words.mean), ComputeMean(phrases.mean)});
  report.notes = {fmt::format("{} seeds. {}. Training without feature extraction: {:.1f} s; model file: {:.1f} MB.",
                              settings.seeds, kSplitNote, ComputeMean(train_s).mean, ComputeMean(file_mb).mean)};
  report.plot = {.title = "Mean accuracy of the categories",
                 .x = {.label = "seed"},
                 .y = {.label = "accuracy (%)", .low = 60, .high = 100}};
  for (const auto& [method, name] :
       {std::pair{CategoryMethod::kWords, "words"}, {CategoryMethod::kPhrases, "phrases"}}) {
    PlotLine line{.name = name};
    for (std::size_t i = 0; i < figures[method].mean.size(); ++i)
      line.points.push_back({static_cast<double>(i + 1), figures[method].mean[i]});
    report.plot.lines.push_back(std::move(line));
  }
  return report;
}

}  // namespace victorious
