#include "victorious/category/finder/category_images.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/core.hpp>

#include "victorious/base/random.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/image/impulse_noise.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {

void CategoryFeatureOptions::ListFields(FieldList& fields) {
  fields.Add("kind", kind, kCategoryFeatureKindTexts,
             {.reason = "dense: descriptors on a grid, also at low contrast; keypoints: SIFT, as the thesis"});
  fields.Add("engine", engine,
             {.choices = FeatureEngines(), .reason = "feature extractor of keypoints; the model keeps its name"});
  fields.Add("surroundings", surroundings, kSurroundingsTexts,
             {.reason = "use of the whole image around a box. learn: an example like the crop, since images to "
                        "classify have surroundings; calibrate: only to calibrate probabilities; none: not used"});
  fields.Add("mirrored", mirrored,
             {.reason = "learn from the mirror image of each image, too, except for categories that are mirror images "
                        "of each other according to held-out images"});
  fields.AddGroup("dense", dense);
  fields.AddGroup("windows", windows);
}

void CategoryTrainOptions::ListFields(FieldList& fields) {
  fields.AddGroup("features", features);
  fields.AddGroup("examples", examples);
  fields.AddGroup("cad", cad);
  fields.AddGroup("channels", channels);
  category.ListFields(fields);
}

Expected<CategoryFeaturizer> CategoryFeaturizer::Create(const CategoryFeatureOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (options.windows.enabled && options.kind != CategoryFeatureKind::kDense)
    return Fail(ErrorCode::kInvalidArgument, "windows.enabled: requires features on a grid: kind must be dense");
  constexpr int kMaxEnlarged = 2;  // further enlargement costs memory and adds no information
  if (options.windows.enabled && options.windows.side_px > kMaxEnlarged * options.windows.min_window_px) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "windows.min_window_px {}: must be at least half of windows.side_px {}, so that images are enlarged "
            "at most twice",
            options.windows.min_window_px, options.windows.side_px));
  }
  CategoryFeaturizer featurizer;
  featurizer.options_ = options;
  FeatureOptions keypoints;
  keypoints.engine = options.engine;
  VICTORIOUS_ASSIGN_OR_RETURN(featurizer.extractor_, MakeFeatureExtractor(keypoints));
  return featurizer;
}

Expected<CategoryFeaturizer> CategoryFeaturizer::Of(const CategoryModel& model) {
  CategoryFeatureOptions options;
  options.engine = "opencv";  // of the models from before the engine was stored
  if (const Status status = SetFromJsonText(model.features_json, CollectFields(options)); !status)
    return Fail(ErrorCode::kDataLoss,
                fmt::format("category model: feature options: {}: train again", status.error().message));
  if (options.windows.enabled && model.linear() == nullptr)
    return Fail(ErrorCode::kDataLoss, "category model: windows require scoring linear: train again");
  return Create(options);
}

Expected<FeatureSet> CategoryFeaturizer::Extract(const cv::Mat& grey) const {
  if (options_.kind == CategoryFeatureKind::kDense) return DenseFeatures(grey, options_.dense);
  return extractor_->Extract(grey);
}

cv::Mat CategoryFeaturizer::Clean(const cv::Mat& grey) const {
  return RemoveImpulses(grey, FeatureOptions().impulse_fraction);
}

Expected<std::vector<CategoryExample>> ExamplesOf(const CategoryFeaturizer& featurizer, const cv::Mat& grey,
                                                  const Box& box, const std::string& category, int number,
                                                  bool own_surroundings) {
  const int x0 = std::clamp(static_cast<int>(std::floor(box.x)), 0, grey.cols - 1);
  const int y0 = std::clamp(static_cast<int>(std::floor(box.y)), 0, grey.rows - 1);
  const int x1 = std::clamp(static_cast<int>(std::ceil(box.x + box.width)), x0 + 1, grey.cols);
  const int y1 = std::clamp(static_cast<int>(std::ceil(box.y + box.height)), y0 + 1, grey.rows);
  const cv::Rect part(x0, y0, x1 - x0, y1 - y0);
  const bool with_whole =
      own_surroundings && part.size() != grey.size() && featurizer.options().surroundings != Surroundings::kNone;
  std::vector<CategoryExample> examples;
  const auto add = [&](const cv::Mat& seen, bool used_for_training, bool used_for_calibration,
                       bool mirrored = false) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet features, featurizer.Extract(seen));
    examples.push_back({.category = category,
                        .features = std::move(features),
                        .image = number,
                        .used_for_training = used_for_training,
                        .used_for_calibration = used_for_calibration,
                        .mirrored = mirrored});
    return {};
  };
  const auto add_mirrored = [&](const cv::Mat& seen) -> Status {
    if (!featurizer.options().mirrored) return {};
    cv::Mat mirrored;
    cv::flip(seen, mirrored, 1);
    return add(mirrored, /*used_for_training=*/true, /*used_for_calibration=*/false, /*mirrored=*/true);
  };
  const cv::Mat cut_out = grey(part).clone();
  VICTORIOUS_RETURN_IF_ERROR(add(cut_out, /*used_for_training=*/true, /*used_for_calibration=*/!with_whole));
  VICTORIOUS_RETURN_IF_ERROR(add_mirrored(cut_out));
  if (!with_whole) return examples;
  const bool used_for_training = featurizer.options().surroundings == Surroundings::kLearn;
  VICTORIOUS_RETURN_IF_ERROR(add(grey, used_for_training, /*used_for_calibration=*/true));
  if (used_for_training) VICTORIOUS_RETURN_IF_ERROR(add_mirrored(grey));
  return examples;
}

namespace {

// Calls `work` with each index below `count`, in any order, on all cores. Returns the error of the lowest index;
// rethrows exceptions.
Status ParallelFor(std::size_t count, const std::function<Status(std::size_t)>& work,
                   const std::function<void(std::size_t)>& done = {}) {
  std::mutex mutex;  // guards what follows
  std::size_t finished = 0;
  std::atomic<std::size_t> first_failure = count;  // also read without the mutex
  Status status;
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (i > first_failure) return;  // lower indices still run: one of them may fail, too
    Status one = work(i);
    const std::scoped_lock lock(mutex);
    if (one) {
      ++finished;
      if (done) done(finished);
    } else if (i < first_failure) {
      first_failure = i;
      status = std::move(one);
    }
  });
  return status;
}

}  // namespace

Status ForEachImage(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                    const std::function<Status(std::size_t row, const cv::Mat& bgr)>& use,
                    const std::function<void(std::size_t)>& done) {
  const auto read = [&](std::size_t row) -> Status {
    Expected<Image> image = ReadImage(folder / rows[row].image);
    if (!image) return std::unexpected(std::move(image).error().WithContext(rows[row].where));
    return use(row, image->bgr);
  };
  return ParallelFor(rows.size(), read, done);
}

namespace {

struct SortedRows {
  std::vector<CategoryListRow> images;
  std::vector<CategoryListRow> cad_files;
  std::set<std::string> object_categories;      // object categories: those with a box or a CAD file
  std::set<std::string> background_categories;  // background: the others, neither above nor below an object category
};

Expected<SortedRows> SortRows(std::span<const CategoryListRow> rows) {
  SortedRows sorted;
  for (const CategoryListRow& row : rows) {
    if (row.category.empty())
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: no category: name the category that the image shows", row.where));
    const bool cad = IsCadFile(row.image);
    if (cad && row.box)
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: a box: not allowed for a CAD file", row.where));
    if (cad || row.box) sorted.object_categories.insert(row.category);
    (cad ? sorted.cad_files : sorted.images).push_back(row);
  }
  for (const CategoryListRow& row : sorted.images) {
    const bool is_object = std::ranges::any_of(sorted.object_categories, [&](const std::string& object) {
      return IsWithin(object, row.category) || IsWithin(row.category, object);
    });
    if (!is_object) sorted.background_categories.insert(row.category);
  }
  if (!sorted.cad_files.empty() && sorted.background_categories.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a CAD file requires background images: add a category without boxes and without CAD "
                            "files, for example background",
                            sorted.cad_files.front().where));
  }
  return sorted;
}

// The renderings of a CAD file in front of the backgrounds.
Expected<std::vector<LabelledImage>> ReadCad(const std::filesystem::path& folder, const CategoryListRow& row,
                                             std::span<const cv::Mat> backgrounds, const CategoryTrainOptions& options,
                                             std::uint64_t seed, const std::function<void(const std::string&)>& warn) {
  Expected<LoadedMesh> loaded = LoadMesh(folder / row.image);
  if (!loaded) return std::unexpected(std::move(loaded).error().WithContext(row.where));
  for (const std::string& warning : loaded->warnings)
    if (warn) warn(fmt::format("{}: {}", row.image, warning));
  auto images = RenderCadExamples(loaded->mesh, row.category, backgrounds, options.cad, seed);
  if (!images) return std::unexpected(std::move(images).error().WithContext(row.where));
  return images;
}

}  // namespace

Expected<CategoryModel> TrainOnList(const std::filesystem::path& folder, std::span<const CategoryListRow> rows,
                                    const CategoryTrainOptions& options, const std::function<void(std::size_t)>& done,
                                    const std::function<void(const std::string&)>& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  VICTORIOUS_ASSIGN_OR_RETURN(const SortedRows sorted, SortRows(rows));
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryFeaturizer featurizer, CategoryFeaturizer::Create(options.features));
  const bool by_windows = options.features.windows.enabled;
  if (by_windows && options.category.scoring != CategoryScoring::kLinear)
    return Fail(ErrorCode::kInvalidArgument, "features.windows.enabled: requires scoring linear");
  if (!sorted.cad_files.empty()) {
    VICTORIOUS_RETURN_IF_ERROR(CheckRange(options.cad));
    if (sorted.background_categories.size() > 1 && warn)
      warn(fmt::format("CAD files are rendered in front of the images of {}, taken as background",
                       fmt::join(sorted.background_categories, ", ")));
  }

  const std::size_t count = sorted.images.size();
  std::vector<std::vector<CategoryExample>> of_image(count);
  std::vector<LabelledImage> images(by_windows ? count : 0);
  std::vector<cv::Mat> backgrounds(sorted.cad_files.empty() ? 0 : count);  // for CAD files
  const auto prepare = [&](std::size_t row, const cv::Mat& bgr) -> Status {
    const CategoryListRow& listed = sorted.images[row];
    const cv::Mat grey = GreyFromBgr(bgr);
    VICTORIOUS_ASSIGN_OR_RETURN(const Box box, ClippedBox(listed, grey.cols, grey.rows));
    const bool is_object = sorted.object_categories.contains(listed.category);
    const cv::Mat seen = by_windows ? featurizer.Clean(grey) : grey;
    if (!backgrounds.empty() && sorted.background_categories.contains(listed.category))
      backgrounds[row] = ResizeBackgroundForCad(seen);
    if (by_windows) {
      images[row] = {.category = listed.category, .grey = seen, .box = is_object ? std::optional(box) : std::nullopt};
      return {};
    }
    VICTORIOUS_ASSIGN_OR_RETURN(of_image[row],
                                ExamplesOf(featurizer, grey, box, listed.category, static_cast<int>(row)));
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(ForEachImage(folder, sorted.images, prepare, done));

  std::erase_if(backgrounds, [](const cv::Mat& image) { return image.empty(); });
  for (std::size_t i = 0; i < sorted.cad_files.size(); ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        std::vector<LabelledImage> drawn,
        ReadCad(folder, sorted.cad_files[i], backgrounds, options, MixSeed(options.category.seed, i), warn));
    if (by_windows) {
      std::ranges::move(drawn, std::back_inserter(images));
    } else {
      // Renderings of one CAD file are held out together, so that another CAD file is used for calibration, if the
      // category has one.
      const bool alone =
          1 == std::ranges::count(sorted.cad_files, sorted.cad_files[i].category, &CategoryListRow::category);
      const std::size_t first = of_image.size();
      of_image.resize(first + drawn.size());
      VICTORIOUS_RETURN_IF_ERROR(ParallelFor(drawn.size(), [&](std::size_t d) -> Status {
        VICTORIOUS_ASSIGN_OR_RETURN(
            of_image[first + d], ExamplesOf(featurizer, drawn[d].grey, *drawn[d].box, drawn[d].category,
                                            static_cast<int>(alone ? first + d : first), /*own_surroundings=*/false));
        return {};
      }));
    }
    done(count + i + 1);
  }

  if (by_windows) return TrainOnWindows(featurizer, images, options);
  std::vector<CategoryExample> examples;
  for (auto& some : of_image) std::ranges::move(some, std::back_inserter(examples));
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model, TrainCategories(examples, options.category));
  model.features_json = OptionsToJsonText(options.features);
  return model;
}

namespace {

// The maximum score of each object category over the windows; for the background the score of the window that is most
// likely to show an object.
Expected<ClassifiedImage> ClassifyInWindows(const CategoryFeaturizer& featurizer, const CategoryModel& model,
                                            const cv::Mat& grey) {
  const WindowOptions& options = featurizer.options().windows;
  std::vector<std::size_t> object_nodes;
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    if (!model.windows || model.nodes[n].name != model.windows->background_category) object_nodes.push_back(n);
  const std::vector<ScoredWindow> windows =
      ClassifyWindows(model, featurizer.Clean(grey), featurizer.options().dense, options, object_nodes);
  if (windows.empty()) {  // no features
    QuantisedImage nothing = QuantiseFeatures(
        model, {.keypoints = {}, .descriptors = {}, .image_width = grey.cols, .image_height = grey.rows});
    CategoryResult result = Classify(model, nothing, CategoryMethod::kPhrases);
    return ClassifiedImage{std::move(result), FrameBox(grey.cols, grey.rows), std::move(nothing)};
  }
  const ScoredWindow* chosen = &windows.front();
  CategoryResult result = chosen->result;
  for (const ScoredWindow& window : windows) {
    for (const std::size_t node : object_nodes) {
      if (window.result.scores[node].probability <= result.scores[node].probability) continue;
      result.scores[node] = window.result.scores[node];
      const CategoryNode& named = model.nodes[node];
      if (!named.can_be_label || result.scores[node].probability <= result.scores[result.label].probability) continue;
      result.label = node;
      chosen = &window;
    }
  }
  return ClassifiedImage{std::move(result), chosen->box, chosen->image};
}

}  // namespace

Expected<ClassifiedImage> ClassifyImage(const CategoryFeaturizer& featurizer, const CategoryModel& model,
                                        const cv::Mat& grey, CategoryMethod method) {
  if (featurizer.options().windows.enabled) {
    if (method == CategoryMethod::kPhrases) return ClassifyInWindows(featurizer, model, grey);
    return Fail(ErrorCode::kInvalidArgument,
                "method words: requires a model of whole images: this model is of windows");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet features, featurizer.Extract(grey));
  QuantisedImage image = QuantiseFeatures(model, features);
  CategoryResult result = Classify(model, image, method);
  return ClassifiedImage{std::move(result), FrameBox(grey.cols, grey.rows), std::move(image)};
}

}  // namespace victorious
