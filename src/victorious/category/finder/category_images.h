// Connects images and category/: extracts SIFT or dense-grid features for training and classification. Both use the
// same code, so that a model sees training and test images alike.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/category_model.h"
#include "victorious/category/channels/channel_training.h"
#include "victorious/category/common/category_list.h"
#include "victorious/category/common/dense_features.h"
#include "victorious/category/finder/cad_examples.h"
#include "victorious/category/finder/window_training.h"
#include "victorious/category/windows.h"
#include "victorious/object/features/feature_extractor.h"

namespace victorious {

/// Where features lie: on a grid, or at SIFT keypoints (thesis).
enum class CategoryFeatureKind { kDense, kKeypoints };

inline constexpr auto kCategoryFeatureKindTexts = std::to_array<EnumText<CategoryFeatureKind>>(
    {{CategoryFeatureKind::kDense, "dense"}, {CategoryFeatureKind::kKeypoints, "keypoints"}});

/// Use of the whole image around a box in training.
enum class Surroundings { kNone, kCalibrate, kLearn };

inline constexpr auto kSurroundingsTexts = std::to_array<EnumText<Surroundings>>(
    {{Surroundings::kNone, "none"}, {Surroundings::kCalibrate, "calibrate"}, {Surroundings::kLearn, "learn"}});

/// The features of a category model. Keypoints are extracted with the other defaults of FeatureOptions.
struct CategoryFeatureOptions {
  CategoryFeatureKind kind = CategoryFeatureKind::kDense;
  std::string engine = FeatureOptions().engine;  ///< of keypoints
  Surroundings surroundings = Surroundings::kLearn;
  bool mirrored = true;
  DenseOptions dense;
  WindowOptions windows;

  void ListFields(FieldList& fields);
};

/// The parameters of `category train --params`.
struct CategoryTrainOptions {
  CategoryFeatureOptions features;
  WindowTrainOptions examples;
  CadExampleOptions cad;
  ChannelTrainOptions channels;
  CategoryOptions category;

  void ListFields(FieldList& fields);
};

/// Extracts the features of images for category/. Thread-safe.
class CategoryFeaturizer {
 public:
  /// Errors: kInvalidArgument for options out of range.
  [[nodiscard]] static Expected<CategoryFeaturizer> Create(const CategoryFeatureOptions& options);

  /// With the options that the model was trained with. Errors: kDataLoss for a model whose options cannot be read.
  [[nodiscard]] static Expected<CategoryFeaturizer> Of(const CategoryModel& model);

  [[nodiscard]] const CategoryFeatureOptions& options() const { return options_; }

  /// @param grey  CV_8UC1
  [[nodiscard]] Expected<FeatureSet> Extract(const cv::Mat& grey) const;

  /// The image without salt-and-pepper noise: the source of windows.
  [[nodiscard]] cv::Mat Clean(const cv::Mat& grey) const;

 private:
  CategoryFeaturizer() = default;

  CategoryFeatureOptions options_;
  std::shared_ptr<const FeatureExtractor> extractor_;
};

/// The training examples of one image: the crop to `box`; if the crop is smaller than the image, also the whole image,
/// with the role that the option `surroundings` gives; and, with the option `mirrored`, a mirrored copy of each example
/// that is learned from.
/// @param number            number of the image, shared by all its examples (cross-validation keeps them together)
/// @param own_surroundings  false: the surroundings belong to another image (a composited background); only the crop is
///                          used
[[nodiscard]] Expected<std::vector<CategoryExample>> ExamplesOf(const CategoryFeaturizer& featurizer,
                                                                const cv::Mat& grey, const Box& box,
                                                                const std::string& category, int number,
                                                                bool own_surroundings = true);

/// Reads the images of a list on all cores and calls `use` with each row and its image, in any order and concurrently
/// from several threads.
/// @param done  progress callback, with the number of images done
/// Errors: the first error in the list's order.
[[nodiscard]] Status ForEachImage(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                                  const std::function<Status(std::size_t row, const cv::Mat& bgr)>& use,
                                  const std::function<void(std::size_t)>& done);

/// Trains on the images and CAD files of a list. CAD files are rendered in front of the background images: images of
/// categories without boxes and without CAD files. For windows (features.windows) an image without a box is background
/// if its category has no boxes at all; else the whole image shows the object.
/// @param done  progress callback, with the number of rows done
/// @param warn  warning callback, for damaged parts of CAD files that are left out
/// Errors: those of reading images and CAD files, of TrainCategories and TrainOnWindows; kInvalidArgument for a row
/// without a category or with a box outside its image, and for CAD files with a box or without background images.
[[nodiscard]] Expected<CategoryModel> TrainOnList(const std::filesystem::path& folder,
                                                  std::span<const CategoryListRow> rows,
                                                  const CategoryTrainOptions& options,
                                                  const std::function<void(std::size_t)>& done,
                                                  const std::function<void(const std::string&)>& warn = {});

/// A classified image, or its window with the highest probability of the label.
struct ClassifiedImage {
  CategoryResult result;
  Box classified_box;    ///< the classified region, px of the image
  QuantisedImage image;  ///< the visual words of that region
};

/// Classifies an image as the model was trained: as a whole, or by windows: the maximum score of each category over the
/// windows, and for the background category the score of the window that is most likely to show an object.
/// Errors: kInvalidArgument for CategoryMethod::kWords with a model of windows.
[[nodiscard]] Expected<ClassifiedImage> ClassifyImage(const CategoryFeaturizer& featurizer, const CategoryModel& model,
                                                      const cv::Mat& grey, CategoryMethod method);

}  // namespace victorious
