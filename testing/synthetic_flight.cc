#include "testing/synthetic_flight.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "testing/drawn_town.h"
#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"

namespace victorious::testing {
namespace {

constexpr double kZoomVariation = 0.2;         // relative amplitude of the zoom
constexpr double kScaleVariation = 0.1;        // relative amplitude of an object's scale
constexpr double kRotationAmplitudeRad = 0.7;  // amplitude of the camera's rotation
constexpr double kFirstObject = 0.12;          // position on the camera path, as a fraction of its length
constexpr double kObjectSpacing = 0.38;        // as a fraction of the camera path, maximum
constexpr int kMaxObjects = 8;
constexpr std::uint8_t kOpaque = 128;   // alpha from which a pixel belongs to the object (half covered)
const Eigen::Vector2d kShadowPx(7, 5);  // ground px

// Random streams of the seed, one for each purpose.
enum SeedUse : std::uint64_t { kTownSeed = 0x7001, kPathSeed = 0x7002, kObjectSeed = 0x7003, kNoiseSeed = 0x7004 };

std::uint64_t SeedFor(std::uint64_t seed, std::uint64_t use) { return Random(seed ^ (use << 40)).Next(); }

std::vector<cv::Mat> BuildPyramid(const cv::Mat& image) {
  std::vector<cv::Mat> levels = {image};
  while (std::min(levels.back().cols, levels.back().rows) > 16) {
    cv::Mat half;
    cv::pyrDown(levels.back(), half);
    levels.push_back(half);
  }
  return levels;
}

cv::Mat PremultiplyAlpha(const cv::Mat& bgra) {
  cv::Mat result = bgra.clone();
  result.forEach<cv::Vec4b>([](cv::Vec4b& pixel, const int*) {
    for (int channel = 0; channel < 3; ++channel) {
      pixel[channel] = static_cast<std::uint8_t>((pixel[channel] * pixel[3] + 127) / 255);
    }
  });
  return result;
}

/// A blurred, dark copy of an image's alpha channel.
cv::Mat MakeShadow(const cv::Mat& bgra) {
  cv::Mat alpha;
  cv::extractChannel(bgra, alpha, 3);
  cv::GaussianBlur(alpha, alpha, {}, 2.0);
  alpha *= 0.45;
  const cv::Mat none = cv::Mat::zeros(alpha.size(), CV_8U);
  cv::Mat shadow;
  cv::merge(std::vector<cv::Mat>{none, none, none, alpha}, shadow);
  return shadow;
}

Eigen::Matrix3d Shift(double x, double y) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 2) = x;
  matrix(1, 2) = y;
  return matrix;
}

/// Image pixels per frame pixel at a point of the frame: the square root of the determinant of the Jacobian.
double LocalScale(const Eigen::Matrix3d& image_from_frame, const Eigen::Vector2d& at) {
  const double w = image_from_frame.row(2).dot(at.homogeneous());
  return std::sqrt(std::abs(image_from_frame.determinant() / (w * w * w)));
}

/// Warps the image into a region of the frame, from the pyramid level with the closest pixel size.
cv::Mat LayInto(const std::vector<cv::Mat>& pyramid, const Eigen::Matrix3d& frame_from_image, const cv::Rect& region,
                int border) {
  const Eigen::Matrix3d image_from_frame = frame_from_image.inverse();
  const Eigen::Vector2d middle(region.x + region.width / 2.0, region.y + region.height / 2.0);
  const double octave = std::round(std::log2(LocalScale(image_from_frame, middle)));
  const auto level = static_cast<std::size_t>(std::clamp(octave, 0.0, static_cast<double>(pyramid.size() - 1)));

  // OpenCV's pixel centres are at integers, and its pyramid keeps every second pixel.
  Eigen::Matrix3d level_from_image = Eigen::Matrix3d::Identity();
  level_from_image.topLeftCorner<2, 2>() *= std::exp2(-static_cast<double>(level));
  const Eigen::Matrix3d map =
      level_from_image * Shift(-0.5, -0.5) * image_from_frame * Shift(region.x + 0.5, region.y + 0.5);
  cv::Mat matrix(3, 3, CV_64F);
  for (int i = 0; i < 9; ++i) matrix.at<double>(i / 3, i % 3) = map(i / 3, i % 3);
  cv::Mat laid;
  cv::warpPerspective(pyramid[level], laid, matrix, region.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, border);
  return laid;
}

/// Composites `over` (premultiplied BGRA) onto `under` (BGR) of the same size.
void Blend(const cv::Mat& over, cv::Mat under) {
  for (int y = 0; y < under.rows; ++y) {
    const auto* above = over.ptr<cv::Vec4b>(y);
    auto* below = under.ptr<cv::Vec3b>(y);
    for (int x = 0; x < under.cols; ++x) {
      const int through = 255 - above[x][3];
      if (through == 255) continue;
      for (int channel = 0; channel < 3; ++channel) {
        below[x][channel] =
            cv::saturate_cast<std::uint8_t>(above[x][channel] + (below[x][channel] * through + 127) / 255);
      }
    }
  }
}

Polygon Mapped(const Eigen::Matrix3d& homography, const Polygon& polygon) {
  Polygon mapped;
  for (const Eigen::Vector2d& corner : polygon) mapped.push_back(ApplyHomography(homography, corner));
  return mapped;
}

Polygon OutlineOf(const cv::Mat& image) {
  return BoxCorners({0, 0, static_cast<double>(image.cols), static_cast<double>(image.rows)});
}

/// The bounding rectangle of the pixels that an outline touches, with a border of one pixel.
cv::Rect PixelsAround(const Polygon& outline) {
  const Box box = BoundingBox(outline);
  const int x0 = static_cast<int>(std::floor(box.x)) - 1;
  const int y0 = static_cast<int>(std::floor(box.y)) - 1;
  return {x0, y0, static_cast<int>(std::ceil(box.x + box.width)) + 1 - x0,
          static_cast<int>(std::ceil(box.y + box.height)) + 1 - y0};
}

/// Composites the image onto the frame, where they intersect.
void Overlay(const std::vector<cv::Mat>& pyramid, const Eigen::Matrix3d& frame_from_image, cv::Mat& frame) {
  const Polygon outline = Mapped(frame_from_image, OutlineOf(pyramid[0]));
  const cv::Rect region = PixelsAround(outline) & cv::Rect({0, 0}, frame.size());
  if (region.empty()) return;
  Blend(LayInto(pyramid, frame_from_image, region, cv::BORDER_CONSTANT), frame(region));
}

/// A mask of the region: 255 where the image covers at least half of a pixel, else 0.
cv::Mat ComputeCoverage(const std::vector<cv::Mat>& pyramid, const Eigen::Matrix3d& frame_from_image,
                        const cv::Rect& region) {
  cv::Mat alpha;
  cv::extractChannel(LayInto(pyramid, frame_from_image, region, cv::BORDER_CONSTANT), alpha, 3);
  return alpha >= kOpaque;
}

void AddSensorNoise(cv::Mat& image, double deviation, std::uint64_t seed) {
  cv::Mat noise(image.size(), CV_16SC3);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  cv::add(image, noise, image, cv::noArray(), CV_8U);
}

}  // namespace

SyntheticFlight::SyntheticFlight(const FlightOptions& options) : options_(options) {
  VICTORIOUS_CHECK(options.frames > 0 && options.width > 0 && options.height > 0);
  VICTORIOUS_CHECK(options.objects >= 0 && options.objects <= kMaxObjects && options.zoom > 0);
  Random random(SeedFor(options.seed, kPathSeed));
  heading_rad_ = random.Uniform(-0.3, 0.3);
  climb_phase_rad_ = random.Uniform(0, 2 * kPi);

  const double farthest = std::hypot(options.width, options.height) / 2 / (options.zoom * (1 - kZoomVariation));
  const double margin = farthest + 40;
  reach_px_ = options.path_widths * options.width / options.zoom;
  start_ = {margin, margin};
  const cv::Size town(static_cast<int>(reach_px_ + 2 * margin), static_cast<int>(2 * margin));
  ground_ = BuildPyramid(DrawTown(town, SeedFor(options.seed, kTownSeed)));
  PlaceObjects();
}

void SyntheticFlight::PlaceObjects() {
  const double spacing = std::min(kObjectSpacing, (1 - 2 * kFirstObject) / std::max(1, options_.objects - 1));
  const double frame_height = options_.height / options_.zoom;
  for (int i = 0; i < options_.objects; ++i) {
    Random random(SeedFor(options_.seed, kObjectSeed + 16 * static_cast<std::uint64_t>(i)));
    const auto kind = static_cast<ObjectKind>(i % kNumObjectKinds);
    FlightObject object;
    object.drawn = DrawObject(kind, random.Next());
    object.name = std::string(Name(kind)) + (i < kNumObjectKinds ? "" : std::to_string(i / kNumObjectKinds + 1));
    object.pyramid = BuildPyramid(PremultiplyAlpha(object.drawn.image));
    object.shadow = BuildPyramid(MakeShadow(object.drawn.image));
    const double aside = (i % 2 == 0 ? -0.16 : 0.16) * frame_height;
    object.course.base = start_ + Eigen::Vector2d((kFirstObject + i * spacing) * reach_px_, aside);
    const double way = i == 0 ? 0.0 : random.Uniform(-0.6, 0.6);  // the first object moves along the camera path
    object.course.swing = 0.16 * frame_height * Eigen::Vector2d(std::cos(way), std::sin(way));
    object.course.phase_rad = i == 0 ? 0.0 : random.Uniform(0, 2 * kPi);
    object.course.heading_rad = random.Uniform(-kPi, kPi);
    const double turn = random.Uniform(1.2, 2.6);
    object.course.turn_rad = random.Uniform() < 0.5 ? -turn : turn;
    objects_.push_back(std::move(object));
  }
}

double SyntheticFlight::Phase(int index) const {
  VICTORIOUS_CHECK(index >= 0 && index < options_.frames);
  return 2 * kPi * index / options_.frames;
}

Eigen::Matrix3d SyntheticFlight::FrameFromGround(int index) const {
  const double phase = Phase(index);
  const Eigen::Vector2d camera = start_ + Eigen::Vector2d(reach_px_ * (1 - std::cos(phase)) / 2, 0);
  Similarity2 view;
  view.scale = options_.zoom * (1 + kZoomVariation * std::sin(1.5 * phase + climb_phase_rad_));
  view.rotation_rad = heading_rad_ + kRotationAmplitudeRad * std::sin(phase);
  view.translation = -(view.Linear() * camera);
  return Shift(options_.width / 2.0, options_.height / 2.0) * view.Matrix();
}

Similarity2 SyntheticFlight::GroundFromObject(const FlightObject& object, int index) const {
  const double phase = Phase(index);
  const Course& course = object.course;
  Similarity2 pose;
  pose.scale = options_.object_scale * (1 + kScaleVariation * std::sin(2 * phase + course.phase_rad));
  pose.rotation_rad = course.heading_rad + course.turn_rad * phase / (2 * kPi);
  const Eigen::Vector2d middle(object.drawn.image.cols / 2.0, object.drawn.image.rows / 2.0);
  pose.translation = course.base + std::sin(phase + course.phase_rad) * course.swing - pose.Linear() * middle;
  return pose;
}

Eigen::Matrix3d SyntheticFlight::FrameFromObject(int object, int index) const {
  return FrameFromGround(index) * GroundFromObject(objects_.at(object), index).Matrix();
}

Frame SyntheticFlight::Render(int index) const {
  const Eigen::Matrix3d frame_from_ground = FrameFromGround(index);
  const cv::Rect whole(0, 0, options_.width, options_.height);
  cv::Mat image = LayInto(ground_, frame_from_ground, whole, cv::BORDER_REFLECT_101);
  for (const FlightObject& object : objects_) {
    const Eigen::Matrix3d ground_from_object = GroundFromObject(object, index).Matrix();
    Overlay(object.shadow, frame_from_ground * Shift(kShadowPx.x(), kShadowPx.y()) * ground_from_object, image);
    Overlay(object.pyramid, frame_from_ground * ground_from_object, image);
  }
  if (options_.blur_px > 0) cv::GaussianBlur(image, image, {}, options_.blur_px);
  if (options_.noise > 0)
    AddSensorNoise(image, options_.noise,
                   SeedFor(options_.seed, kNoiseSeed + 16 * (1 + static_cast<std::uint64_t>(index))));
  return {index, index / options_.fps, image};
}

cv::Mat SyntheticFlight::ObjectCoverage(int object, int index, const cv::Rect& region) const {
  return ComputeCoverage(objects_[object].pyramid, FrameFromObject(object, index), region);
}

std::vector<TruthRow> SyntheticFlight::Truth(int index) const {
  std::vector<TruthRow> rows;
  const int count = static_cast<int>(objects_.size());
  for (int i = 0; i < count; ++i) {
    const Eigen::Matrix3d frame_from_object = FrameFromObject(i, index);
    const Polygon outline = Mapped(frame_from_object, objects_[i].drawn.outline);
    const cv::Rect region = PixelsAround(Mapped(frame_from_object, OutlineOf(objects_[i].drawn.image)));
    const cv::Rect in_view = region & cv::Rect(0, 0, options_.width, options_.height);
    if (in_view.empty()) continue;

    const cv::Mat own = ObjectCoverage(i, index, region);
    cv::Mat visible = own(in_view - region.tl()).clone();
    for (int above = i + 1; above < count; ++above) visible.setTo(0, ObjectCoverage(above, index, in_view));
    const int pixels = cv::countNonZero(visible);
    if (pixels == 0) continue;

    const cv::Rect box = cv::boundingRect(visible) + in_view.tl();
    TruthRow row;
    row.object_index = i;
    row.frame = index;
    row.time_s = index / options_.fps;
    row.object = objects_[i].name + "-1";
    row.model = objects_[i].name;
    row.outline = outline;
    row.box = {double(box.x), double(box.y), double(box.width), double(box.height)};
    row.visible = static_cast<double>(pixels) / cv::countNonZero(own);
    row.pixels = pixels;
    rows.push_back(std::move(row));
  }
  return rows;
}

cv::Mat SyntheticFlight::ObjectPhoto(int object) const { return objects_.at(object).drawn.image.clone(); }

std::string SyntheticFlight::ObjectName(int object) const { return objects_.at(object).name; }

}  // namespace victorious::testing
