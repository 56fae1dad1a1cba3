// The Caltech-101 pictures of the data given, their features kept in memory, and random splits by seed: per class
// min(30, half) of the pictures with boxes train (whole pictures where a class has no boxes); of the rest, 100 at most
// test, whole: over 20 seeds as many as there are, in a fraction of the time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/category_model.h"
#include "victorious/evaluate/experiments/experiment.h"
#include "victorious/recognize/category_pictures.h"

namespace victorious {

inline constexpr const char* kAirplanes = "airplanes";
inline constexpr const char* kCars = "car_side";
inline constexpr const char* kBackground = "BACKGROUND_Google";

/// The thesis caps the kernel of equation 3.1 at 10000: a sample says most within 0.01 radians or 1 % of a ratio, and
/// the sum over a picture's phrases becomes a matter of a few coincidences. With this cap, it says most within 0.6.
inline constexpr double kSmootherCap = 3;

/// The pictures of some categories; all of them where `categories` is empty. Errors: kNotFound without the data.
Expected<std::vector<CategoryListRow>> CaltechRows(const ExperimentSettings& settings,
                                                   std::span<const std::string> categories);

/// How pictures are split, for the notes of reports.
inline constexpr const char* kSplitNote =
    "Per class and seed min(30, half) of the pictures that have boxes train (any, where none has), and 100 of the rest "
    "at most test, whole";

struct Split {
  std::vector<std::size_t> train;  ///< rows
  std::vector<std::size_t> test;
};

Split SplitBySeed(std::span<const CategoryListRow> rows, std::uint64_t seed);

/// The features of all rows' pictures: what each gives to train on, and as it is tested.
class CaltechFeatures {
 public:
  static Expected<CaltechFeatures> Load(const ExperimentSettings& settings, std::vector<CategoryListRow> rows,
                                        const CategoryFeatureOptions& options);

  [[nodiscard]] std::span<const CategoryListRow> rows() const { return rows_; }
  [[nodiscard]] std::vector<CategoryExample> ExamplesOf(std::span<const std::size_t> rows) const;
  [[nodiscard]] const FeatureSet& Whole(std::size_t row) const { return whole_[row]; }

 private:
  CaltechFeatures() = default;

  std::vector<CategoryListRow> rows_;
  std::vector<FeatureSet> whole_;
  std::vector<std::vector<CategoryExample>> examples_;  ///< a row's; of whole pictures without their features
};

/// What a model says of the pictures of a split's test.
struct TestScores {
  std::vector<CategoryResult> phrases;
  std::vector<CategoryResult> words;
  std::vector<std::string> truth;
  double train_s = 0;
  double phrase_scoring_ms = 0;  ///< a picture, the features and words at hand

  [[nodiscard]] const std::vector<CategoryResult>& Of(CategoryMethod method) const {
    return method == CategoryMethod::kPhrases ? phrases : words;
  }
};

/// Trains on the split's training pictures of `trained` (all, where empty) and scores its test pictures of `tested`.
Expected<TestScores> TrainAndTest(const CaltechFeatures& features, const CategoryOptions& options, std::uint64_t seed,
                                  std::span<const std::string> trained, std::span<const std::string> tested,
                                  CategoryModel* model_out = nullptr);

/// The share of a category's test pictures that got its label.
double AccuracyOf(const TestScores& scores, const CategoryModel& model, CategoryMethod method,
                  const std::string& category);

/// The mean of AccuracyOf over the categories that were tested.
double MeanAccuracy(const TestScores& scores, const CategoryModel& model, CategoryMethod method);

/// A category's raw scores of the test pictures, and which of them show it.
struct Ranking {
  std::vector<double> scores;
  std::vector<bool> wanted;
};
Ranking RankingOf(const TestScores& scores, const CategoryModel& model, CategoryMethod method,
                  const std::string& category);

/// The thesis's features and method, in the reading that reaches its figures (--params thesis).
CategoryTrainOptions ThesisCategories();

/// The same with equations 3.1 to 3.3 as they are printed: cap 10000, phrases alone.
CategoryTrainOptions ThesisCategoriesAsPrinted();

}  // namespace victorious
