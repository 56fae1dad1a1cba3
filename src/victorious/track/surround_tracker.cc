#include "victorious/track/surround_tracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include <Eigen/Dense>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/solvers/plane_maps.h"

namespace victorious {
namespace {

// Chosen on one orbit (ADR 0040), where factors of two change little, unless a reason is given.

constexpr double kFlowLongSide_px = 640;    // of the frames in which corners are tracked
constexpr double kSurroundings = 0.75;      // margin around the object in which they lie, over its longer side
constexpr double kMinSurroundings_px = 40;  // the same, at least
constexpr int kCorners = 40;
constexpr FlowOptions kFlow{.window_px = 11};
constexpr double kCornerSigma_px = 0.7;
constexpr int kMinInliers = 12;
constexpr double kMinKept = 0.5;          // of the corners of a reference
constexpr double kMaxStretch = 1.3;       // of the object's sides from one frame to the next
constexpr double kMinObjectInView = 0.6;  // of the object

constexpr double kColourSide_px = 48;
constexpr double kCutoutFactor = 2.4;  // half side of a cutout over half that of the object
constexpr double kOnObject = 0.7;      // radii: within, the first outline shows the object
constexpr double kAroundFrom = 1.2;    // between these, what is around it
constexpr double kAroundTo = 2.2;
constexpr int kLightBins = 6;
constexpr int kChromaBins = 14;
constexpr double kChromaStep = 6;
constexpr double kRareColour = 1e-4;  // frequency that counts as absence
constexpr double kMaxLogRatio = 2;
constexpr double kRecentRate = 0.05;       // of the colours of the last frames
constexpr double kMinFirstContrast = 0.7;  // a patch of plain ground has 0.5 to 0.9, a vehicle or a building 1.1 to 2
constexpr double kPenalty = 0.075;
constexpr double kMaxShift = 0.35;  // of the centre, over the expected sides
constexpr double kMinSize = 0.55;
constexpr double kMaxSize = 1.3;

// Planar parallax: what stands on the ground moves over it in the image only as far as its height and the change of the
// view allow.
constexpr double kMaxHeight = 1;          // of its highest visible part over the ground, in the image, over the box's
constexpr double kOffsetTolerance = 0.2;  // of a measured place, over the box's mean side
constexpr std::size_t kOffsets = 40;      // frames that are compared
constexpr int kContradictions = 3;        // frames in a row, each with as many: a single measured place may be wrong

class AffineEstimator {
 public:
  using Model = Eigen::Matrix3d;
  static constexpr std::size_t kSampleSize = 3;

  explicit AffineEstimator(std::span<const PointPair> pairs) : pairs_(pairs) {}

  [[nodiscard]] std::size_t size() const { return pairs_.size(); }
  [[nodiscard]] std::optional<Model> FromSample(std::span<const std::uint32_t> sample) const {
    const std::array<PointPair, kSampleSize> three = {pairs_[sample[0]], pairs_[sample[1]], pairs_[sample[2]]};
    constexpr double kMinArea_px2 = 50;
    const Eigen::Vector2d a = three[1].source - three[0].source;
    const Eigen::Vector2d b = three[2].source - three[0].source;
    if (std::abs(a.x() * b.y() - a.y() * b.x()) < kMinArea_px2) return std::nullopt;
    return SolveAffine(three);
  }
  void SquaredResiduals(const Model& model, std::span<double> out) const {
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      out[i] = (model.topLeftCorner<2, 2>() * pairs_[i].source + model.topRightCorner<2, 1>() - pairs_[i].target)
                   .squaredNorm();
    }
  }
  [[nodiscard]] double SigmaPx(const Model& /*model*/) const { return kCornerSigma_px; }
  [[nodiscard]] std::optional<Model> FromWeights(std::span<const double> weights) const {
    return SolveAffine(pairs_, weights);
  }

 private:
  std::span<const PointPair> pairs_;
};

Eigen::Vector2d Moved(const Eigen::Matrix3d& map, const Eigen::Vector2d& point) {
  return map.topLeftCorner<2, 2>() * point + map.topRightCorner<2, 1>();
}

// The half axes of the parallelogram nearest to the four corners, and its centre.
struct HalfAxes {
  Eigen::Vector2d centre;
  Eigen::Matrix2d axes;  // columns
};

HalfAxes HalfAxesOf(const Polygon& place) {
  HalfAxes half;
  half.centre = (place[0] + place[1] + place[2] + place[3]) / 4;
  half.axes.col(0) = (place[1] - place[0] + place[2] - place[3]) / 4;
  half.axes.col(1) = (place[3] - place[0] + place[2] - place[1]) / 4;
  return half;
}

Box EllipseBoxOf(const Polygon& place) {
  const HalfAxes half = HalfAxesOf(place);
  const Eigen::Vector2d extent = half.axes.rowwise().norm();
  return {half.centre.x() - extent.x(), half.centre.y() - extent.y(), 2 * extent.x(), 2 * extent.y()};
}

Polygon RectangleOf(const Polygon& outline) {
  if (outline.size() == 4) return outline;
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& point : outline)
    points.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
  std::array<cv::Point2f, 4> corners;
  cv::minAreaRect(points).points(corners.data());
  Polygon rectangle;
  for (const cv::Point2f& corner : corners) rectangle.emplace_back(corner.x, corner.y);
  return rectangle;
}

double SmallFromFrame(const cv::Size& size) {
  return std::min(1.0, kFlowLongSide_px / std::max(size.width, size.height));
}

cv::Mat GreyOf(const cv::Mat& bgr) {
  VICTORIOUS_CHECK(bgr.type() == CV_8UC3);
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

FlowPyramid PyramidOf(const cv::Mat& grey) {
  const double small_from_frame = SmallFromFrame(grey.size());
  cv::Mat small = grey;
  if (small_from_frame < 1) cv::resize(grey, small, {}, small_from_frame, small_from_frame, cv::INTER_AREA);
  return FlowPyramid(small, kFlow);
}

// Smooths the two chromas, so that a colour on the border of a bin counts for both.
void SmoothChroma(std::vector<double>& colours) {
  const auto smooth = [&](std::size_t first, std::size_t stride) {
    double before = 0;
    for (std::size_t i = 0; i < kChromaBins; ++i) {
      double& here = colours[first + i * stride];
      const double after = i + 1 < kChromaBins ? colours[first + (i + 1) * stride] : 0;
      const double smoothed = 0.25 * before + 0.5 * here + 0.25 * after;
      before = std::exchange(here, smoothed);
    }
  };
  for (std::size_t plane = 0; plane < kLightBins; ++plane) {
    const std::size_t first = plane * kChromaBins * kChromaBins;
    for (std::size_t i = 0; i < kChromaBins; ++i) smooth(first + i * kChromaBins, 1);
    for (std::size_t i = 0; i < kChromaBins; ++i) smooth(first + i, kChromaBins);
  }
}

std::vector<double> CountColours(const cv::Mat& bins, const cv::Mat& mask) {
  std::vector<double> colours(static_cast<std::size_t>(kLightBins * kChromaBins * kChromaBins));
  double count = 0;
  for (int y = 0; y < bins.rows; ++y) {
    for (int x = 0; x < bins.cols; ++x) {
      if (mask.at<std::uint8_t>(y, x) == 0) continue;
      colours[static_cast<std::size_t>(bins.at<int>(y, x))] += 1;
      count += 1;
    }
  }
  SmoothChroma(colours);
  for (double& one : colours) one /= std::max(1.0, count);
  return colours;
}

cv::Mat BinsOf(const cv::Mat& bgr) {
  constexpr double kFirstChroma = 128 - kChromaStep * kChromaBins / 2 + 2;
  constexpr int kLightStep = 256 / kLightBins + 1;
  cv::Mat lab;
  cv::cvtColor(bgr, lab, cv::COLOR_BGR2Lab);
  cv::Mat bins(bgr.size(), CV_32SC1);
  std::array<int, 256> chroma_bins;
  for (int value = 0; value < 256; ++value) {
    const auto bin = static_cast<int>(std::floor((value - kFirstChroma) / kChromaStep));
    chroma_bins[static_cast<std::size_t>(value)] = std::clamp(bin, 0, kChromaBins - 1);
  }
  for (int y = 0; y < bgr.rows; ++y) {
    const auto* const pixels = lab.ptr<cv::Vec3b>(y);
    int* const out = bins.ptr<int>(y);
    for (int x = 0; x < bgr.cols; ++x)
      out[x] = (pixels[x][0] / kLightStep * kChromaBins + chroma_bins[pixels[x][1]]) * kChromaBins +
               chroma_bins[pixels[x][2]];
  }
  return bins;
}

// One side of a box: the pixels from `first` to before `end`.
struct Side {
  int first = 0;
  int end = 0;
  double from = 0;
  double length = 0;
  double penalty = 0;
};

// The sides of all boxes that are tried, in one direction. @param pixels  of the image
std::vector<Side> SidesNear(double expected_from, double expected_length, int pixels) {
  constexpr double kSizeStep = 0.08;
  constexpr double kShiftStep = 0.07;
  const auto pixel = [&](double at) { return std::clamp(static_cast<int>(std::lround(at)), 0, pixels); };
  std::vector<Side> sides;
  for (double size = kMinSize; size < kMaxSize + kSizeStep / 2; size += kSizeStep) {
    const double size_penalty = std::pow(std::log(size), 2) / 0.2;
    for (double shift = -kMaxShift; shift < kMaxShift + kShiftStep / 2; shift += kShiftStep) {
      const double from = expected_from + (0.5 + shift - size / 2) * expected_length;
      const double length = size * expected_length;
      sides.push_back({.first = pixel(from),
                       .end = pixel(from + length),
                       .from = from,
                       .length = length,
                       .penalty = size_penalty + shift * shift / (kMaxShift * kMaxShift)});
    }
  }
  return sides;
}

// The box with the largest sum of `log_ratios`, less the penalty.
Box BestBox(const cv::Mat& log_ratios, const Box& expected) {
  cv::Mat sums;
  cv::integral(log_ratios, sums, CV_64F);
  const std::vector<Side> columns = SidesNear(expected.x, expected.width, log_ratios.cols);
  const std::vector<Side> rows = SidesNear(expected.y, expected.height, log_ratios.rows);
  const double weight = kPenalty * expected.Area();
  Box best = expected;
  double best_value = -std::numeric_limits<double>::infinity();
  for (const Side& row : rows) {
    const auto* const top = sums.ptr<double>(row.first);
    const auto* const bottom = sums.ptr<double>(row.end);
    for (const Side& column : columns) {
      const double sum = bottom[column.end] - top[column.end] - bottom[column.first] + top[column.first];
      const double value = sum - weight * (row.penalty + column.penalty);
      if (value > best_value) {
        best_value = value;
        best = {column.from, row.from, column.length, row.length};
      }
    }
  }
  return best;
}

// The best box, extended as far as the object's colours go on in the turned outline: the box that fits a turned
// rectangle best leaves its corners out.
struct Extent {
  Box box;
  Polygon outline;  // the convex hull of the object's colours
};

Extent ExtentOf(const cv::Mat& log_ratios, const Box& best, const Eigen::Matrix2d& axes) {
  constexpr double kMargin = 1.1;      // of the outline
  constexpr double kMinCovered = 0.1;  // of a row or column of the box
  const Eigen::Vector2d centre(best.x + best.width / 2, best.y + best.height / 2);
  const Eigen::Matrix2d inverse = axes.inverse();
  cv::Mat on_object(log_ratios.size(), CV_8UC1);
  for (int y = 0; y < log_ratios.rows; ++y) {
    const auto* const ratios = log_ratios.ptr<double>(y);
    for (int x = 0; x < log_ratios.cols; ++x) {
      const Eigen::Vector2d point(x + 0.5, y + 0.5);
      const bool is_inside = ratios[x] > 0 && (best.Contains(point.x(), point.y()) ||
                                               (inverse * (point - centre)).cwiseAbs().maxCoeff() < kMargin);
      on_object.at<std::uint8_t>(y, x) = is_inside ? 1 : 0;
    }
  }
  cv::medianBlur(on_object, on_object, 3);
  cv::Mat columns;
  cv::Mat rows;
  cv::reduce(on_object, columns, 0, cv::REDUCE_SUM, CV_32S);
  cv::reduce(on_object, rows, 1, cv::REDUCE_SUM, CV_32S);
  // Moves `edge` in steps of `step` while the next line has enough of the object's colours.
  const auto extend = [](const cv::Mat& counts, double edge, int step, double min_count) {
    int line = std::clamp(static_cast<int>(std::lround(edge)), 0, static_cast<int>(counts.total()));
    const auto next = [&] { return step > 0 ? line : line - 1; };
    while (next() >= 0 && next() < static_cast<int>(counts.total()) && counts.at<int>(next()) >= min_count)
      line += step;
    return line;
  };
  const double min_column = std::max(1.0, kMinCovered * best.height);
  const double min_row = std::max(1.0, kMinCovered * best.width);
  const double left = std::min<double>(best.x, extend(columns, best.x, -1, min_column));
  const double top = std::min<double>(best.y, extend(rows, best.y, -1, min_row));
  const double right = std::max<double>(best.x + best.width, extend(columns, best.x + best.width, 1, min_column));
  const double bottom = std::max<double>(best.y + best.height, extend(rows, best.y + best.height, 1, min_row));
  Extent extent{.box = {left, top, right - left, bottom - top}, .outline = {}};
  std::vector<cv::Point> pixels;
  cv::findNonZero(on_object, pixels);
  std::vector<Eigen::Vector2d> points;
  for (const cv::Point& at : pixels) {
    if (extent.box.Contains(at.x + 0.5, at.y + 0.5)) points.emplace_back(at.x + 0.5, at.y + 0.5);
  }
  extent.outline = ConvexHull(std::move(points));
  if (extent.outline.size() < 3) extent.outline = BoxCorners(extent.box);
  return extent;
}

cv::Mat InnerMask(const cv::Size& size, const Box& box) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  const cv::Rect inner(
      static_cast<int>(std::lround(box.x + box.width / 6)), static_cast<int>(std::lround(box.y + box.height / 6)),
      static_cast<int>(std::lround(box.width * 2 / 3)), static_cast<int>(std::lround(box.height * 2 / 3)));
  mask(inner & cv::Rect({0, 0}, size)) = 255;
  return mask;
}

}  // namespace

SurroundFrame::SurroundFrame(const cv::Mat& image) : bgr(image), grey(GreyOf(image)), pyramid(PyramidOf(grey)) {}

SurroundTracker::SurroundTracker(const SurroundFrame& frame, const Polygon& outline) {
  if (outline.size() < 3 || std::abs(SignedArea(outline)) < 1) return;
  const Polygon place = RectangleOf(outline);
  small_from_frame_ = SmallFromFrame(frame.bgr.size());
  last_ = frame.pyramid;
  last_place_ = place;
  SetReference(*last_, place);
  const Cutout cutout = CutOut(frame.bgr, place);
  if (cutout.bins.empty()) return;
  first_colours_ = CountColours(cutout.bins, cutout.radii < kOnObject);
  recent_colours_ = first_colours_;
  first_contrast_ = 1;
  std::optional<SurroundStep> first = Measure(frame.bgr, place);
  if (!first || first->contrast < kMinFirstContrast) return;
  first_contrast_ = std::exchange(first->contrast, 1);
  first_ = std::move(first);
}

void SurroundTracker::SetReference(const FlowPyramid& pyramid, const Polygon& place) {
  reference_ = pyramid;
  reference_place_ = place;
  now_from_reference_.setIdentity();
  Polygon small;
  for (const Eigen::Vector2d& corner : place) small.push_back(small_from_frame_ * corner);
  Box region = BoundingBox(small);
  const double margin = std::max(kMinSurroundings_px, kSurroundings * std::max(region.width, region.height));
  region = {region.x - margin, region.y - margin, region.width + 2 * margin, region.height + 2 * margin};
  corners_ = DetectCorners(pyramid.grey(), BoxCorners(region), kCorners);
}

std::optional<Eigen::Matrix3d> SurroundTracker::MeasureMotion(const FlowPyramid& now) const {
  std::vector<Eigen::Vector2d> guesses;
  for (const Eigen::Vector2d& corner : corners_) guesses.push_back(Moved(now_from_reference_, corner));
  const auto tracked = TrackPointsForwardBackward(*reference_, now, corners_, guesses);
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    if (tracked[i]) pairs.push_back({corners_[i], *tracked[i]});
  }
  const auto fit = Mlesac(AffineEstimator(pairs), {.outlier_area_px2 = static_cast<double>(now.grey().total())});
  if (!fit) return std::nullopt;
  const double inliers = fit->gamma * static_cast<double>(pairs.size());
  if (inliers < std::max<double>(kMinInliers, kMinKept * static_cast<double>(corners_.size()))) return std::nullopt;
  const Eigen::Matrix2d change = fit->model.topLeftCorner<2, 2>() * now_from_reference_.topLeftCorner<2, 2>().inverse();
  const Eigen::Vector2d sizes = change.jacobiSvd().singularValues();
  if (sizes.maxCoeff() > kMaxStretch || sizes.minCoeff() < 1 / kMaxStretch) return std::nullopt;
  return fit->model;
}

std::optional<SurroundStep> SurroundTracker::Step(const SurroundFrame& frame) {
  if (!first_) return std::nullopt;
  std::optional<Eigen::Matrix3d> motion = MeasureMotion(frame.pyramid);
  if (!motion) {
    SetReference(*last_, last_place_);
    motion = MeasureMotion(frame.pyramid);
    if (!motion) return std::nullopt;
  }
  now_from_reference_ = *motion;
  Polygon place;
  for (const Eigen::Vector2d& corner : reference_place_)
    place.push_back(Moved(now_from_reference_, small_from_frame_ * corner) / small_from_frame_);
  last_ = frame.pyramid;
  last_place_ = place;
  return Measure(frame.bgr, place);
}

SurroundTracker::Cutout SurroundTracker::CutOut(const cv::Mat& bgr, const Polygon& place) {
  const HalfAxes half = HalfAxesOf(place);
  const Eigen::Vector2d extent = half.axes.rowwise().norm();
  Cutout cutout;
  const double determinant = std::abs(half.axes.determinant());
  if (!(determinant > 1)) return cutout;
  const Eigen::Vector2d from = half.centre - kCutoutFactor * extent;
  const Eigen::Vector2d to = half.centre + kCutoutFactor * extent;
  const cv::Rect region =
      cv::Rect(cv::Point(static_cast<int>(std::floor(from.x())), static_cast<int>(std::floor(from.y()))),
               cv::Point(static_cast<int>(std::ceil(to.x())), static_cast<int>(std::ceil(to.y())))) &
      cv::Rect({0, 0}, bgr.size());
  if (region.width < 4 || region.height < 4) return cutout;
  cutout.frame_from_cutout = std::max(1.0, 2 * extent.maxCoeff() / kColourSide_px);
  cutout.origin_px = {region.x, region.y};
  cv::Mat small = bgr(region);
  if (cutout.frame_from_cutout > 1) {
    const double factor = 1 / cutout.frame_from_cutout;
    cv::resize(small, small, {}, factor, factor, cv::INTER_AREA);
  }
  cutout.bins = BinsOf(small);
  cutout.radii.create(small.size(), CV_64FC1);
  const Eigen::Matrix2d inverse = half.axes.inverse();
  const Eigen::Vector2d step = cutout.frame_from_cutout * inverse.col(0);
  for (int y = 0; y < small.rows; ++y) {
    Eigen::Vector2d point =
        inverse * (cutout.origin_px + cutout.frame_from_cutout * Eigen::Vector2d(0.5, y + 0.5) - half.centre);
    auto* const radii = cutout.radii.ptr<double>(y);
    for (int x = 0; x < small.cols; ++x, point += step) radii[x] = point.norm();
  }
  return cutout;
}

std::optional<SurroundStep> SurroundTracker::Measure(const cv::Mat& bgr, const Polygon& place) {
  const Box expected = EllipseBoxOf(place);
  const Box frame = FrameBox(bgr.cols, bgr.rows);
  if (!(Intersection(expected, frame).Area() >= kMinObjectInView * expected.Area())) return std::nullopt;
  const Cutout cutout = CutOut(bgr, place);
  if (cutout.bins.empty()) return std::nullopt;
  const cv::Mat around = (cutout.radii > kAroundFrom) & (cutout.radii < kAroundTo);
  const Colours surroundings = CountColours(cutout.bins, around);
  Colours log_ratio(surroundings.size());
  for (std::size_t i = 0; i < log_ratio.size(); ++i) {
    const double on_object = (first_colours_[i] + recent_colours_[i]) / 2;
    log_ratio[i] =
        std::clamp(std::log((on_object + kRareColour) / (surroundings[i] + kRareColour)), -kMaxLogRatio, kMaxLogRatio);
  }
  cv::Mat log_ratios(cutout.bins.size(), CV_64FC1);
  for (int y = 0; y < log_ratios.rows; ++y) {
    for (int x = 0; x < log_ratios.cols; ++x)
      log_ratios.at<double>(y, x) = log_ratio[static_cast<std::size_t>(cutout.bins.at<int>(y, x))];
  }
  const double scale = cutout.frame_from_cutout;
  const Box best =
      BestBox(log_ratios, {(expected.x - cutout.origin_px.x()) / scale, (expected.y - cutout.origin_px.y()) / scale,
                           expected.width / scale, expected.height / scale});
  const cv::Rect pixels =
      cv::Rect(cv::Point(static_cast<int>(std::lround(best.x)), static_cast<int>(std::lround(best.y))),
               cv::Point(static_cast<int>(std::lround(best.x + best.width)),
                         static_cast<int>(std::lround(best.y + best.height)))) &
      cv::Rect({0, 0}, log_ratios.size());
  if (pixels.area() == 0) return std::nullopt;
  const double contrast = cv::mean(log_ratios(pixels))[0] - cv::mean(log_ratios, around)[0];
  const cv::Mat on_object = InnerMask(log_ratios.size(), best) & (log_ratios > 0);
  if (cv::countNonZero(on_object) > 0) {
    const Colours now = CountColours(cutout.bins, on_object);
    for (std::size_t i = 0; i < now.size(); ++i)
      recent_colours_[i] = (1 - kRecentRate) * recent_colours_[i] + kRecentRate * now[i];
  }
  const auto in_frame = [&](const Box& box) {
    return Box{cutout.origin_px.x() + scale * box.x, cutout.origin_px.y() + scale * box.y, scale * box.width,
               scale * box.height};
  };
  const HalfAxes half = HalfAxesOf(place);
  const Extent extent = ExtentOf(log_ratios, best, half.axes / scale);
  Polygon outline;
  for (const Eigen::Vector2d& point : extent.outline) outline.push_back(cutout.origin_px + scale * point);
  SurroundStep step{.place = place,
                    .expected = expected,
                    .box = in_frame(extent.box),
                    .outline = std::move(outline),
                    .contrast = contrast / first_contrast_};
  if (step.contrast >= kMinContrast) step.moves_over_ground = MovesOverGround(half.axes, half.centre, in_frame(best));
  return step;
}

bool SurroundTracker::MovesOverGround(const Eigen::Matrix2d& axes, const Eigen::Vector2d& centre, const Box& box) {
  const Offset now{.axes = axes, .px = Eigen::Vector2d(box.x + box.width / 2, box.y + box.height / 2) - centre};
  const double tolerance = kOffsetTolerance * std::sqrt(box.Area());
  const auto contradicts = [&](const Offset& then) {
    const Eigen::Matrix2d now_from_then = now.axes * then.axes.inverse();
    const double turn = (now_from_then - Eigen::Matrix2d::Identity()).norm() / std::numbers::sqrt2;
    return (now.px - now_from_then * then.px).norm() > kMaxHeight * box.height * turn + tolerance;
  };
  const bool is_contradicted = std::ranges::count_if(offsets_, contradicts) >= kContradictions;
  contradictions_ = is_contradicted ? contradictions_ + 1 : 0;
  offsets_.push_back(now);
  if (offsets_.size() > kOffsets) offsets_.erase(offsets_.begin());
  return contradictions_ >= kContradictions;
}

}  // namespace victorious
