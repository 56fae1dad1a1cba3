// The Caltech-101 images for the experiments on categories (thesis, section 3.6): their features in memory, random
// splits into training and test images by seed, and training and scoring on a split.
//
// Split: per class, min(30, half) of the images with boxes are training images (any image, if the class has no boxes).
// At most 100 of the rest are test images, used whole. Over 20 seeds nearly all images are tested, in a fraction of
// the time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "experiments/experiment.h"
#include "victorious/category/category_model.h"
#include "victorious/category/finder/category_images.h"

namespace victorious {

inline constexpr const char* kAirplanes = "airplanes";
inline constexpr const char* kCars = "car_side";
inline constexpr const char* kBackground = "BACKGROUND_Google";

/// Cap of the kernel of equation 3.1. The thesis uses 10000: a sample then has weight only within 0.01 rad or 1 % of a
/// ratio, and a few coincidences dominate the sum over an image's phrases. This cap widens the kernel to 0.6.
inline constexpr double kSmootherCap = 3;

/// Lists the images of `categories`; of all categories if it is empty. Errors: kNotFound without the data.
[[nodiscard]] Expected<std::vector<CategoryListRow>> ReadCaltechRows(const ExperimentSettings& settings,
                                                                     std::span<const std::string> categories);

/// Describes the split in the notes of reports.
inline constexpr const char* kSplitNote =
    "Per class and seed, min(30, half) of the images with boxes are for training (any image if none has a box), and at "
    "most 100 of the rest for testing, whole";

struct Split {
  std::vector<std::size_t> train;  ///< indexes into the rows
  std::vector<std::size_t> test;   ///< indexes into the rows
};

Split MakeRandomSplit(std::span<const CategoryListRow> rows, std::uint64_t seed);

/// The features of all images: the training examples of each, and the features of the whole image for testing.
class CaltechFeatures {
 public:
  [[nodiscard]] static Expected<CaltechFeatures> Load(const ExperimentSettings& settings,
                                                      std::vector<CategoryListRow> rows,
                                                      const CategoryFeatureOptions& options);

  [[nodiscard]] std::span<const CategoryListRow> rows() const { return rows_; }
  [[nodiscard]] std::vector<CategoryExample> ExamplesOf(std::span<const std::size_t> rows) const;
  [[nodiscard]] const FeatureSet& WholeImage(std::size_t row) const { return whole_[row]; }

 private:
  CaltechFeatures() = default;

  std::vector<CategoryListRow> rows_;
  std::vector<FeatureSet> whole_;
  std::vector<std::vector<CategoryExample>> examples_;  ///< of each row; a whole-image example has no features here
};

/// The results of a model on the test images of a split.
struct TestScores {
  std::vector<CategoryResult> phrases;
  std::vector<CategoryResult> words;
  std::vector<std::string> truth;
  double train_s = 0;
  double phrase_scoring_ms = 0;  ///< per image, without the extraction of features and words

  [[nodiscard]] const std::vector<CategoryResult>& ResultsBy(CategoryMethod method) const {
    return method == CategoryMethod::kPhrases ? phrases : words;
  }
};

/// Trains on the split's training images of the categories `trained`, and scores its test images of `tested`; an empty
/// list means all categories.
/// @param model_out  receives the trained model, if not null
[[nodiscard]] Expected<TestScores> TrainAndTest(const CaltechFeatures& features, const CategoryOptions& options,
                                                std::uint64_t seed, std::span<const std::string> trained,
                                                std::span<const std::string> tested,
                                                CategoryModel* model_out = nullptr);

/// The fraction of a category's test images that are labelled with it.
double ComputeAccuracy(const TestScores& scores, const CategoryModel& model, CategoryMethod method,
                       const std::string& category);

/// The mean of ComputeAccuracy over the tested categories.
double MeanAccuracy(const TestScores& scores, const CategoryModel& model, CategoryMethod method);

/// A category's raw score of each test image, and whether the image shows it; input of roc.h.
struct Ranking {
  std::vector<double> scores;
  std::vector<bool> is_positive;
};
Ranking ComputeRanking(const TestScores& scores, const CategoryModel& model, CategoryMethod method,
                       const std::string& category);

/// The thesis's features and method, in the interpretation that reproduces its results (--params thesis).
CategoryTrainOptions ThesisCategories();

/// The same with equations 3.1 to 3.3 as printed: cap 10000, phrases only.
CategoryTrainOptions ThesisCategoriesAsPrinted();

}  // namespace victorious
