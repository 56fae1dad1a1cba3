// From pictures to what category/ learns from and classifies: features as the options say, of keypoints or on a grid.
// Training and everything that classifies with a model share this, so that both see a picture alike.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/category_list.h"
#include "victorious/category/category_model.h"
#include "victorious/category/dense_features.h"
#include "victorious/category/windows.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/recognize/cad_pictures.h"
#include "victorious/recognize/window_training.h"

namespace victorious {

struct CategoryFeatureOptions {
  std::string kind = "dense";
  std::string surroundings = "learn";
  bool mirrored = true;
  DenseOptions dense;
  WindowOptions windows;
  FeatureOptions keypoints;

  void ListFields(FieldList& fields);
};

/// What `category train --params` sets.
struct CategoryTrainOptions {
  CategoryFeatureOptions features;
  WindowTrainOptions examples;
  CadPictureOptions cad;
  CategoryOptions category;

  void ListFields(FieldList& fields);
};

/// Makes the features of pictures. Thread-safe.
class CategoryEye {
 public:
  /// Errors: kInvalidArgument for options out of range.
  static Expected<CategoryEye> Create(const CategoryFeatureOptions& options);

  /// The eye that a model's pictures were seen by. Errors: kDataLoss for a model whose options cannot be read.
  static Expected<CategoryEye> Of(const CategoryModel& model);

  [[nodiscard]] const CategoryFeatureOptions& options() const { return options_; }

  /// @param grey  CV_8UC1
  [[nodiscard]] Expected<FeatureSet> Look(const cv::Mat& grey) const;

  /// The picture without salt and pepper: what windows are cut out of.
  [[nodiscard]] cv::Mat Clean(const cv::Mat& grey) const;

 private:
  CategoryEye() = default;

  CategoryFeatureOptions options_;
  std::shared_ptr<const FeatureExtractor> extractor_;
};

/// What a picture gives: the part within `box` to learn from, and where the box leaves something out, the whole picture
/// for what the option `surroundings` says; of both, what is learned from, a mirrored copy where `mirrored` is set.
/// @param number            the picture's, which all its examples share
/// @param own_surroundings  false: those of something else, of which nothing is learned: the part alone counts
Expected<std::vector<CategoryExample>> ExamplesOf(const CategoryEye& eye, const cv::Mat& grey, const Box& box,
                                                  const std::string& category, int number,
                                                  bool own_surroundings = true);

/// Reads the pictures of a list, on all cores, and calls `use` with each row and its picture, in any order and
/// from several threads at once. The first error in the list's order is returned.
/// @param done  called now and then with how many pictures are done
Status ForEachPicture(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                      const std::function<Status(std::size_t row, const cv::Mat& bgr)>& use,
                      const std::function<void(std::size_t)>& done);

/// Trains on the pictures of a list, and on its CAD files: each is an example of its kind, seen from many sides before
/// the pictures of none of the things, which are those of the categories without boxes and CAD files. For windows
/// (features.windows) a picture without a box is, where its category has none at all, of none of the things; elsewhere,
/// a thing as a whole.
/// @param done  called now and then with how many rows are done
/// @param warn  told what is damaged in a CAD file and was left out
/// Errors: those of reading pictures and CAD files, of TrainCategories and TrainOnWindows; kInvalidArgument for a row
/// without a category, with a box outside its picture, and for CAD files with boxes, or without pictures of none of
/// them.
Expected<CategoryModel> TrainOnList(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                                    const CategoryTrainOptions& options, const std::function<void(std::size_t)>& done,
                                    const std::function<void(const std::string&)>& warn = {});

/// A picture, or the window of it that is likeliest to show its label.
struct ClassifiedPicture {
  CategoryResult result;
  Box looked_at;          ///< px of the picture
  WordedPicture picture;  ///< what was looked at
};

/// What a picture shows, as the model was trained: as a whole, or of windows the highest score of each category, and of
/// none of the things what the likeliest window leaves.
/// Errors: kInvalidArgument for words alone of a model of windows.
Expected<ClassifiedPicture> ClassifyPicture(const CategoryEye& eye, const CategoryModel& model, const cv::Mat& grey,
                                            CategoryMethod method);

}  // namespace victorious
