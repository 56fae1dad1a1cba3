#include "victorious/recognize/category_pictures.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "victorious/video/image_file.h"

namespace victorious {

void CategoryFeatureOptions::ListFields(FieldList& fields) {
  fields.Add("kind", kind,
             {.choices = {"dense", "keypoints"},
              .reason = "dense: descriptors on a grid, also where nothing stands out; keypoints: SIFT, as the thesis"});
  fields.Add("surroundings", surroundings,
             {.choices = {"none", "calibrate", "learn"},
              .reason = "what the whole picture about a box is for. learn: an example like the crop, since what will "
                        "be classified has surroundings; calibrate: only to turn scores into probabilities"});
  fields.Add(
      "mirrored", mirrored,
      {.reason = "learn from each picture's mirror image too: false where left and right tell categories apart"});
  fields.AddGroup("dense", dense);
  fields.AddGroup("keypoints", keypoints);
}

void CategoryTrainOptions::ListFields(FieldList& fields) {
  fields.AddGroup("features", features);
  category.ListFields(fields);
}

Expected<CategoryEye> CategoryEye::Create(const CategoryFeatureOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  CategoryEye eye;
  eye.options_ = options;
  VICTORIOUS_ASSIGN_OR_RETURN(eye.extractor_, MakeFeatureExtractor(options.keypoints));
  return eye;
}

Expected<CategoryEye> CategoryEye::Of(const CategoryModel& model) {
  CategoryFeatureOptions options;
  const auto json = nlohmann::json::parse(model.features_json, nullptr, /*allow_exceptions=*/false);
  const Status status =
      json.is_discarded() ? Fail(ErrorCode::kDataLoss, "not JSON") : SetFromJson(json, FieldsOf(options));
  if (status) return Create(options);
  return Fail(ErrorCode::kDataLoss,
              fmt::format("options of the category model's features: {}: train again", status.error().message));
}

Expected<FeatureSet> CategoryEye::Look(const cv::Mat& grey) const {
  if (options_.kind == "dense") return DenseFeatures(grey, options_.dense);
  return extractor_->Extract(grey);
}

Expected<std::vector<CategoryExample>> ExamplesOf(const CategoryEye& eye, const cv::Mat& grey, const Box& box,
                                                  const std::string& category, int number) {
  const int x0 = std::clamp(static_cast<int>(std::floor(box.x)), 0, grey.cols - 1);
  const int y0 = std::clamp(static_cast<int>(std::floor(box.y)), 0, grey.rows - 1);
  const int x1 = std::clamp(static_cast<int>(std::ceil(box.x + box.width)), x0 + 1, grey.cols);
  const int y1 = std::clamp(static_cast<int>(std::ceil(box.y + box.height)), y0 + 1, grey.rows);
  const cv::Rect part(x0, y0, x1 - x0, y1 - y0);
  const bool with_whole = part.size() != grey.size() && eye.options().surroundings != "none";
  std::vector<CategoryExample> examples;
  const auto add = [&](const cv::Mat& seen, bool learns, bool calibrates) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet features, eye.Look(seen));
    examples.push_back({.category = category,
                        .features = std::move(features),
                        .picture = number,
                        .learns = learns,
                        .calibrates = calibrates});
    return {};
  };
  const auto add_mirrored = [&](const cv::Mat& seen) -> Status {
    if (!eye.options().mirrored) return {};
    cv::Mat mirrored;
    cv::flip(seen, mirrored, 1);
    return add(mirrored, /*learns=*/true, /*calibrates=*/false);
  };
  const cv::Mat cut_out = grey(part).clone();
  VICTORIOUS_RETURN_IF_ERROR(add(cut_out, /*learns=*/true, /*calibrates=*/!with_whole));
  VICTORIOUS_RETURN_IF_ERROR(add_mirrored(cut_out));
  if (!with_whole) return examples;
  const bool learns = eye.options().surroundings == "learn";
  VICTORIOUS_RETURN_IF_ERROR(add(grey, learns, /*calibrates=*/true));
  if (learns) VICTORIOUS_RETURN_IF_ERROR(add_mirrored(grey));
  return examples;
}

Status ForEachPicture(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                      const std::function<Status(std::size_t row, const cv::Mat& bgr)>& use,
                      const std::function<void(std::size_t)>& done) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> failed = false;
  std::mutex mutex;
  std::size_t finished = 0;
  std::size_t first_failure = rows.size();
  Status status;
  const auto work = [&] {
    for (std::size_t row = next++; row < rows.size() && !failed; row = next++) {
      const Status one = [&]() -> Status {
        Expected<Image> image = ReadImage(folder / rows[row].image);
        if (!image) return std::unexpected(std::move(image).error().WithContext(rows[row].where));
        return use(row, image->bgr);
      }();
      const std::scoped_lock lock(mutex);
      if (one) {
        done(++finished);
      } else if (row < first_failure) {
        first_failure = row;
        status = one;
        failed = true;
      }
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 1; i < std::max(1U, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  work();
  threads.clear();
  return status;
}

Expected<CategoryModel> TrainOnList(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                                    const CategoryTrainOptions& options, const std::function<void(std::size_t)>& done) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  for (const CategoryListRow& row : rows) {
    if (row.category.empty())
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: no category: must name what the picture shows", row.where));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryEye eye, CategoryEye::Create(options.features));
  std::vector<std::vector<CategoryExample>> of_row(rows.size());
  const auto look = [&](std::size_t row, const cv::Mat& bgr) -> Status {
    const cv::Mat grey = GreyFromBgr(bgr);
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, BoxWithin(rows[row], grey.cols, grey.rows));
    VICTORIOUS_ASSIGN_OR_RETURN(of_row[row], ExamplesOf(eye, grey, box, rows[row].category, static_cast<int>(row)));
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(ForEachPicture(folder, rows, look, done));
  std::vector<CategoryExample> examples;
  for (auto& some : of_row) std::ranges::move(some, std::back_inserter(examples));
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model, TrainCategories(examples, options.category));
  model.features_json = OptionsToJsonText(options.features);
  return model;
}

}  // namespace victorious
