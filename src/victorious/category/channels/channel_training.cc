#include "victorious/category/channels/channel_training.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/base/options.h"
#include "victorious/base/random.h"
#include "victorious/base/version.h"
#include "victorious/category/channels/boosted_trees.h"
#include "victorious/category/channels/channel_windows.h"
#include "victorious/kernels/window_trees.h"

namespace victorious {
namespace {

constexpr double kHeadingStep_rad = std::numbers::pi / kHeadings;
constexpr double kClearRatio = 1.6;  // of length and width: the box's sides tell the heading
constexpr double kElongated = 1.3;   // of most objects of a category that has headings
constexpr double kMaxNegativeOverlap = 0.4;
constexpr double kMinAslantOverlap = 0.65;
constexpr double kFoundOverlap = 0.5;
constexpr double kShift_cells = 0.6;  // of positives, to each side
constexpr double kSizeOctaves = 0.16;

double RatioOf(const Box& box) { return std::max(box.width, box.height) / std::min(box.width, box.height); }

// An image, and its objects of one category.
struct TrainingImage {
  const BoxedImage* image = nullptr;
  std::vector<Box> boxes;

  [[nodiscard]] bool IsIgnored(const Box& box) const {
    return std::ranges::any_of(image->ignored, [&](const Box& region) {
      return region.Contains(box.x + box.width / 2, box.y + box.height / 2);
    });
  }
  [[nodiscard]] std::pair<double, std::size_t> NearestOf(const Box& box) const {
    std::pair<double, std::size_t> best(0, 0);
    for (std::size_t i = 0; i < boxes.size(); ++i) best = std::max(best, {IntersectionOverUnion(boxes[i], box), i});
    return best;
  }
  // An object that the image's border cuts shows neither its size nor its heading.
  [[nodiscard]] bool IsCut(const Box& box) const {
    return box.x < 1 || box.y < 1 || box.x + box.width > image->image.cols - 1 ||
           box.y + box.height > image->image.rows - 1;
  }
};

// The shape of a category's objects.
ChannelCategory ShapeOf(const std::string& name, std::span<const TrainingImage> images, bool turns) {
  std::vector<double> ratios;
  std::vector<double> clear;
  std::vector<double> widths;
  for (const TrainingImage& one : images) {
    for (const Box& box : one.boxes) {
      ratios.push_back(RatioOf(box));
      if (ratios.back() >= kClearRatio) clear.push_back(ratios.back());
      widths.push_back(std::sqrt(box.width / box.height));
    }
  }
  ChannelCategory category{.name = name};
  category.turns = turns && !clear.empty() && Median(ratios) >= kElongated;
  category.length = category.turns ? std::sqrt(Median(clear)) : Median(widths);
  category.width = 1 / category.length;
  category.detectors.resize(category.turns ? kTrainedHeadings : 1);
  return category;
}

// Whether a box of an image is an example: whole, not too small, and elongated if its heading counts.
bool IsExample(const TrainingImage& one, const Box& box, bool turns, double min_cell_px) {
  constexpr double kMinSize = 0.7;
  if (one.IsCut(box) || std::sqrt(box.Area()) / kObjectCells < kMinSize * min_cell_px) return false;
  return !turns || RatioOf(box) >= kClearRatio;
}

// Error: kInvalidArgument if too few boxes are examples, or their shape is none that a detector has.
Status CheckExamples(std::span<const TrainingImage> images, const ChannelCategory& category, double min_cell_px,
                     double min_object_px) {
  std::int64_t boxes = 0;
  std::int64_t examples = 0;
  for (const TrainingImage& one : images) {
    boxes += std::ssize(one.boxes);
    examples += std::ranges::count_if(one.boxes,
                                      [&](const Box& box) { return IsExample(one, box, category.turns, min_cell_px); });
  }
  if (examples < kMinChannelBoxes) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} of {} boxes are whole, and large enough for channels.min_object_px = {:g}{}: a "
                            "detector needs at least {}",
                            category.name, examples, boxes, min_object_px,
                            category.turns ? ", and clearly longer than wide" : "", kMinChannelBoxes));
  }
  if (std::max(category.length, category.width) <= kMaxChannelLength) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: its boxes are {:.0f} times as long as wide: a detector takes up to {:.0f}",
                          category.name, std::max(category.length / category.width, category.width / category.length),
                          kMaxChannelLength * kMaxChannelLength));
}

// A window, and the trained heading that it is an example for.
struct HeadingExample {
  int trained = 0;
  int score = 0;
  WindowFeatures features;
};

class CategoryTrainer {
 public:
  CategoryTrainer(std::vector<TrainingImage> images, ChannelCategory shape, const ChannelTrainOptions& options,
                  std::uint64_t seed)
      : images_(std::move(images)), category_(std::move(shape)), options_(options), random_(seed) {
    examples_.resize(category_.detectors.size());
    for (BoostExamples& some : examples_) some.features = kWindowFeatures;
  }

  ChannelCategory Train(double min_cell_px) {
    for (const TrainingImage& one : images_) AddPositives(one, min_cell_px);
    for (const TrainingImage& one : images_) AddRandomNegatives(one, min_cell_px);
    for (int round = 0; round < options_.rounds; ++round) {
      if (round > 0) AddHardExamples(min_cell_px);
      const int trees = std::max(options_.trees >> (options_.rounds - 1 - round), 4 * kStage);
      for (std::size_t h = 0; h < examples_.size(); ++h) {
        category_.detectors[h] = TrainTrees(examples_[h], {.trees = std::min(trees, options_.trees)}, random_.Next());
      }
    }
    return category_;
  }

 private:
  static constexpr int kStage = kernels::kTreesPerStage;

  [[nodiscard]] int HeadingOfCopies(int trained) const { return category_.turns ? trained : 0; }

  void AddPositives(const TrainingImage& one, double min_cell_px) {
    const WindowCutter cutter(one.image->image);
    for (const Box& box : one.boxes) {
      if (!IsExample(one, box, category_.turns, min_cell_px)) continue;
      const double cell_px = std::sqrt(box.Area()) / kObjectCells;
      for (std::size_t h = 0; h < examples_.size(); ++h) {
        for (int copy = 0; copy < options_.copies; ++copy) {
          const bool mirrored = random_.Below(2) == 1;
          double turn = random_.Uniform(-0.5, 0.5) * kHeadingStep_rad;
          bool is_flipped = false;
          if (category_.turns) {
            const double heading = box.height > box.width ? std::numbers::pi / 2 : 0;
            turn += static_cast<double>(h) * kHeadingStep_rad + (mirrored ? heading : -heading) +
                    (random_.Below(2) == 1 ? std::numbers::pi : 0);
            is_flipped = mirrored;
          } else {
            // Left and right may be exchanged, up and down not: a mirror image across x, turned by half a turn.
            constexpr double kLess = 0.3;
            turn = kLess * turn + (mirrored ? std::numbers::pi : 0);
            is_flipped = mirrored;
          }
          const double size = std::exp2(random_.Uniform(-kSizeOctaves, kSizeOctaves));
          const double shift = kShift_cells * cell_px;
          const cv::Point2d middle(box.x + box.width / 2 + random_.Uniform(-shift, shift),
                                   box.y + box.height / 2 + random_.Uniform(-shift, shift));
          examples_[h].positives.push_back(cutter.Cut(middle, cell_px * size, turn, is_flipped));
        }
      }
    }
  }

  void AddRandomNegatives(const TrainingImage& one, double min_cell_px) {
    constexpr int kWindowsALevel = 16;
    ForEachLevel(one.image->image, min_cell_px, [&](const ChannelLevel& level) {
      for (int i = 0; i < kWindowsALevel; ++i) {
        const ChannelHit hit{
            .heading = static_cast<int>(random_.Below(static_cast<std::uint32_t>(HeadingsOf(category_)))),
            .x = static_cast<int>(random_.Below(static_cast<std::uint32_t>(level.WindowColumns()))),
            .y = static_cast<int>(random_.Below(static_cast<std::uint32_t>(level.WindowRows())))};
        const Box box = BoxOfHit(level, category_, hit);
        if (one.IsIgnored(box) || one.NearestOf(box).first >= kMaxNegativeOverlap) continue;
        const HeadingCopy copy = CopyOfHit(hit);
        examples_[static_cast<std::size_t>(copy.trained)].negatives.push_back(level.Features(hit.x, hit.y, copy));
      }
    });
  }

  [[nodiscard]] HeadingCopy CopyOfHit(const ChannelHit& hit) const {
    return category_.turns ? kHeadingCopies[static_cast<std::size_t>(hit.heading)] : HeadingCopy{};
  }

  // What the detectors of the last round find: false ones become negatives, objects aslant positives.
  void AddHardExamples(double min_cell_px) {
    std::vector<std::vector<WindowFeatures>> aslant(examples_.size());
    const std::size_t of_image =
        1 + static_cast<std::size_t>(options_.negatives) / (2 * std::max<std::size_t>(1, images_.size()));
    for (const TrainingImage& one : images_) {
      std::vector<HeadingExample> hard;
      std::vector<std::optional<HeadingExample>> of_box(one.boxes.size());
      ForEachLevel(one.image->image, min_cell_px,
                   [&](const ChannelLevel& level) { ExamineLevel(one, level, hard, of_box); });
      for (auto& example : of_box) {
        if (example) aslant[static_cast<std::size_t>(example->trained)].push_back(std::move(example->features));
      }
      std::ranges::stable_sort(hard, std::greater{}, &HeadingExample::score);
      std::vector<std::size_t> added(examples_.size());
      for (HeadingExample& example : hard) {
        const auto h = static_cast<std::size_t>(example.trained);
        if (added[h]++ < of_image) examples_[h].negatives.push_back(std::move(example.features));
      }
    }
    for (std::size_t h = 0; h < examples_.size(); ++h) {
      ForgetEasyNegatives(h);
      for (auto& features : aslant[h]) examples_[h].positives.push_back(std::move(features));
    }
  }

  void ExamineLevel(const TrainingImage& one, const ChannelLevel& level, std::vector<HeadingExample>& hard,
                    std::vector<std::optional<HeadingExample>>& of_box) const {
    std::vector<ChannelHit> hits = ScanLevel(level, category_);
    std::ranges::stable_sort(hits, std::greater{}, &ChannelHit::score);
    std::vector<ChannelHit> taken;
    constexpr std::size_t kMaxALevel = 100;
    for (const ChannelHit& hit : hits) {
      if (taken.size() >= kMaxALevel) break;
      const Box box = BoxOfHit(level, category_, hit);
      const auto [overlap, nearest] = one.NearestOf(box);
      const HeadingCopy copy = CopyOfHit(hit);
      if (overlap >= kMinAslantOverlap && category_.turns && RatioOf(one.boxes[nearest]) < kClearRatio &&
          !one.IsCut(one.boxes[nearest])) {
        auto& best = of_box[nearest];
        if (!best || best->score < hit.score) best = {copy.trained, hit.score, level.Features(hit.x, hit.y, copy)};
      }
      if (overlap >= kMaxNegativeOverlap || one.IsIgnored(box)) continue;
      const bool is_near = std::ranges::any_of(taken, [&](const ChannelHit& other) {
        return other.heading == hit.heading && std::abs(other.x - hit.x) < 2 && std::abs(other.y - hit.y) < 2;
      });
      if (is_near) continue;
      taken.push_back(hit);
      hard.push_back({copy.trained, hit.score, level.Features(hit.x, hit.y, copy)});
    }
  }

  void ForgetEasyNegatives(std::size_t h) {
    auto& negatives = examples_[h].negatives;
    const auto most = static_cast<std::size_t>(options_.negatives);
    if (negatives.size() <= most) return;
    std::vector<std::pair<int, std::size_t>> order;
    for (std::size_t i = 0; i < negatives.size(); ++i) {
      order.emplace_back(-ScoreExample(category_.detectors[h], negatives[i]), i);
    }
    std::ranges::sort(order);
    std::vector<WindowFeatures> kept;
    for (std::size_t i = 0; i < most; ++i) kept.push_back(std::move(negatives[order[i].second]));
    negatives = std::move(kept);
  }

  std::vector<TrainingImage> images_;
  ChannelCategory category_;
  ChannelTrainOptions options_;
  Random random_;
  std::vector<BoostExamples> examples_;  // of the trained headings
};

// Scores of what a detector finds in images that it has not seen, and whether they are right.
struct HeldOutScores {
  std::vector<double> scores;
  std::vector<bool> right;

  void Add(const ChannelModel& model, const TrainingImage& one) {
    std::vector<bool> is_taken(one.boxes.size());
    for (const ChannelBox& found : DetectByChannels(model, one.image->image, 0)) {
      if (one.IsIgnored(found.box)) continue;
      const auto [overlap, nearest] = one.NearestOf(found.box);
      const bool is_right = overlap >= kFoundOverlap && !is_taken[nearest];
      if (is_right) is_taken[nearest] = true;
      scores.push_back(found.score);
      right.push_back(is_right);
    }
  }

  // With the shares of right and wrong as found: Calibrate weighs both alike.
  [[nodiscard]] Calibration Fit() const {
    const auto positives = static_cast<double>(std::ranges::count(right, true));
    const double negatives = static_cast<double>(right.size()) - positives;
    if (positives < 1 || negatives < 1) return {};
    Calibration fit = Calibrate(scores, right);
    fit.offset += std::log(positives / negatives);
    return fit;
  }
};

std::vector<TrainingImage> ImagesOf(std::span<const BoxedImage> images, std::size_t category) {
  std::vector<TrainingImage> of_category;
  for (const BoxedImage& image : images) {
    of_category.push_back({.image = &image});
    for (const BoxedImage::Object& object : image.objects) {
      if (object.category == category) of_category.back().boxes.push_back(object.box);
    }
  }
  return of_category;
}

}  // namespace

void ChannelTrainOptions::ListFields(FieldList& fields) {
  fields.Add("min_object_px", min_object_px,
             {.min = 8, .max = 1000, .unit = "px", .reason = "length of the smallest objects that are searched for"});
  fields.Add(
      "turns", turns,
      {.reason = "objects have any heading in the image, as vehicles seen from above. false: they stand upright"});
  fields.Add("rounds", rounds,
             {.min = 1, .max = 10, .reason = "trainings, each with false positives of the one before"});
  fields.Add("trees", trees, {.min = 8, .max = 256, .reason = "boosted trees of a heading"});
  fields.Add("copies", copies,
             {.min = 1, .max = 100, .reason = "examples of an object and heading: moved, sized, turned"});
  fields.Add("negatives", negatives,
             {.min = 100, .max = 100000, .reason = "most windows without an object, of a heading"});
}

Expected<ChannelModel> TrainChannelDetector(std::span<const BoxedImage> images, const std::vector<std::string>& names,
                                            const ChannelTrainOptions& options, std::uint64_t seed) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  ChannelModel model{
      .program_version = kVersion, .images = static_cast<int>(images.size()), .min_object_px = options.min_object_px};
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::vector<TrainingImage> own = ImagesOf(images, c);
    std::size_t boxes = 0;
    for (const TrainingImage& one : own) boxes += one.boxes.size();
    if (boxes < kMinChannelBoxes) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: {} boxes: a detector needs at least {} of a category",
                                                           names[c], boxes, kMinChannelBoxes));
    }
    model.boxes += static_cast<int>(boxes);
    model.categories.push_back(ShapeOf(names[c], own, options.turns));
  }
  const double min_cell_px = MinCellOf(model);
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::vector<TrainingImage> own = ImagesOf(images, c);
    VICTORIOUS_RETURN_IF_ERROR(CheckExamples(own, model.categories[c], min_cell_px, options.min_object_px));
    const auto train = [&](const std::vector<TrainingImage>& some, std::uint64_t stream) {
      return CategoryTrainer(some, model.categories[c], options, MixSeed(seed, 4 * c + stream)).Train(min_cell_px);
    };
    HeldOutScores held_out;
    const auto half = static_cast<std::ptrdiff_t>(own.size() / 2);
    for (const bool first : {true, false}) {
      const std::vector<TrainingImage> seen(first ? own.begin() : own.begin() + half,
                                            first ? own.begin() + half : own.end());
      const std::vector<TrainingImage> unseen(first ? own.begin() + half : own.begin(),
                                              first ? own.end() : own.begin() + half);
      ChannelModel part{.min_object_px = options.min_object_px};
      part.categories.push_back(train(seen, first ? 1 : 2));
      for (const TrainingImage& one : unseen) held_out.Add(part, one);
    }
    model.categories[c] = train(own, 0);
    model.categories[c].calibration = held_out.Fit();
  }
  return model;
}

}  // namespace victorious
