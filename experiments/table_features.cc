// Quality of the feature engines on images of planar scenes with known homographies: repeatability of keypoints and
// correct matches, at the same number of keypoints per image.
// Source of the measures: K. Mikolajczyk and C. Schmid, "A performance evaluation of local descriptors", PAMI 27(10),
// 2005; regions are compared by centre and scale instead of by their overlap.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>
#include <fmt/format.h>

#include "experiments/recognition_experiments.h"
#include "victorious/geometry/homography.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/match/matcher.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr double kRepeatedWithin_px = 2;        // distance of a keypoint from the projection of the other
constexpr double kRepeatedWithinOctaves = 0.5;  // of its scale
constexpr double kCorrectWithin_px = 3;         // distance of a match from the true place

struct Series {
  const char* name;
  std::vector<int> others;  // numbers of the images that are compared with the first
};

const std::array<Series, 3> kSeries = {{{"graf", {2, 3, 4, 5, 6}}, {"boat", {2, 3, 4, 5, 6}}, {"wall", {3, 5}}}};

struct Setting {
  const char* name;
  FeatureOptions options;
};

// The files' pixel centres are at integers, the project's at halves.
Expected<Eigen::Matrix3d> ReadHomography(const fs::path& path) {
  std::ifstream file(path);
  Eigen::Matrix3d map;
  for (int i = 0; i < 9; ++i) file >> map(i / 3, i % 3);
  if (!file) return Fail(ErrorCode::kNotFound, fmt::format("{}: no homography of nine numbers", path.string()));
  Eigen::Matrix3d half = Eigen::Matrix3d::Identity();
  half(0, 2) = half(1, 2) = 0.5;
  return half * map * half.inverse();
}

// The factor by which a homography enlarges lengths near a point.
double LocalScale(const Eigen::Matrix3d& map, const Eigen::Vector2d& point) {
  constexpr double kStep = 0.5;
  const Eigen::Vector2d dx =
      ApplyHomography(map, point + Eigen::Vector2d(kStep, 0)) - ApplyHomography(map, point - Eigen::Vector2d(kStep, 0));
  const Eigen::Vector2d dy =
      ApplyHomography(map, point + Eigen::Vector2d(0, kStep)) - ApplyHomography(map, point - Eigen::Vector2d(0, kStep));
  return std::sqrt(std::abs(dx.x() * dy.y() - dx.y() * dy.x())) / (2 * kStep);
}

bool IsInside(const Eigen::Vector2d& point, const FeatureSet& image) {
  return point.x() >= 0 && point.y() >= 0 && point.x() < image.image_width && point.y() < image.image_height;
}

// Keypoints at one place and scale count once, whatever their orientations.
std::vector<Keypoint> WithoutOrientations(const FeatureSet& features) {
  std::map<std::array<float, 3>, Keypoint> places;
  for (const Keypoint& keypoint : features.keypoints)
    places.try_emplace({keypoint.x, keypoint.y, keypoint.scale_px}, keypoint);
  std::vector<Keypoint> result;
  for (const auto& [place, keypoint] : places) result.push_back(keypoint);
  return result;
}

// The fraction of keypoints in the common part of both images that the other image has, too: pairs one to one, the
// nearest first, over the smaller number.
double Repeatability(const FeatureSet& first, const FeatureSet& other, const Eigen::Matrix3d& other_from_first) {
  struct Pair {
    double distance_px;
    std::size_t a, b;
  };
  const Eigen::Matrix3d first_from_other = other_from_first.inverse();
  const std::vector<Keypoint> a = WithoutOrientations(first);
  const std::vector<Keypoint> b = WithoutOrientations(other);
  std::vector<std::size_t> common;
  for (std::size_t j = 0; j < b.size(); ++j) {
    if (IsInside(ApplyHomography(first_from_other, {b[j].x, b[j].y}), first)) common.push_back(j);
  }
  std::size_t in_first = 0;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d place = ApplyHomography(other_from_first, {a[i].x, a[i].y});
    if (!IsInside(place, other)) continue;
    ++in_first;
    const double scale_px = a[i].scale_px * LocalScale(other_from_first, {a[i].x, a[i].y});
    for (const std::size_t j : common) {
      if (std::abs(b[j].x - place.x()) > kRepeatedWithin_px) continue;
      const double distance_px = std::hypot(b[j].x - place.x(), b[j].y - place.y());
      if (distance_px > kRepeatedWithin_px || std::abs(std::log2(b[j].scale_px / scale_px)) > kRepeatedWithinOctaves) {
        continue;
      }
      pairs.push_back({distance_px, i, j});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::distance_px);
  std::vector<char> used_a(a.size());
  std::vector<char> used_b(b.size());
  std::size_t repeated = 0;
  for (const Pair& pair : pairs) {
    if (used_a[pair.a] != 0 || used_b[pair.b] != 0) continue;
    used_a[pair.a] = used_b[pair.b] = 1;
    ++repeated;
  }
  const std::size_t fewer = std::min(in_first, common.size());
  return fewer == 0 ? 0 : static_cast<double>(repeated) / static_cast<double>(fewer);
}

struct Matching {
  double correct = 0;
  double all = 0;
};

Matching CountMatches(const FeatureSet& first, const FeatureSet& other, const Eigen::Matrix3d& other_from_first) {
  const FeatureView view = first.View();
  const std::vector<MatchSet> matches = MatchFeatures(other.View(), TemplateSet(std::span(&view, 1)), {});
  Matching counted;
  for (const Match& match : matches.front()) {
    const Keypoint& from = first.keypoints[match.template_keypoint];
    const Keypoint& to = other.keypoints[match.scene_keypoint];
    const Eigen::Vector2d place = ApplyHomography(other_from_first, {from.x, from.y});
    counted.all += 1;
    if (std::hypot(to.x - place.x(), to.y - place.y()) <= kCorrectWithin_px) counted.correct += 1;
  }
  return counted;
}

// The images of a series by every engine: all with as many keypoints as the engine that finds fewest, at most `most`.
Expected<std::vector<std::vector<FeatureSet>>> ExtractEqually(const std::vector<cv::Mat>& images,
                                                              const FeatureOptions& setting, int most) {
  const std::vector<std::string> engines = FeatureEngines();
  std::vector<std::vector<FeatureSet>> result(engines.size());
  for (const cv::Mat& image : images) {
    FeatureOptions options = setting;
    const auto extract = [&](std::size_t e) -> Expected<FeatureSet> {
      options.engine = engines[e];
      VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options));
      return extractor->Extract(image);
    };
    options.max_features = most;
    std::size_t fewest = SIZE_MAX;
    for (std::size_t e = 0; e < engines.size(); ++e) {
      VICTORIOUS_ASSIGN_OR_RETURN(FeatureSet features, extract(e));
      fewest = std::min(fewest, features.size());
      result[e].push_back(std::move(features));
    }
    options.max_features = static_cast<int>(std::max<std::size_t>(fewest, 1));
    for (std::size_t e = 0; e < engines.size(); ++e) {
      if (result[e].back().size() == fewest) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(result[e].back(), extract(e));
    }
  }
  return result;
}

Status AddRows(const fs::path& folder, const Series& series, const Setting& setting, int most, Report& report) {
  std::vector<cv::Mat> images;
  std::vector<Eigen::Matrix3d> maps;
  VICTORIOUS_ASSIGN_OR_RETURN(const Image first, ReadImage(folder / series.name / "img1.png"));
  images.push_back(GreyFromBgr(first.bgr));
  for (const int number : series.others) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Image other, ReadImage(folder / series.name / fmt::format("img{}.png", number)));
    VICTORIOUS_ASSIGN_OR_RETURN(const Eigen::Matrix3d map,
                                ReadHomography(folder / series.name / fmt::format("H1to{}p", number)));
    images.push_back(GreyFromBgr(other.bgr));
    maps.push_back(map);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto features, ExtractEqually(images, setting.options, most));
  for (std::size_t e = 0; e < features.size(); ++e) {
    double keypoints = 0;
    double repeatability = 0;
    Matching matching;
    for (const FeatureSet& one : features[e]) keypoints += static_cast<double>(one.size());
    for (std::size_t i = 0; i < maps.size(); ++i) {
      repeatability += Repeatability(features[e][0], features[e][i + 1], maps[i]);
      const Matching one = CountMatches(features[e][0], features[e][i + 1], maps[i]);
      matching.correct += one.correct;
      matching.all += one.all;
    }
    report.rows.push_back({std::string(series.name), std::string(setting.name),
                           most == 0 ? std::string("all") : fmt::format("strongest {}", most), FeatureEngines()[e],
                           keypoints / static_cast<double>(images.size()),
                           repeatability / static_cast<double>(maps.size()), matching.correct,
                           matching.correct / std::max(1.0, matching.all)});
  }
  return {};
}

}  // namespace

Expected<Report> RunTableFeatures(const ExperimentSettings& settings) {
  const fs::path folder = settings.data / "real/recognition/oxford_affine";
  Report report{.name = {},
                .title = "Quality of the feature engines on planar scenes with known homographies",
                .notes = {fmt::format(
                    "Each image has the same number of keypoints by every engine: the strongest, as many as the "
                    "engine with fewest finds. Repeatability: the mean over pairs of the fraction of keypoints "
                    "in the common part with a keypoint of the other image within {} px and {} octaves, one to "
                    "one. Matches: by the ratio test at 0.8, correct within {} px of the true place, summed "
                    "over pairs.",
                    kRepeatedWithin_px, kRepeatedWithinOctaves, kCorrectWithin_px)},
                .columns = {"series", "thresholds", "keypoints", "engine", "keypoints per image", "repeatability",
                            "correct matches", "precision of matches"},
                .rows = {},
                .plot = {}};
  const std::array<Setting, 2> kSettings = {{{"low contrast", LowContrastFeatureOptions()}, {"Lowe's", {}}}};
  for (const Series& series : kSeries) {
    for (const Setting& setting : kSettings) {
      for (const int most : {0, 1000}) {
        VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
        settings.progress(fmt::format("{}, {}", series.name, setting.name));
        VICTORIOUS_RETURN_IF_ERROR(AddRows(folder, series, setting, most, report));
      }
    }
  }
  return report;
}

}  // namespace victorious
