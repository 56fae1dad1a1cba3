// Localisation of categories: the boxes of the supporting phrases compared with annotated boxes. Not a table of the
// thesis; its section 6.1 proposes it.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "victorious/category/explanation.h"

namespace victorious {
namespace {

// One value per seed: means over the test images, %.
struct Overlaps {
  std::vector<double> found;
  std::vector<double> whole;  // overlap of the whole image with the annotated box
  std::vector<double> half;   // fraction of images with an overlap of 0.5 or more
  std::vector<double> centre_inside;
  std::vector<double> centre_off;  // RMS offset along an axis over the longer side of the estimated box
};

Box WholeImageBox(const QuantisedImage& image) { return FrameBox(image.width, image.height); }

void MeasureInto(Overlaps& overlaps, const CategoryModel& model, const CaltechFeatures& features,
                 std::span<const std::size_t> test, const std::string& category) {
  const auto node =
      static_cast<std::size_t>(std::ranges::find(model.nodes, category, &CategoryNode::name) - model.nodes.begin());
  double count = 0;
  double found = 0;
  double whole = 0;
  double half = 0;
  double inside = 0;
  double off = 0;
  for (const std::size_t row : test) {
    const CategoryListRow& listed = features.rows()[row];
    if (listed.category != category || !listed.box) continue;
    const QuantisedImage image = QuantiseFeatures(model, features.WholeImage(row));
    const Box box = SupportingBox(ComputeContributions(model, image, node), image);
    const Box truth = Intersection(*listed.box, WholeImageBox(image));
    const double overlap = IntersectionOverUnion(box, truth);
    const double x = box.x + box.width / 2;
    const double y = box.y + box.height / 2;
    ++count;
    found += overlap;
    whole += IntersectionOverUnion(WholeImageBox(image), truth);
    half += overlap >= 0.5 ? 1 : 0;
    inside += x >= truth.x && x <= truth.x + truth.width && y >= truth.y && y <= truth.y + truth.height ? 1 : 0;
    off += (std::pow(x - truth.x - truth.width / 2, 2) + std::pow(y - truth.y - truth.height / 2, 2)) /
           (2 * std::pow(std::max(box.width, box.height), 2));
  }
  if (count == 0) return;
  overlaps.found.push_back(100 * found / count);
  overlaps.whole.push_back(100 * whole / count);
  overlaps.half.push_back(100 * half / count);
  overlaps.centre_inside.push_back(100 * inside / count);
  overlaps.centre_off.push_back(100 * std::sqrt(off / count));
}

}  // namespace

Expected<Report> RunTableBoxes(const ExperimentSettings& settings) {
  const std::array<std::string, 3> sought = {kAirplanes, kCars, kBackground};
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<CategoryListRow> rows, ReadCaltechRows(settings, sought));
  const CategoryTrainOptions options;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto features, CaltechFeatures::Load(settings, std::move(rows), options.features));
  const std::array<std::string, 2> boxed = {kAirplanes, kCars};
  std::array<Overlaps, 2> overlaps;
  for (int seed = 1; seed <= settings.seeds; ++seed) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    const Split split = MakeRandomSplit(features.rows(), static_cast<std::uint64_t>(seed));
    CategoryOptions seeded = options.category;
    seeded.seed = static_cast<std::uint64_t>(seed);
    VICTORIOUS_ASSIGN_OR_RETURN(const CategoryModel model, TrainCategories(features.ExamplesOf(split.train), seeded));
    for (std::size_t c = 0; c < boxed.size(); ++c) MeasureInto(overlaps[c], model, features, split.test, boxed[c]);
    settings.progress(fmt::format("seed {}", seed));
  }
  Report report{.title = "Boxes of the supporting phrases against annotated boxes, Caltech-101",
                .columns = {"category", "overlap, mean %", "overlap of the whole image, mean %",
                            "overlap of 0.5 or more, % of images", "centre inside the annotated box, % of images",
                            "centre offset along an axis, RMS, % of the box's longer side"}};
  for (std::size_t c = 0; c < boxed.size(); ++c) {
    const Overlaps& of = overlaps[c];
    report.rows.push_back({boxed[c], ComputeMean(of.found), ComputeMean(of.whole), ComputeMean(of.half),
                           ComputeMean(of.centre_inside), ComputeMean(of.centre_off)});
  }
  report.notes = {
      fmt::format("{} seeds; airplanes, cars and background, 30 training images each; the test images with an "
                  "annotated box. Overlap: intersection over union.",
                  settings.seeds)};
  return report;
}

}  // namespace victorious
