#include "victorious/category/channels/channel_windows.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

// Levels of an octave have cells of this many px of its image, up to twice as many.
constexpr double kMinCell_px = 1.4;
constexpr int kMinLevelCells = 8;  // a smaller side is not searched

// The octave whose image is resampled least for cells of this size.
int OctaveOf(double cell_px, int octaves) {
  const int octave = static_cast<int>(std::floor(std::log2(cell_px / kMinCell_px)));
  return std::clamp(octave, 0, octaves - 1);
}

}  // namespace

int CopiedFeature(const HeadingCopy& copy, int feature) {
  int x = feature % kWindowCells;
  int y = feature / kWindowCells % kWindowCells;
  int channel = feature / (kWindowCells * kWindowCells);
  int orientation = channel - kFirstOrientation;
  constexpr int kRight = kOrientationChannels / 2;
  if (copy.is_transposed) {
    std::swap(x, y);
    orientation = (kRight - orientation + kOrientationChannels) % kOrientationChannels;
  }
  if (copy.is_mirrored) {
    x = kWindowCells - 1 - x;
    orientation = (kOrientationChannels - orientation) % kOrientationChannels;
  }
  if (channel >= kFirstOrientation) channel = kFirstOrientation + orientation;
  return (channel * kWindowCells + y) * kWindowCells + x;
}

cv::Size2d BoxOfHeading(double length, double width, double angle_rad) {
  const double c = std::abs(std::cos(angle_rad));
  const double s = std::abs(std::sin(angle_rad));
  return {length * c + width * s, length * s + width * c};
}

cv::Point2d ChannelLevel::Middle(int x, int y) const {
  constexpr double kHalf = kWindowCells / 2.0 - kLevelBorder;
  return {(x + kHalf) * cell_width_px, (y + kHalf) * cell_height_px};
}

WindowFeatures ChannelLevel::Features(int x, int y, const HeadingCopy& copy) const {
  WindowFeatures features(kWindowFeatures);
  for (int f = 0; f < kWindowFeatures; ++f) {
    const int seen = CopiedFeature(copy, f);
    const int column = x + seen % kWindowCells;
    const int row = y + seen / kWindowCells % kWindowCells;
    const int channel = seen / (kWindowCells * kWindowCells);
    features[static_cast<std::size_t>(f)] =
        planes.bytes[static_cast<std::size_t>(planes.OffsetOf(channel, column, row))];
  }
  return features;
}

double FinestCell(const cv::Size& image, double min_cell_px) {
  constexpr double kMaxLevelBytes = 1 << 30;
  const double pixels = static_cast<double>(image.width) * image.height;
  return std::max(min_cell_px, std::sqrt(pixels * kChannelCount / kMaxLevelBytes));
}

void ForEachLevel(const cv::Mat& image, double min_cell_px, const std::function<void(const ChannelLevel&)>& use) {
  cv::Mat octave_image = LumaAndChroma(image);
  double cell_px = FinestCell(image.size(), min_cell_px);
  ChannelLevel level;
  for (int octave = 0; std::min(octave_image.cols, octave_image.rows) >= kMinLevelCells; ++octave) {
    cv::Mat half = HalveImage(octave_image);
    const double base_cell_px = std::exp2(octave + 1);
    const double limit_px = 2 * kMinCell_px * std::exp2(octave);
    if (cell_px < limit_px) {
      const ChannelPlanes base = ComputeChannels(octave_image, half);
      for (; cell_px < limit_px; cell_px *= std::exp2(1.0 / kLevelsPerOctave)) {
        const int columns = cvRound(base.columns * base_cell_px / cell_px);
        const int rows = cvRound(base.rows * base_cell_px / cell_px);
        if (std::min(columns, rows) < kMinLevelCells) return;
        ResampleChannels(base, columns, rows, kLevelBorder, level.planes);
        level.cell_width_px = base.columns * base_cell_px / columns;
        level.cell_height_px = base.rows * base_cell_px / rows;
        if (level.WindowColumns() > 0 && level.WindowRows() > 0) use(level);
      }
    }
    octave_image = std::move(half);
  }
}

WindowCutter::WindowCutter(const cv::Mat& image) {
  octaves_.push_back(LumaAndChroma(image));
  while (std::min(octaves_.back().cols, octaves_.back().rows) >= 2 * kMinLevelCells) {
    octaves_.push_back(HalveImage(octaves_.back()));
  }
}

WindowFeatures WindowCutter::Cut(cv::Point2d middle, double cell_px, double turn_rad, bool mirrored) const {
  const int octave = OctaveOf(cell_px, static_cast<int>(octaves_.size()));
  const double scale = std::exp2(octave);
  const double cell = cell_px / scale;
  constexpr double kAround_px = 12;  // the gradients' mean, and their reach
  const int reach = kBaseCell_px * static_cast<int>(std::ceil((cell * kWindowCells / 2 + kAround_px) / kBaseCell_px));
  // Pixel centres of the patch, from its middle, turned back, mirrored back, to pixel centres of the octave's image.
  const double c = std::cos(turn_rad);
  const double s = std::sin(turn_rad);
  const double flip = mirrored ? -1 : 1;
  const double from_middle = 0.5 - reach;
  const cv::Matx23d to_image(c, s, middle.x / scale - 0.5 + (c + s) * from_middle,  //
                             -flip * s, flip * c, middle.y / scale - 0.5 + flip * (c - s) * from_middle);
  cv::Mat patch;
  cv::warpAffine(octaves_[static_cast<std::size_t>(octave)], patch, to_image, {2 * reach, 2 * reach},
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  const ChannelPlanes base = ComputeChannels(patch, HalveImage(patch));
  // Cell i of the window lies at ((i + 1/2 - half) cell + reach) px of the patch.
  const double step = cell / kBaseCell_px;
  const double first = ((0.5 - kWindowCells / 2.0) * cell + reach) / kBaseCell_px - 0.5;
  const cv::Matx23d to_base(step, 0, first, 0, step, first);
  WindowFeatures features(kWindowFeatures);
  for (int channel = 0; channel < kChannelCount; ++channel) {
    cv::Mat window(kWindowCells, kWindowCells, CV_8UC1,
                   features.data() + static_cast<std::ptrdiff_t>(channel) * kWindowCells * kWindowCells);
    cv::warpAffine(base.Plane(channel), window, to_base, window.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
  }
  return features;
}

}  // namespace victorious
