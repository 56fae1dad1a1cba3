// Table 3.6: area under ROC of airplanes against cars and background by phrases, and run time, against the number of
// words in phrases. In the thesis's method these are the most probable words of a category, in ours the word clusters.
#include <array>
#include <map>

#include <fmt/format.h>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "experiments/roc.h"

namespace victorious {
namespace {

struct Row {
  int words;
  double thesis_area;
  double thesis_test_s;
};

// The thesis's table.
constexpr std::array kPrintedRows = {Row{30, 0.7023, 33.3}, Row{60, 0.7979, 125}, Row{90, 0.8642, 225},
                                     Row{150, 0.9063, 717}, Row{250, 0.9139, 1746}};
constexpr double kVocabulary = 3000;

struct Figures {
  std::vector<double> area;
  std::vector<double> train_s;
  std::vector<double> score_ms;
};

// A scoring method with its results for each number of words.
struct Method {
  std::string name;
  std::map<int, Figures> figures = {};
};

Status MeasureInto(Figures& figures, const CaltechFeatures& features, const CategoryOptions& options,
                   std::uint64_t seed) {
  CategoryModel model;
  VICTORIOUS_ASSIGN_OR_RETURN(const TestScores scores, TrainAndTest(features, options, seed, {}, {}, &model));
  const Ranking ranking = ComputeRanking(scores, model, CategoryMethod::kPhrases, kAirplanes);
  figures.area.push_back(RocArea(ranking.scores, ranking.is_positive));
  figures.train_s.push_back(scores.train_s);
  figures.score_ms.push_back(scores.phrase_scoring_ms);
  return {};
}

}  // namespace

Expected<Report> RunTable36(const ExperimentSettings& settings) {
  const std::array<std::string, 3> categories = {kAirplanes, kCars, kBackground};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCaltechRows(settings, categories));
  const CategoryTrainOptions thesis = ThesisCategories();
  const CategoryTrainOptions ours;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto keypoints, CaltechFeatures::Load(settings, rows, thesis.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto dense, CaltechFeatures::Load(settings, rows, ours.features));

  Method as_printed{"thesis"};
  Method smoother{"thesis, smoother kernel"};
  Method reading{"thesis, --params thesis"};
  Method by_clusters{"ours"};
  Figures best;
  for (int seed = 1; seed <= settings.seeds; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    for (const Row& row : kPrintedRows) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      CategoryOptions options = ThesisCategoriesAsPrinted().category;
      options.thesis.grammar.word_fraction = row.words / kVocabulary;
      VICTORIOUS_RETURN_IF_ERROR(MeasureInto(as_printed.figures[row.words], keypoints, options, number));
      options.thesis.grammar.kernel_cap = kSmootherCap;
      VICTORIOUS_RETURN_IF_ERROR(MeasureInto(smoother.figures[row.words], keypoints, options, number));
      options = thesis.category;
      options.thesis.grammar.word_fraction = row.words / kVocabulary;
      VICTORIOUS_RETURN_IF_ERROR(MeasureInto(reading.figures[row.words], keypoints, options, number));
      options = ours.category;
      options.linear.phrases.word_clusters = row.words;
      VICTORIOUS_RETURN_IF_ERROR(MeasureInto(by_clusters.figures[row.words], dense, options, number));
    }
    VICTORIOUS_RETURN_IF_ERROR(MeasureInto(best, dense, ours.category, number));
    settings.progress(fmt::format("seed {} of {}", seed, settings.seeds));
  }

  Report report{.title = "Airplanes against cars and background: area under ROC and time by words in phrases",
                .columns = {"method", "words in phrases", "area under ROC", "training s", "scoring ms an image",
                            "area, thesis", "test s, thesis"}};
  PlotLine printed_there{.name = "thesis, as printed there"};
  for (const Row& row : kPrintedRows) printed_there.points.push_back({static_cast<double>(row.words), row.thesis_area});
  report.plot.lines.push_back(std::move(printed_there));
  for (const Method* method : {&as_printed, &smoother, &reading, &by_clusters}) {
    PlotLine line{.name = method->name};
    for (const Row& row : kPrintedRows) {
      const Figures& figures = method->figures.at(row.words);
      const MeanWithError area = ComputeMean(figures.area);
      report.rows.push_back({method->name, static_cast<double>(row.words), area, ComputeMean(figures.train_s),
                             ComputeMean(figures.score_ms), row.thesis_area, row.thesis_test_s});
      line.points.push_back({static_cast<double>(row.words), area.mean, area.standard_error});
    }
    report.plot.lines.push_back(std::move(line));
  }
  report.rows.push_back({std::string("ours, the default"),
                         static_cast<double>(ours.category.linear.phrases.word_clusters), ComputeMean(best.area),
                         ComputeMean(best.train_s), ComputeMean(best.score_ms), std::string(), std::string()});
  report.notes = {
      fmt::format("{} seeds; background trained as a class. {}. The thesis tested airplanes against cars, 3 "
                  "runs.",
                  settings.seeds, kSplitNote),
      "Scoring: phrases of one image for all three classes, without extraction of its words. Smoother kernel: "
      "lower cap of equation 3.1, the rest as printed. Words in phrases: the thesis uses a category's most "
      "probable of 3000 words; ours groups all 3000 into this number of clusters."};
  report.plot.title = "Airplanes: area under ROC";
  report.plot.x = {.label = "words in phrases"};
  report.plot.y = {.label = "area under ROC", .low = 0.5, .high = 1.0};
  return report;
}

}  // namespace victorious
