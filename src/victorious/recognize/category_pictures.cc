#include "victorious/recognize/category_pictures.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "victorious/features/impulse_noise.h"
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
  fields.Add("mirrored", mirrored,
             {.reason = "learn from each picture's mirror image too; not those of categories that are each other's "
                        "mirror images, as pictures held out tell"});
  fields.AddGroup("dense", dense);
  fields.AddGroup("windows", windows);
  fields.AddGroup("keypoints", keypoints);
}

void CategoryTrainOptions::ListFields(FieldList& fields) {
  fields.AddGroup("features", features);
  fields.AddGroup("examples", examples);
  category.ListFields(fields);
}

Expected<CategoryEye> CategoryEye::Create(const CategoryFeatureOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.windows.enabled && options.kind != "dense")
    return Fail(ErrorCode::kInvalidArgument, "windows.enabled: goes with features on a grid alone: kind must be dense");
  constexpr int kMostEnlarged = 2;  // what is larger by more takes memory, and shows nothing new
  if (options.windows.enabled && options.windows.side_px > kMostEnlarged * options.windows.smallest_px) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("windows.smallest_px {}: below half of windows.side_px {}, so that pictures would be enlarged "
                    "more than twice",
                    options.windows.smallest_px, options.windows.side_px));
  }
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
  if (options.windows.enabled && model.options.scoring != "linear")
    return Fail(ErrorCode::kDataLoss, "the category model is of windows, and not of scoring linear: train again");
  if (status) return Create(options);
  return Fail(ErrorCode::kDataLoss,
              fmt::format("options of the category model's features: {}: train again", status.error().message));
}

Expected<FeatureSet> CategoryEye::Look(const cv::Mat& grey) const {
  if (options_.kind == "dense") return DenseFeatures(grey, options_.dense);
  return extractor_->Extract(grey);
}

cv::Mat CategoryEye::Clean(const cv::Mat& grey) const {
  return WithoutImpulses(grey, options_.keypoints.impulse_share);
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
  const auto add = [&](const cv::Mat& seen, bool learns, bool calibrates, bool mirrored = false) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet features, eye.Look(seen));
    examples.push_back({.category = category,
                        .features = std::move(features),
                        .picture = number,
                        .learns = learns,
                        .calibrates = calibrates,
                        .mirrored = mirrored});
    return {};
  };
  const auto add_mirrored = [&](const cv::Mat& seen) -> Status {
    if (!eye.options().mirrored) return {};
    cv::Mat mirrored;
    cv::flip(seen, mirrored, 1);
    return add(mirrored, /*learns=*/true, /*calibrates=*/false, /*mirrored=*/true);
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
  std::set<std::string> boxed;  // categories with a box
  for (const CategoryListRow& row : rows) {
    if (row.category.empty())
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: no category: must name what the picture shows", row.where));
    if (row.box) boxed.insert(row.category);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryEye eye, CategoryEye::Create(options.features));
  const bool by_windows = options.features.windows.enabled;
  if (by_windows && options.category.scoring != "linear")
    return Fail(ErrorCode::kInvalidArgument, "features.windows.enabled: goes with scoring linear alone");
  std::vector<std::vector<CategoryExample>> of_row(rows.size());
  std::vector<BoxedPicture> pictures(by_windows ? rows.size() : 0);
  const auto look = [&](std::size_t row, const cv::Mat& bgr) -> Status {
    const cv::Mat grey = GreyFromBgr(bgr);
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, BoxWithin(rows[row], grey.cols, grey.rows));
    const std::string& category = rows[row].category;
    if (by_windows) {
      pictures[row] = {.category = category,
                       .grey = eye.Clean(grey),
                       .box = boxed.contains(category) ? std::optional(box) : std::nullopt};
      return {};
    }
    VICTORIOUS_ASSIGN_OR_RETURN(of_row[row], ExamplesOf(eye, grey, box, category, static_cast<int>(row)));
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(ForEachPicture(folder, rows, look, done));
  if (by_windows) return TrainOnWindows(eye, pictures, options);
  std::vector<CategoryExample> examples;
  for (auto& some : of_row) std::ranges::move(some, std::back_inserter(examples));
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model, TrainCategories(examples, options.category));
  model.features_json = OptionsToJsonText(options.features);
  return model;
}

namespace {

// Of windows: each node's highest score; of none of the things, that of the window likeliest to show one.
Expected<ClassifiedPicture> ClassifyInWindows(const CategoryEye& eye, const CategoryModel& model, const cv::Mat& grey) {
  const WindowOptions& options = eye.options().windows;
  std::vector<std::size_t> things;
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (model.nodes[n].name != options.none) things.push_back(n);
  const std::vector<SeenWindow> windows =
      LookThroughWindows(model, eye.Clean(grey), eye.options().dense, options, things);
  if (windows.empty()) {  // nothing to see
    WordedPicture nothing =
        WordsOf(model, {.keypoints = {}, .descriptors = {}, .image_width = grey.cols, .image_height = grey.rows});
    CategoryResult result = Classify(model, nothing, CategoryMethod::kPhrases);
    return ClassifiedPicture{
        std::move(result), {0, 0, static_cast<double>(grey.cols), static_cast<double>(grey.rows)}, std::move(nothing)};
  }
  const SeenWindow* chosen = &windows.front();
  CategoryResult result = chosen->result;
  for (const SeenWindow& window : windows) {
    for (const std::size_t node : things) {
      if (window.result.scores[node].probability <= result.scores[node].probability) continue;
      result.scores[node] = window.result.scores[node];
      const CategoryNode& named = model.nodes[node];
      if (!named.labels || result.scores[node].probability <= result.scores[result.label].probability) continue;
      result.label = node;
      chosen = &window;
    }
  }
  return ClassifiedPicture{std::move(result), chosen->box, chosen->picture};
}

}  // namespace

Expected<ClassifiedPicture> ClassifyPicture(const CategoryEye& eye, const CategoryModel& model, const cv::Mat& grey,
                                            CategoryMethod method) {
  if (eye.options().windows.enabled) {
    if (method == CategoryMethod::kPhrases) return ClassifyInWindows(eye, model, grey);
    return Fail(ErrorCode::kInvalidArgument, "words alone are for models of whole pictures: this one is of windows");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, eye.Look(grey));
  WordedPicture picture = WordsOf(model, features);
  CategoryResult result = Classify(model, picture, method);
  return ClassifiedPicture{
      std::move(result), {0, 0, static_cast<double>(grey.cols), static_cast<double>(grey.rows)}, std::move(picture)};
}

}  // namespace victorious
