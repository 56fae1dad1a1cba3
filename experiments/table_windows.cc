// Several small objects in a frame: images of Caltech-101 pasted into larger background frames, searched with sliding
// windows and as a whole. Not a table of the thesis.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/category/finder/category_finder.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/preset.h"

namespace victorious {
namespace {

const std::array<std::string, 4> kCategories = {kAirplanes, kCars, "Motorbikes", kBackground};
const cv::Size kFrame = {640, 480};
constexpr int kSeedFrames = 60;  // per seed
constexpr int kMaxObjects = 3;

struct PastedObject {
  std::string category;
  Box box;
};

struct PastedScene {
  cv::Mat grey;
  std::vector<PastedObject> objects;
};

Expected<cv::Mat> ReadGrey(const ExperimentSettings& settings, const CategoryListRow& row) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(settings.data / "caltech101" / row.image));
  return GreyFromBgr(image.bgr);
}

// Fills the frame with the centre of an image.
cv::Mat FillFrame(const cv::Mat& grey) {
  const double scale =
      std::max(static_cast<double>(kFrame.width) / grey.cols, static_cast<double>(kFrame.height) / grey.rows);
  cv::Mat large;
  cv::resize(grey, large, {}, scale * 1.001, scale * 1.001, cv::INTER_LINEAR);
  const cv::Rect middle((large.cols - kFrame.width) / 2, (large.rows - kFrame.height) / 2, kFrame.width, kFrame.height);
  return large(middle & cv::Rect({0, 0}, large.size())).clone();
}

// Pastes the image at a random free place, scaled so that the longer side of its object's box is `side_px`.
void Paste(const cv::Mat& grey, const CategoryListRow& row, double side_px, Random& random, PastedScene& scene) {
  const Box box = ClippedBox(row, grey.cols, grey.rows).value();
  const double scale = side_px / std::max(box.width, box.height);
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (small.cols >= kFrame.width || small.rows >= kFrame.height) return;
  constexpr int kTries = 30;
  for (int i = 0; i < kTries; ++i) {
    const cv::Point at(static_cast<int>(random.Below(static_cast<std::uint32_t>(kFrame.width - small.cols))),
                       static_cast<int>(random.Below(static_cast<std::uint32_t>(kFrame.height - small.rows))));
    const Box object{at.x + scale * box.x, at.y + scale * box.y, scale * box.width, scale * box.height};
    const Box whole{static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(small.cols),
                    static_cast<double>(small.rows)};
    const auto in_the_way = [&](const PastedObject& other) { return !Intersection(other.box, whole).IsEmpty(); };
    if (std::ranges::any_of(scene.objects, in_the_way)) continue;
    small.copyTo(scene.grey(cv::Rect(at, small.size())));
    scene.objects.push_back({row.category, object});
    return;
  }
}

Expected<std::vector<PastedScene>> MakeScenes(const ExperimentSettings& settings, std::span<const CategoryListRow> rows,
                                              std::span<const std::size_t> test, std::uint64_t seed) {
  std::map<std::string, std::vector<std::size_t>> of_category;
  for (const std::size_t row : test) {
    if (rows[row].box || rows[row].category == kBackground) of_category[rows[row].category].push_back(row);
  }
  Random random(seed);
  const auto any_of = [&](const std::string& category) {
    const std::vector<std::size_t>& members = of_category[category];
    return rows[members[random.Below(static_cast<std::uint32_t>(members.size()))]];
  };
  std::vector<PastedScene> scenes;
  for (int i = 0; i < kSeedFrames; ++i) {
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat background, ReadGrey(settings, any_of(kBackground)));
    PastedScene& scene = scenes.emplace_back(PastedScene{FillFrame(background), {}});
    for (int k = 0; k < i % (kMaxObjects + 1); ++k) {
      constexpr double kSmallest_px = 80;
      constexpr double kLargest_px = 200;
      const CategoryListRow row = any_of(kCategories[random.Below(kCategories.size() - 1)]);
      VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat grey, ReadGrey(settings, row));
      Paste(grey, row, kSmallest_px * std::pow(kLargest_px / kSmallest_px, random.Uniform()), random, scene);
    }
  }
  return scenes;
}

// One value per seed; %, except the last.
struct SearchFigures {
  std::vector<double> found;
  std::vector<double> right;
  std::vector<double> overlap;
  std::vector<double> empty_frames_with_finds;
  std::vector<double> frames_a_second;
};

Status MeasureInto(SearchFigures& figures, const CategoryFinder& finder, std::span<const PastedScene> scenes) {
  double objects = 0;
  double found = 0;
  double finds = 0;
  double overlap = 0;
  double empty = 0;
  double empty_with_finds = 0;
  const auto start = std::chrono::steady_clock::now();
  for (const PastedScene& scene : scenes) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<FoundCategory> all, finder.Find(scene.grey));
    objects += static_cast<double>(scene.objects.size());
    finds += static_cast<double>(all.size());
    empty += scene.objects.empty() ? 1 : 0;
    empty_with_finds += scene.objects.empty() && !all.empty() ? 1 : 0;
    for (const PastedObject& object : scene.objects) {
      double best = 0;
      for (const FoundCategory& one : all) {
        if (finder.names()[one.category] != object.category) continue;
        best = std::max(best, IntersectionOverUnion(one.box, object.box));
      }
      constexpr double kMinOverlap = 0.25;
      if (best < kMinOverlap) continue;
      ++found;
      overlap += best;
    }
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  figures.found.push_back(100 * found / objects);
  figures.right.push_back(finds > 0 ? 100 * found / finds : 0);
  figures.overlap.push_back(found > 0 ? 100 * overlap / found : 0);
  figures.empty_frames_with_finds.push_back(100 * empty_with_finds / empty);
  figures.frames_a_second.push_back(static_cast<double>(scenes.size()) / elapsed.count());
  return {};
}

}  // namespace

Expected<Report> RunTableWindows(const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCaltechRows(settings, kCategories));
  CategoryTrainOptions windows;
  VICTORIOUS_CHECK(ApplyPreset(Preset::kWindows, windows).has_value());
  const std::array<std::pair<std::string, CategoryTrainOptions>, 2> ways = {
      std::pair{std::string("windows"), windows}, std::pair{std::string("whole frame"), CategoryTrainOptions()}};
  std::array<SearchFigures, 2> figures;
  for (int seed = 1; seed <= settings.seeds; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const Split split = MakeRandomSplit(rows, number);
    std::vector<CategoryListRow> train;
    for (const std::size_t row : split.train) train.push_back(rows[row]);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PastedScene> scenes, MakeScenes(settings, rows, split.test, number));
    for (std::size_t way = 0; way < ways.size(); ++way) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      CategoryTrainOptions options = ways[way].second;
      options.category.seed = number;
      VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model,
                                  TrainOnList(settings.data / "caltech101", train, options, [](std::size_t) {}));
      VICTORIOUS_ASSIGN_OR_RETURN(const CategoryFinder finder,
                                  CategoryFinder::Create(std::move(model), {.background = kBackground}));
      VICTORIOUS_RETURN_IF_ERROR(MeasureInto(figures[way], finder, scenes));
      settings.progress(fmt::format("seed {}, {}: recall {:.1f} %, precision {:.1f} %", seed, ways[way].first,
                                    figures[way].found.back(), figures[way].right.back()));
    }
  }
  Report report{.title = "Small objects in larger frames: airplanes, cars and motorbikes of 80 to 200 px in 640 x 480",
                .columns = {"search", "objects found, %", "precision, %", "overlap of true detections, %",
                            "empty frames with detections, %", "frames/s of one thread"}};
  for (std::size_t way = 0; way < ways.size(); ++way) {
    const SearchFigures& one = figures[way];
    report.rows.push_back({ways[way].first, ComputeMean(one.found), ComputeMean(one.right), ComputeMean(one.overlap),
                           ComputeMean(one.empty_frames_with_finds), ComputeMean(one.frames_a_second)});
  }
  report.notes = {
      fmt::format("{} seeds of {} frames, with zero to three test images pasted into a test image of the "
                  "background. Found: the correct category with an IoU of 0.25 or more with the annotated box and "
                  "a probability of 0.5 or more. {}.",
                  settings.seeds, kSeedFrames, kSplitNote)};
  return report;
}

}  // namespace victorious
