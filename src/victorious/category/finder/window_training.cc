#include "victorious/category/finder/window_training.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/category/finder/category_images.h"
#include "victorious/category/windows.h"

namespace victorious {
namespace {

// A training window to sample.
struct WindowSample {
  std::size_t image = 0;
  Box window;  // square, px of the image; may reach beyond it
  std::string category;
  bool mirrored = false;
  bool used_for_calibration = false;
};

// Fills the part of a window outside the image with a random piece of a background image: replicated borders would be a
// cue for objects near the edge.
cv::Mat CropWindow(const cv::Mat& grey, const Box& window, int side_px, const cv::Mat& background, Random& random) {
  const int side = std::max(1, cvRound(window.width));
  const cv::Rect wanted(cvRound(window.x), cvRound(window.y), side, side);
  const cv::Rect inside = wanted & cv::Rect({0, 0}, grey.size());
  cv::Mat cut;
  if (inside == wanted) {
    cut = grey(inside);
  } else {
    const int piece = std::min({side, background.cols, background.rows});
    const auto any = [&](int room) { return static_cast<int>(random.Below(static_cast<std::uint32_t>(room) + 1)); };
    const cv::Rect part(any(background.cols - piece), any(background.rows - piece), piece, piece);
    cv::resize(background(part), cut, wanted.size(), 0, 0, cv::INTER_LINEAR);
    grey(inside).copyTo(cut(inside - wanted.tl()));
  }
  cv::Mat resampled;
  cv::resize(cut, resampled, {side_px, side_px}, 0, 0, side > side_px ? cv::INTER_AREA : cv::INTER_LINEAR);
  return resampled;
}

// Shifts a window into the image; centres it along a side that is too short.
Box ShiftedIntoImage(Box window, const cv::Size& image) {
  const auto shift = [&](double at, int length) {
    return window.width <= length ? std::clamp(at, 0.0, length - window.width) : (length - window.width) / 2;
  };
  window.x = shift(window.x, image.width);
  window.y = shift(window.y, image.height);
  return window;
}

// The window around an object, jittered by up to half a step and half a scale factor as in a sliding-window search; not
// jittered for random == nullptr.
Box WindowAroundObject(const Box& box, const CategoryFeatureOptions& options, Random* random) {
  double side = kWindowContextFactor * std::max(box.width, box.height);
  double x = box.x + box.width / 2;
  double y = box.y + box.height / 2;
  if (random != nullptr) {
    side *= std::pow(kWindowSizeFactor, random->Uniform(-0.5, 0.5));
    const int step_px = kWindowStepGridPoints * options.dense.step_px;
    const double half_step = 0.5 * side * step_px / options.windows.side_px;
    x += random->Uniform(-half_step, half_step);
    y += random->Uniform(-half_step, half_step);
  }
  return {x - side / 2, y - side / 2, side, side};
}

// A window at a random position with a log-uniform side: small windows are more frequent, as in a search.
Box RandomWindow(const cv::Size& image, const WindowOptions& options, Random& random) {
  const double longest = std::min(image.width, image.height);
  const double shortest = std::min<double>(longest, options.min_window_px);
  const double side = shortest * std::pow(longest / shortest, random.Uniform());
  return {random.Uniform() * (image.width - side), random.Uniform() * (image.height - side), side, side};
}

bool IsCentredOnObject(const Box& window, const Box& about) {
  constexpr double kMinWindowOverlap = 0.4;
  return IntersectionOverUnion(window, about) >= kMinWindowOverlap;
}

std::vector<WindowSample> InitialSamples(std::span<const LabelledImage> images, const CategoryTrainOptions& options,
                                         const std::string& background) {
  const WindowOptions& windows = options.features.windows;
  std::vector<WindowSample> samples;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const LabelledImage& image = images[i];
    Random random(MixSeed(options.category.seed, i));
    if (!image.box) {
      for (int k = 0; k < options.examples.background; ++k)
        samples.push_back({i, RandomWindow(image.grey.size(), windows, random), image.category, false, true});
      continue;
    }
    for (int k = 0; k < options.examples.copies; ++k) {
      const Box window = ShiftedIntoImage(WindowAroundObject(*image.box, options.features, &random), image.grey.size());
      const bool mirrored = options.features.mirrored && k % 2 == 1;
      samples.push_back({i, window, image.category, mirrored, true});
    }
    // Windows with only a part of the object are negatives: a detection must be centred on the object.
    const Box about = WindowAroundObject(*image.box, options.features, nullptr);
    int parts = 0;
    constexpr int kTries = 20;
    constexpr double kMinOctaves = -1.5;  // of their sides, relative to a window around the object
    constexpr double kMaxOctaves = 0.5;
    constexpr double kMaxShift = 0.7;  // of their centres, relative to that window's side
    for (int k = 0; k < kTries && parts < options.examples.copies; ++k) {
      Box window = about;
      window.width = window.height = about.width * std::exp2(random.Uniform(kMinOctaves, kMaxOctaves));
      window.x += random.Uniform(-kMaxShift, kMaxShift) * about.width + (about.width - window.width) / 2;
      window.y += random.Uniform(-kMaxShift, kMaxShift) * about.height + (about.height - window.height) / 2;
      if (IsCentredOnObject(window, about) || window != ShiftedIntoImage(window, image.grey.size())) continue;
      samples.push_back({i, window, background, false, false});
      ++parts;
    }
  }
  return samples;
}

Expected<std::vector<CategoryExample>> ExamplesOf(const CategoryFeaturizer& featurizer,
                                                  std::span<const LabelledImage> images,
                                                  std::span<const WindowSample> samples) {
  std::vector<std::size_t> backgrounds;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (!images[i].box) backgrounds.push_back(i);
  std::vector<CategoryExample> examples(samples.size());
  std::vector<Status> statuses(samples.size());
  oneapi::tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t c) {
    const WindowSample& cut = samples[c];
    Random random(MixSeed(cut.image, c));
    const cv::Mat& beyond = images[backgrounds[random.Below(static_cast<std::uint32_t>(backgrounds.size()))]].grey;
    cv::Mat seen = CropWindow(images[cut.image].grey, cut.window, featurizer.options().windows.side_px, beyond, random);
    if (cut.mirrored) cv::flip(seen, seen, 1);
    Expected<FeatureSet> features = featurizer.Extract(seen);
    if (!features) {
      statuses[c] = std::unexpected(std::move(features).error());
      return;
    }
    examples[c] = {.category = cut.category,
                   .features = *std::move(features),
                   .image = static_cast<int>(cut.image),
                   .used_for_training = true,
                   .used_for_calibration = cut.used_for_calibration,
                   .mirrored = cut.mirrored};
  });
  for (const Status& status : statuses) VICTORIOUS_RETURN_IF_ERROR(status);
  return examples;
}

// Hard negatives: false positives of the model in background images and beside the objects.
std::vector<WindowSample> MineHardNegatives(const CategoryModel& model, std::span<const LabelledImage> images,
                                            const CategoryTrainOptions& options, const std::string& background) {
  std::vector<std::size_t> object_nodes;
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const auto shows = [&](const LabelledImage& image) {
      return image.box && TrainingTarget(image.category, model.nodes[n].name) > 0;
    };
    if (std::ranges::any_of(images, shows)) object_nodes.push_back(n);
  }
  std::vector<std::vector<WindowSample>> of_image(images.size());
  oneapi::tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
    const LabelledImage& image = images[i];
    const std::vector<ScoredWindow> windows =
        ClassifyWindows(model, image.grey, options.features.dense, options.features.windows, object_nodes);
    const Box about = image.box ? WindowAroundObject(*image.box, options.features, nullptr) : Box{};
    for (const ScoredWindow& window : windows) {
      if (image.box && IsCentredOnObject(window.box, about)) continue;
      if (of_image[i].size() == static_cast<std::size_t>(options.examples.hard_negatives)) break;
      const auto same = [&](const WindowSample& cut) { return IsSameObject(cut.window, window.box); };
      if (std::ranges::none_of(of_image[i], same))
        of_image[i].push_back({i, window.box, image.box ? background : image.category, false, !image.box});
    }
  });
  std::vector<WindowSample> samples;
  for (const auto& some : of_image) samples.insert(samples.end(), some.begin(), some.end());
  return samples;
}

// Mean number of windows of an image without boxes.
double WindowsPerBackground(std::span<const LabelledImage> images, const CategoryFeatureOptions& options) {
  double windows = 0;
  double backgrounds = 0;
  for (const LabelledImage& image : images) {
    if (image.box) continue;
    windows += static_cast<double>(WindowCount(image.grey.size(), options.dense.step_px, options.windows));
    ++backgrounds;
  }
  return windows / backgrounds;
}

}  // namespace

void WindowTrainOptions::ListFields(FieldList& fields) {
  fields.Add("copies", copies, {.min = 1, .max = 100, .reason = "jittered positive windows per object"});
  fields.Add("background", background,
             {.min = 1, .max = 1000, .reason = "random negative windows per background image"});
  fields.Add("hard_negatives", hard_negatives,
             {.min = 0,
              .max = 1000,
              .reason = "hard negatives per image: windows without an object that score highest under a first model"});
}

Expected<CategoryModel> TrainOnWindows(const CategoryFeaturizer& featurizer, std::span<const LabelledImage> images,
                                       const CategoryTrainOptions& options) {
  const auto background = std::ranges::find_if(images, [](const LabelledImage& image) { return !image.box; });
  if (background == images.end())
    return Fail(ErrorCode::kInvalidArgument,
                "windows require background images: add a category whose images have no boxes, for example background");
  std::set<std::string> boxed;
  for (const LabelledImage& image : images) {
    if (image.box) boxed.insert(image.category);
  }
  const auto another = std::ranges::find_if(images, [&](const LabelledImage& image) {
    return image.category != background->category && !boxed.contains(image.category);
  });
  if (another != images.end()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} and {}: neither has boxes; windows require exactly one background category without "
                            "boxes, and boxes for all others",
                            background->category, another->category));
  }
  std::vector<WindowSample> samples = InitialSamples(images, options, background->category);
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryExample> examples, ExamplesOf(featurizer, images, samples));
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model, TrainCategories(examples, options.category));
  if (options.examples.hard_negatives > 0) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        std::vector<CategoryExample> hard,
        ExamplesOf(featurizer, images, MineHardNegatives(model, images, options, background->category)));
    std::ranges::move(hard, std::back_inserter(examples));
    VICTORIOUS_ASSIGN_OR_RETURN(model, TrainCategories(examples, options.category));
  }
  model.features_json = OptionsToJsonText(options.features);
  model.windows = {.background_category = background->category,
                   .windows_per_background = WindowsPerBackground(images, options.features)};
  return model;
}

}  // namespace victorious
