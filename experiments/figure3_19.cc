// Figure 3.19: patches of training images that are quantised to the same visual word: one row for each of the tightest
// clusters among the words that occur in many images.
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "experiments/caltech.h"
#include "experiments/category_experiments.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

constexpr int kPatchPx = 48;
constexpr std::size_t kFigureRows = 8;
constexpr std::size_t kPatchesARow = 12;

struct Member {
  std::size_t row = 0;
  Keypoint keypoint;
  std::uint32_t distance2 = 0;
};

struct Cluster {
  std::uint32_t word = 0;
  std::vector<Member> members;  // by rising distance to the word
  std::size_t images = 0;
  double mean_distance = 0;
};

// The image patch of the descriptor, rotated upright, 12 scales wide.
cv::Mat PatchOf(const cv::Mat& bgr, const Keypoint& keypoint) {
  constexpr double kScalesAcross = 12;
  const double factor = kPatchPx / (kScalesAcross * keypoint.scale_px);
  cv::Mat map = cv::getRotationMatrix2D({keypoint.x - 0.5F, keypoint.y - 0.5F},
                                        DegreesFromRadians(keypoint.orientation_rad), factor);
  map.at<double>(0, 2) += kPatchPx / 2.0 - keypoint.x + 0.5;
  map.at<double>(1, 2) += kPatchPx / 2.0 - keypoint.y + 0.5;
  cv::Mat patch;
  cv::warpAffine(bgr, patch, map, {kPatchPx, kPatchPx}, cv::INTER_AREA, cv::BORDER_REPLICATE);
  return patch;
}

std::vector<Cluster> ClustersOf(const CaltechFeatures& features, const Split& split, const Vocabulary& vocabulary) {
  std::map<std::uint32_t, Cluster> clusters;
  for (const std::size_t row : split.train) {
    const FeatureSet& set = features.WholeImage(row);
    const auto words = vocabulary.NearestWords(set.descriptors, 1);
    for (std::size_t i = 0; i < words.size(); ++i)
      clusters[words[i].index].members.push_back({row, set.keypoints[i], words[i].distance2});
  }
  std::vector<Cluster> sorted;
  for (auto& [word, cluster] : clusters) {
    std::set<std::size_t> images;
    for (const Member& member : cluster.members) {
      images.insert(member.row);
      cluster.mean_distance += std::sqrt(member.distance2) / static_cast<double>(cluster.members.size());
    }
    cluster.word = word;
    cluster.images = images.size();
    std::ranges::stable_sort(cluster.members, {}, &Member::distance2);
    sorted.push_back(std::move(cluster));
  }
  std::erase_if(sorted,
                [](const Cluster& c) { return c.members.size() < kPatchesARow || c.images < kPatchesARow / 2; });
  std::ranges::stable_sort(sorted, {}, &Cluster::mean_distance);
  return sorted;
}

}  // namespace

Expected<Report> RunFigure319(const ExperimentSettings& settings) {
  const std::array<std::string, 2> pair = {kAirplanes, kCars};
  const CategoryTrainOptions options = ThesisCategories();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCaltechRows(settings, pair));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto features, CaltechFeatures::Load(settings, rows, options.features));
  const Split split = MakeRandomSplit(features.rows(), 1);
  std::vector<std::uint8_t> descriptors;
  for (const std::size_t row : split.train)
    descriptors.insert(descriptors.end(), features.WholeImage(row).descriptors.begin(),
                       features.WholeImage(row).descriptors.end());
  const Vocabulary vocabulary = Vocabulary::Learn(descriptors, options.category.vocabulary, 1);
  const std::vector<Cluster> clusters = ClustersOf(features, split, vocabulary);

  Report report{.title = "Visual words: the tightest clusters of patches from many images",
                .columns = {"word", "patches", "images", "mean distance to the word"}};
  PlotLine sizes{.name = "a visual word", .points = {}, .connected = false};
  std::map<std::size_t, cv::Mat> images;
  std::vector<cv::Mat> lines;
  for (const Cluster& cluster : clusters) {
    report.rows.push_back({static_cast<double>(cluster.word), static_cast<double>(cluster.members.size()),
                           static_cast<double>(cluster.images), cluster.mean_distance});
    sizes.points.push_back({static_cast<double>(cluster.members.size()), cluster.mean_distance});
    if (lines.size() >= kFigureRows) continue;
    std::vector<cv::Mat> patches;
    for (std::size_t i = 0; i < kPatchesARow; ++i) {
      const Member& member = cluster.members[i];
      cv::Mat& bgr = images[member.row];
      if (bgr.empty()) {
        VICTORIOUS_ASSIGN_OR_RETURN(const Image image,
                                    ReadImage(settings.data / "caltech101" / features.rows()[member.row].image));
        bgr = image.bgr;
      }
      cv::Mat highlighted;
      cv::copyMakeBorder(PatchOf(bgr, member.keypoint), highlighted, 1, 1, 1, 1, cv::BORDER_CONSTANT, {255, 255, 255});
      patches.push_back(highlighted);
    }
    cv::hconcat(patches, lines.emplace_back());
  }
  if (lines.empty()) return Fail(ErrorCode::kInvalidArgument, "figure3.19: no visual word occurs in enough images");
  cv::Mat sheet;
  cv::vconcat(lines, sheet);
  VICTORIOUS_RETURN_IF_ERROR(WriteImage(settings.out / "figure3.19.png", sheet));
  report.notes = {
      fmt::format("{} words of {} keypoints; words of at least {} patches are listed. figure3.19.png shows "
                  "the {} tightest, the patches nearest to the word first.",
                  vocabulary.size(), descriptors.size() / kDescriptorSize, kPatchesARow, kFigureRows)};
  report.plot = {.title = "Visual words of many patches",
                 .x = {.label = "patches of the word"},
                 .y = {.label = "mean distance to the word (of 512)"},
                 .lines = {sizes}};
  return report;
}

}  // namespace victorious
