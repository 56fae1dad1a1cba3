#include "victorious/search/recognize/contour_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/recognize/contour_track.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMaxImage_px = 800;
constexpr double kPresmoothing_px = 1;  // of the image, besides that of ContourImage: what is printed has fine edges
constexpr double kFocal = 1.2;          // over the image's longer side: that of a telephone or a webcam
constexpr double kTemplate_px = 64;
constexpr double kSmallest_px = 180;     // diagonal of an object's bounding box
constexpr double kLargest = 1.15;        // over the image's shorter side
constexpr double kThirdOfOctave = 1.26;  // a third of an octave
constexpr double kViewStep_rad = RadiansFromDegrees(9.9);
constexpr std::array kRolls_rad = {RadiansFromDegrees(-15), 0.0, RadiansFromDegrees(15)};
constexpr std::size_t kOrientations = 8;  // of coarse templates
constexpr std::size_t kMaxTemplatePoints = 64;
constexpr std::size_t kMinTemplatePoints = 20;
constexpr int kBorder_px = 48;  // around a coarse image
constexpr int kSurroundings_px = 61;
constexpr double kMinHits = 0.5;  // of the points of a template
constexpr std::size_t kPlacesOfTemplate = 3;
constexpr float kApart_px = 6;               // of two of them, in the coarse image
constexpr std::size_t kMaxHypotheses = 100;  // of a size
constexpr std::size_t kMaxRefined = 200;
constexpr std::size_t kMaxPerturbed = 6;
constexpr int kPerturbations = 30;
constexpr int kPerturbationRounds = 2;

void InParallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another frame
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const StageScope scope(Stage::kShape);
      work(i);
    });
  });
}

// A template at a place of a coarse image.
struct Hypothesis {
  float surprise = 0;  // standard deviations above what the surroundings make likely
  std::size_t view = 0;
  double roll_rad = 0;
  Vector2d at_px = Vector2d::Zero();  // of the object's centre, in the image
};

// The edges of an image in which objects of one size have kTemplate_px. Each map has one pixel in four: those with even
// or odd row and column, so that a template is compared at every second pixel by adding rows.
struct CoarseImage {
  double scale = 1;  // over the image
  int rows = 0;      // of places, every second pixel
  int columns = 0;
  std::array<std::array<cv::Mat, 4>, kOrientations> maps;  // CV_8UC1: 1 near an edge
  std::array<cv::Mat, kOrientations> means;                // CV_32FC1: of the surroundings, at the places
};

CoarseImage MakeCoarseImage(const cv::Mat& grey, double size_px) {
  CoarseImage coarse{.scale = kTemplate_px / size_px};
  cv::Mat small;
  cv::resize(grey, small, {}, coarse.scale, coarse.scale, cv::INTER_AREA);
  const ImageEdges edges = FindEdges(small);
  coarse.rows = (small.rows + 1) / 2;
  coarse.columns = (small.cols + 1) / 2;
  const cv::Size bordered(2 * (coarse.columns + kBorder_px), 2 * (coarse.rows + kBorder_px));
  std::array<cv::Mat, kOrientations> near;
  for (cv::Mat& map : near) map = cv::Mat::zeros(bordered, CV_8U);
  for (int row = 0; row < small.rows; ++row) {
    for (int column = 0; column < small.cols; ++column) {
      if (edges.is_edge.at<std::uint8_t>(row, column) == 0) continue;
      // The two nearest orientations: of twice as many bins, those on either side.
      const int half = OrientationBin(edges.x.at<float>(row, column), edges.y.at<float>(row, column),
                                      2 * static_cast<int>(kOrientations));
      for (const int side : {half, half + 1}) {
        near[static_cast<std::size_t>(side / 2) % kOrientations].at<std::uint8_t>(row + kBorder_px,
                                                                                  column + kBorder_px) = 1;
      }
    }
  }
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  for (std::size_t k = 0; k < kOrientations; ++k) {
    cv::dilate(near[k], near[k], square);
    cv::Mat mean;
    near[k].convertTo(mean, CV_32F);
    cv::blur(mean, mean, {kSurroundings_px, kSurroundings_px}, {-1, -1}, cv::BORDER_CONSTANT);
    coarse.means[k].create(coarse.rows, coarse.columns, CV_32F);
    for (int row = 0; row < coarse.rows; ++row) {
      for (int column = 0; column < coarse.columns; ++column) {
        coarse.means[k].at<float>(row, column) = mean.at<float>(2 * row + kBorder_px, 2 * column + kBorder_px);
      }
    }
    for (std::size_t phase = 0; phase < 4; ++phase) {
      cv::Mat& map = coarse.maps[k][phase];
      map.create(bordered.height / 2, bordered.width / 2, CV_8U);
      for (int row = 0; row < map.rows; ++row) {
        for (int column = 0; column < map.cols; ++column) {
          map.at<std::uint8_t>(row, column) =
              near[k].at<std::uint8_t>(2 * row + static_cast<int>(phase / 2), 2 * column + static_cast<int>(phase % 2));
        }
      }
    }
  }
  return coarse;
}

// Right, down, orientation.
using TemplatePoint = std::tuple<int, int, std::size_t>;

std::vector<TemplatePoint> MakeTemplate(const ContourView& view, double roll_rad, double distance_m, double focal_px) {
  const Matrix3d turn = Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ()).toRotationMatrix() * view.camera_from_model;
  const Vector3d centre(0, 0, distance_m);
  std::set<TemplatePoint> points;
  for (const ContourPoint& point : view.points) {
    const Vector3d at = turn * point.position_m + centre;
    const Vector3d beside = turn * point.beside_m + centre;
    if (!(at.z() > 0) || !(beside.z() > 0)) continue;
    const Vector2d at_px = focal_px * at.head<2>() / at.z();
    if (at_px.cwiseAbs().maxCoeff() >= kBorder_px - 2) continue;
    const Vector2d tangent = focal_px * beside.head<2>() / beside.z() - at_px;
    const int bin = OrientationBin(-tangent.y(), tangent.x(), static_cast<int>(kOrientations));
    points.emplace(static_cast<int>(std::lround(at_px.x())), static_cast<int>(std::lround(at_px.y())),
                   static_cast<std::size_t>(bin));
  }
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kMaxTemplatePoints);
  std::vector<TemplatePoint> thinned;
  std::size_t number = 0;
  for (const TemplatePoint& point : points) {
    if (number++ % stride == 0) thinned.push_back(point);
  }
  return thinned;
}

// Keeps the best places that are apart.
void KeepBestPlaces(std::vector<Hypothesis>& best, const Hypothesis& found) {
  const auto is_near = [&](const Hypothesis& other) {
    return (other.at_px - found.at_px).cwiseAbs().maxCoeff() < kApart_px;
  };
  const auto near = std::ranges::find_if(best, is_near);
  if (near != best.end()) {
    if (found.surprise > near->surprise) *near = found;
  } else if (best.size() < kPlacesOfTemplate) {
    best.push_back(found);
  } else {
    const auto worst = std::ranges::min_element(best, {}, &Hypothesis::surprise);
    if (found.surprise > worst->surprise) *worst = found;
  }
}

// The best places of a template. @return positions in the coarse image, px
std::vector<Hypothesis> FindTemplate(const CoarseImage& coarse, const std::vector<TemplatePoint>& points,
                                     const Hypothesis& like) {
  std::vector<const std::uint8_t*> first;
  std::array<float, kOrientations> counts{};
  std::size_t row_bytes = 0;
  for (const auto& [right, down, orientation] : points) {
    const int column = right + kBorder_px;
    const int row = down + kBorder_px;
    const cv::Mat& map = coarse.maps[orientation][static_cast<std::size_t>(row % 2 * 2 + column % 2)];
    first.push_back(map.ptr<std::uint8_t>(row / 2) + column / 2);
    row_bytes = map.step;
    counts[orientation] += 1;
  }
  const auto total = static_cast<float>(points.size());
  const auto min_hits = static_cast<int>(std::ceil(kMinHits * total));
  std::vector<std::uint8_t> hits(static_cast<std::size_t>(coarse.columns));
  std::vector<Hypothesis> best;
  for (int row = 0; row < coarse.rows; ++row) {
    std::ranges::fill(hits, std::uint8_t{0});
    for (const std::uint8_t* start : first) {
      const std::uint8_t* const in = start + static_cast<std::size_t>(row) * row_bytes;
      for (std::size_t i = 0; i < hits.size(); ++i) hits[i] = static_cast<std::uint8_t>(hits[i] + in[i]);
    }
    for (int column = 0; column < coarse.columns; ++column) {
      const int hit = hits[static_cast<std::size_t>(column)];
      if (hit < min_hits) continue;
      float likely = 0;
      for (std::size_t k = 0; k < kOrientations; ++k) likely += counts[k] * coarse.means[k].at<float>(row, column);
      constexpr float kMinLikely = 0.03F;
      const float fraction = std::clamp(likely / total, kMinLikely, 1 - kMinLikely);
      Hypothesis found = like;
      found.surprise = (static_cast<float>(hit) / total - fraction) / std::sqrt(fraction * (1 - fraction));
      found.at_px = {2.0 * column, 2.0 * row};
      KeepBestPlaces(best, found);
    }
  }
  return best;
}

// Views at least kViewStep_rad apart.
std::vector<std::size_t> ThinViews(const ContourModel& model) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    const auto is_near = [&](std::size_t other) {
      return model.views[i].camera_from_model.row(2).dot(model.views[other].camera_from_model.row(2)) >
             std::cos(kViewStep_rad);
    };
    if (std::ranges::none_of(kept, is_near)) kept.push_back(i);
  }
  return kept;
}

bool AreAlike(const ContourModel& model, const Hypothesis& a, const Hypothesis& b, double size_px) {
  constexpr double kSamePlace = 0.08;      // of the object's size
  constexpr double kSameDirection = 0.96;  // cosine
  constexpr double kSameRoll_rad = RadiansFromDegrees(10);
  return (a.at_px - b.at_px).norm() < kSamePlace * size_px && std::abs(a.roll_rad - b.roll_rad) < kSameRoll_rad &&
         model.views[a.view].camera_from_model.row(2).dot(model.views[b.view].camera_from_model.row(2)) >
             kSameDirection;
}

// The best hypotheses of one size, as poses.
std::vector<ContourPose> FindHypotheses(const ContourModel& model, const ContourImage& image,
                                        std::span<const std::size_t> views, double size_px, double focal_px) {
  const CoarseImage coarse = MakeCoarseImage(image.grey(), size_px);
  const double distance_m = focal_px * model.diagonal_m / size_px;
  std::vector<std::vector<Hypothesis>> found(views.size() * kRolls_rad.size());
  InParallel(found.size(), [&](std::size_t i) {
    const Hypothesis like{.view = views[i / kRolls_rad.size()], .roll_rad = kRolls_rad[i % kRolls_rad.size()]};
    const std::vector<TemplatePoint> points =
        MakeTemplate(model.views[like.view], like.roll_rad, distance_m, focal_px * coarse.scale);
    if (points.size() >= kMinTemplatePoints) found[i] = FindTemplate(coarse, points, like);
  });
  std::vector<Hypothesis> all;
  for (const std::vector<Hypothesis>& of_template : found)
    all.insert(all.end(), of_template.begin(), of_template.end());
  for (Hypothesis& one : all) one.at_px = (one.at_px + Vector2d(0.5, 0.5)) / coarse.scale;
  std::ranges::stable_sort(all, std::greater{}, &Hypothesis::surprise);
  std::vector<Hypothesis> kept;
  std::vector<ContourPose> poses;
  for (const Hypothesis& one : all) {
    if (kept.size() == kMaxHypotheses) break;
    if (std::ranges::any_of(kept, [&](const Hypothesis& better) { return AreAlike(model, one, better, size_px); })) {
      continue;
    }
    kept.push_back(one);
    const Vector2d from_centre = (one.at_px - image.centre_px()) / focal_px;
    const Vector3d ray(from_centre.x(), from_centre.y(), 1);
    const Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), ray).toRotationMatrix() *
                          Eigen::AngleAxisd(one.roll_rad, Vector3d::UnitZ()).toRotationMatrix();
    poses.push_back({turn * model.views[one.view].camera_from_model, distance_m * ray, focal_px});
  }
  return poses;
}

ContourMatch Refined(const ContourModel& model, const ContourImage& image, const ContourPose& pose,
                     const ContourRefineOptions& options) {
  ContourMatch match{.pose = RefineContourPose(model, image, pose, options), .evidence = {}};
  match.evidence = EvidenceOf(model, image, match.pose);
  return match;
}

double DecadesOf(const ContourMatch& match) { return match.evidence.decades; }

void SortByEvidence(std::vector<ContourMatch>& matches) {
  std::ranges::stable_sort(matches, std::greater{}, DecadesOf);
}

// A pose near another one, so that the least squares can end in another minimum.
ContourPose Perturbed(const ContourModel& model, const ContourPose& pose, double assumed_focal_px, Random& random) {
  constexpr double kTurn_rad = 0.07;
  constexpr double kShift = 0.03;  // of the object's size
  constexpr double kDistanceChange = 0.04;
  constexpr double kFocalChange = 0.1;
  constexpr double kMinFocal = 0.6;  // of the assumed one
  constexpr double kMaxFocal = 1.7;
  const Vector3d turn = kTurn_rad * Vector3d(random.Normal(), random.Normal(), random.Normal());
  ContourPose moved = pose;
  if (turn.norm() > 0) {
    moved.camera_from_model =
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * pose.camera_from_model;
  }
  moved.focal_px = std::clamp(pose.focal_px * std::exp(kFocalChange * random.Normal()), kMinFocal * assumed_focal_px,
                              kMaxFocal * assumed_focal_px);
  moved.centre_in_camera_m *= moved.focal_px / pose.focal_px * std::exp(kDistanceChange * random.Normal());
  const double shift_m = kShift * model.diagonal_m;
  moved.centre_in_camera_m += shift_m * Vector3d(random.Normal(), random.Normal(), 0);
  return moved;
}

// The best matches in different places or from different sides.
std::vector<ContourMatch> BestApart(const std::vector<ContourMatch>& sorted) {
  constexpr double kSameBox = 0.7;
  constexpr double kSameDirection = 0.97;
  std::vector<ContourMatch> best;
  for (const ContourMatch& match : sorted) {
    if (best.size() == kMaxPerturbed) break;
    const auto is_same = [&](const ContourMatch& other) {
      const double common = (match.evidence.box & other.evidence.box).area();
      return common > kSameBox * (match.evidence.box.area() + other.evidence.box.area() - common) &&
             match.pose.camera_from_model.row(2).dot(other.pose.camera_from_model.row(2)) > kSameDirection;
    };
    if (std::ranges::none_of(best, is_same)) best.push_back(match);
  }
  return best;
}

ContourMatch BestNear(const ContourModel& model, const ContourImage& image, ContourMatch best,
                      double assumed_focal_px) {
  for (int round = 0; round < kPerturbationRounds; ++round) {
    std::vector<ContourMatch> tries(kPerturbations);
    InParallel(tries.size(), [&](std::size_t i) {
      Random random(MixSeed(static_cast<std::uint64_t>(round), i));
      constexpr double kFar = 0.035;
      constexpr double kNear = 0.02;
      tries[i] = Refined(model, image, Perturbed(model, best.pose, assumed_focal_px, random),
                         {.stride = 2, .reach = i % 2 == 0 ? kNear : kFar});
    });
    const auto better = std::ranges::max_element(tries, {}, DecadesOf);
    if (DecadesOf(*better) > DecadesOf(best)) best = *better;
  }
  return best;
}

// Refines all hypotheses with few points, the best of them with all, and the best of those from many starts.
ContourMatch BestOf(const ContourModel& model, const ContourImage& image, const std::vector<ContourPose>& poses,
                    double focal_px) {
  constexpr std::size_t kFewPoints = 70;
  const std::size_t stride = std::max<std::size_t>(1, model.views.front().points.size() / kFewPoints);
  std::vector<ContourMatch> matches(poses.size());
  InParallel(matches.size(), [&](std::size_t i) {
    matches[i] =
        Refined(model, image, poses[i],
                {.iterations = 8, .stride = stride, .reach = 0.035, .reach_factor = 0.82, .free_focal = false});
  });
  SortByEvidence(matches);
  if (matches.size() > kMaxRefined) matches.resize(kMaxRefined);
  InParallel(matches.size(), [&](std::size_t i) {
    const ContourPose start = matches[i].pose;
    for (const ContourRefineOptions& options :
         {ContourRefineOptions{}, ContourRefineOptions{.iterations = 20, .reach = 0.04, .reach_factor = 0.88}}) {
      const ContourMatch again = Refined(model, image, start, options);
      if (DecadesOf(again) > DecadesOf(matches[i])) matches[i] = again;
    }
  });
  SortByEvidence(matches);
  std::vector<ContourMatch> best = BestApart(matches);
  for (ContourMatch& match : best) match = BestNear(model, image, match, focal_px);
  return *std::ranges::max_element(best, {}, [](const ContourMatch& match) { return NegLog10NfaOf(match.evidence); });
}

}  // namespace

Expected<ContourModel> ReadContourModel(const ObjectModel& model, const RelitTemplateSource& source) {
  VICTORIOUS_CHECK(model.box_m);
  ContourModel contours{.diagonal_m = model.box_m->sizes().norm(), .views = {}};
  std::vector<Expected<std::vector<ContourPoint>>> points(model.views.size());
  InParallel(points.size(), [&](std::size_t i) { points[i] = source.GetContours(i); });
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i]) return std::unexpected(std::move(points[i]).error());
    contours.views.push_back({CameraFromModel(*model.views[i].angles).toRotationMatrix(), *std::move(points[i])});
  }
  return contours;
}

double NegLog10NfaOf(const ContourEvidence& evidence) {
  const auto between = [](double value, double low, double high) {
    return std::clamp((value - low) / (high - low), 0.0, 1.0);
  };
  constexpr double kMinHitFraction = 0.75;
  constexpr double kFullHitFraction = 0.9;
  constexpr double kMinStep = 0.25;
  constexpr double kFullStep = 0.55;
  constexpr double kDecadesOfOneFalseAlarm = 20;
  constexpr double kDecadesPerDecadeOfNfa = 20;  // the edges of one scene are not independent
  const double decades = evidence.decades * between(evidence.hit_fraction, kMinHitFraction, kFullHitFraction) *
                         between(evidence.step, kMinStep, kFullStep);
  return (decades - kDecadesOfOneFalseAlarm) / kDecadesPerDecadeOfNfa;
}

double AssumedFocalPx(const cv::Size& size) { return kFocal * std::max(size.width, size.height); }

namespace {

// An image at the size at which it is searched.
struct SearchedImage {
  double shrink = 1;
  cv::Mat grey;
};

SearchedImage ShrinkToSearch(const cv::Mat& grey) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1);
  SearchedImage searched{std::min(1.0, kMaxImage_px / static_cast<double>(std::max(grey.rows, grey.cols))), grey};
  if (searched.shrink < 1) {
    cv::resize(grey, searched.grey, {}, searched.shrink, searched.shrink, cv::INTER_AREA);
  }
  cv::Mat smooth;
  cv::GaussianBlur(searched.grey, smooth, {}, kPresmoothing_px);
  searched.grey = smooth;
  return searched;
}

// A match in the pixels of the image before it was shrunk. std::nullopt if it is not significant.
std::optional<ContourMatch> Significant(ContourMatch best, double shrink) {
  best.neg_log10_nfa = NegLog10NfaOf(best.evidence);
  if (best.neg_log10_nfa < kMinContourNegLog10Nfa) return std::nullopt;
  best.pose.focal_px /= shrink;
  cv::Rect2d& box = best.evidence.box;
  box = {box.x / shrink, box.y / shrink, box.width / shrink, box.height / shrink};
  return best;
}

}  // namespace

std::optional<ContourMatch> FindByContours(const ContourModel& model, const cv::Mat& grey) {
  if (model.views.empty()) return std::nullopt;
  const SearchedImage searched = ShrinkToSearch(grey);
  const ContourImage image(searched.grey);
  const double focal_px = AssumedFocalPx(searched.grey.size());
  const std::vector<std::size_t> views = ThinViews(model);
  std::vector<ContourPose> poses;
  const double largest_px = kLargest * std::min(searched.grey.rows, searched.grey.cols);
  for (double size_px = kSmallest_px; size_px < largest_px; size_px *= kThirdOfOctave) {
    const std::vector<ContourPose> of_size = FindHypotheses(model, image, views, size_px, focal_px);
    poses.insert(poses.end(), of_size.begin(), of_size.end());
  }
  if (poses.empty()) return std::nullopt;
  return Significant(BestOf(model, image, poses, focal_px), searched.shrink);
}

std::optional<ContourMatch> FindContoursNear(const ContourModel& model, const cv::Mat& grey, ContourPose start) {
  if (model.views.empty()) return std::nullopt;
  const SearchedImage searched = ShrinkToSearch(grey);
  const ContourImage image(searched.grey);
  start.focal_px *= searched.shrink;
  const ContourMatch first = Refined(model, image, start, {.reach = 0.04});
  return Significant(BestNear(model, image, first, AssumedFocalPx(searched.grey.size())), searched.shrink);
}

}  // namespace victorious
