#include "victorious/object/features/scale_space.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "victorious/base/check.h"
#include "victorious/object/features/feature_extractor.h"

namespace victorious {
namespace {

constexpr double kImageSigma_px = 0.5;  // assumed blur of a camera's image (Lowe 2004)
constexpr int kBlock = 8;               // rows that a task blurs at a time
constexpr std::size_t kStrip = 512;     // columns: the rows of a vertical pass over a strip stay in the L1 cache
constexpr int kMargin = 32;             // pixels repeated on both sides of a row; at least the widest kernel's radius
constexpr int kMinBandHeight = 160;     // several times the rows that two bands share
static_assert(kMargin >= kernels::kMaxBlurRadius);
static_assert(kOctaveLayers == static_cast<int>(kernels::kSearchedLayers));

// Mirrors an index at the first and the last of `count`, which are not repeated.
int Mirror(int i, int count) {
  if (count == 1) return 0;
  while (i < 0 || i >= count) i = i < 0 ? -i : 2 * (count - 1) - i;
  return i;
}

int Clamp(int i, int count) { return std::clamp(i, 0, count - 1); }

// Repeats `reach` pixels on both sides of `line`, of which `width` from kMargin on are set.
template <typename Index>
void FillMargins(std::int16_t* line, int width, int reach, Index index) {
  std::int16_t* const first = line + kMargin;
  for (int x = 1; x <= reach; ++x) {
    first[-x] = first[index(-x, width)];
    first[width - 1 + x] = first[index(width - 1 + x, width)];
  }
}

// Elements from row to row of a level: room for what kernels write beyond a row, which is two vectors if it is doubled;
// and an odd number of cache lines, so that the rows of a window do not compete for the same few places of the cache.
std::size_t LevelStride(int width) {
  static_assert(kernels::kRowMultiple * sizeof(std::int16_t) == 64);
  return 2 * kernels::PaddedWidth(static_cast<std::size_t>(width + 1) / 2) + kernels::kRowMultiple;
}

}  // namespace

struct ScaleSpace::Lines {
  std::vector<std::int16_t> pixels;
  std::size_t stride = 0;
  std::vector<kernels::DogExtremum> in_row;
  std::vector<GridExtremum> found;

  void Resize(int width) {
    stride = kernels::PaddedWidth(static_cast<std::size_t>(width)) + 2 * kMargin;
    pixels.resize(std::max(pixels.size(), stride * kBlock));
    in_row.resize(std::max(in_row.size(), kernels::kSearchedLayers * static_cast<std::size_t>(width)));
    found.clear();
  }
  std::int16_t* Line(int i) { return pixels.data() + static_cast<std::size_t>(i) * stride; }
};

ScaleSpace::ScaleSpace() {
  const double doubled_sigma = 2 * kImageSigma_px;
  doubling_ =
      kernels::MakeDoublingTaps(std::sqrt(kFirstLayerSigma_px * kFirstLayerSigma_px - doubled_sigma * doubled_sigma));
  for (std::size_t l = 1; l < kernels::kLevels; ++l) {
    const double below = kFirstLayerSigma_px * std::pow(2.0, static_cast<double>(l - 1) / kOctaveLayers);
    const double sigma = kFirstLayerSigma_px * std::pow(2.0, static_cast<double>(l) / kOctaveLayers);
    blur_[l] = kernels::MakeBlurTaps(std::sqrt(sigma * sigma - below * below));
    reach_[l] = reach_[l - 1] + blur_[l].radius;
  }
}

ScaleSpace::~ScaleSpace() = default;

std::int16_t* ScaleSpace::MutableRow(std::size_t octave, std::size_t level, int y) {
  return pixels_.data() + (octaves_[octave][level].Row(y) - pixels_.data());
}

void ScaleSpace::Allocate(const cv::Size& size) {
  constexpr int kMinSide_px = 2 * kBorder_px + 1;
  std::vector<cv::Size> sizes;
  for (cv::Size octave(2 * size.width, 2 * size.height); std::min(octave.width, octave.height) >= kMinSide_px;
       octave = {octave.width / 2, octave.height / 2}) {
    sizes.push_back(octave);
  }
  std::size_t total = 0;
  for (const cv::Size& octave : sizes) {
    total += kernels::kLevels * LevelStride(octave.width) * static_cast<std::size_t>(octave.height);
  }
  total += LevelStride(2 * size.width) + kernels::kRowMultiple;  // kernels may read past the last row
  if (pixels_.size() < total) {
    pixels_ = std::vector<std::int16_t>();  // resize() alone would hold both, and copy
    pixels_.resize(total);
  }
  octaves_.resize(sizes.size());
  std::int16_t* next = pixels_.data();
  for (std::size_t o = 0; o < sizes.size(); ++o) {
    const std::size_t stride = LevelStride(sizes[o].width);
    for (kernels::LevelView& level : octaves_[o]) {
      level = {next, static_cast<std::ptrdiff_t>(stride), sizes[o].width, sizes[o].height};
      next += stride * static_cast<std::size_t>(sizes[o].height);
    }
  }
}

void ScaleSpace::StartOctave(const cv::Mat& grey, std::size_t octave, int first_y, int end_y, Lines& lines) {
  const int width = octaves_[octave][0].width;
  if (octave > 0) {
    const kernels::LevelView& from = octaves_[octave - 1][kernels::kSearchedLayers];
    for (int y = first_y; y < end_y; ++y) {
      const std::int16_t* in = from.Row(2 * y);
      std::int16_t* out = MutableRow(octave, 0, y);
      for (int x = 0; x < width; ++x) out[x] = in[2 * x];
    }
    return;
  }
  const auto columns = static_cast<std::size_t>(grey.cols);
  for (int i = first_y / 2; 2 * i < end_y; ++i) {
    std::array<const std::uint8_t*, 2 * kernels::kDoublingReach + 1> rows;
    for (int j = 0; j < static_cast<int>(rows.size()); ++j) {
      rows[static_cast<std::size_t>(j)] = grey.ptr<std::uint8_t>(Clamp(i + j - kernels::kDoublingReach, grey.rows));
    }
    kernels::DoubleColumns(rows.data(), doubling_, columns, lines.Line(0) + kMargin, lines.Line(1) + kMargin);
    for (int odd = 0; odd < 2; ++odd) {
      FillMargins(lines.Line(odd), grey.cols, kernels::kDoublingReach, Clamp);
      kernels::DoubleRow(lines.Line(odd) + kMargin, doubling_, columns, MutableRow(octave, 0, 2 * i + odd));
    }
  }
}

void ScaleSpace::BlurRows(std::size_t octave, std::size_t level, int first_y, int end_y, Lines& lines) {
  const kernels::LevelView& below = octaves_[octave][level - 1];
  const kernels::BlurTaps& taps = blur_[level];
  const auto width = static_cast<std::size_t>(below.width);
  std::array<const std::int16_t*, kBlock + 2 * kernels::kMaxBlurRadius> rows;
  for (int block = first_y; block < end_y; block += kBlock) {
    const int count = std::min(kBlock, end_y - block);
    const int needed = count + 2 * taps.radius;
    for (int k = 0; k < needed; ++k) {
      rows[static_cast<std::size_t>(k)] = below.Row(Mirror(block + k - taps.radius, below.height));
    }
    for (std::size_t strip = 0; strip < width; strip += kStrip) {
      const std::size_t columns = std::min(kStrip, width - strip);
      for (int i = 0; i < count; ++i) {
        kernels::BlurColumns(&rows[static_cast<std::size_t>(i)], taps, columns, lines.Line(i) + kMargin + strip);
      }
      for (int k = 0; k < needed; ++k) rows[static_cast<std::size_t>(k)] += columns;
    }
    for (int i = 0; i < count; ++i) {
      FillMargins(lines.Line(i), below.width, taps.radius, Mirror);
      kernels::BlurRow(lines.Line(i) + kMargin, taps, width, MutableRow(octave, level, block + i));
    }
  }
}

void ScaleSpace::SearchRows(std::size_t octave, int first_y, int end_y, Lines& lines) {
  const OctaveLevels& levels = octaves_[octave];
  const int height = levels[0].height;
  for (int y = std::max(first_y, kBorder_px); y < std::min(end_y, height - kBorder_px); ++y) {
    kernels::LevelRows rows;
    for (std::size_t l = 0; l < kernels::kLevels; ++l) {
      rows.row[l] = {levels[l].Row(y - 1), levels[l].Row(y), levels[l].Row(y + 1)};
    }
    const std::size_t count =
        kernels::FindDogExtrema(rows, kBorder_px, levels[0].width - kBorder_px, threshold_, lines.in_row.data());
    for (std::size_t i = 0; i < count; ++i) {
      lines.found.push_back({static_cast<std::int32_t>(octave), y, lines.in_row[i].x, lines.in_row[i].layer});
    }
  }
}

// Level l of a band lacks reach_[l] rows at each side that borders on another band; CloseSeam adds them.
void ScaleSpace::RollBand(const cv::Mat& grey, std::size_t octave, int first_y, int end_y, Lines& lines) {
  const int height = octaves_[octave][0].height;
  std::array<int, kernels::kLevels> next;  // rows below are done
  std::array<int, kernels::kLevels> end;
  for (std::size_t l = 0; l < kernels::kLevels; ++l) {
    next[l] = first_y == 0 ? 0 : first_y + reach_[l];
    end[l] = end_y == height ? height : end_y - reach_[l];
  }
  constexpr std::size_t kLast = kernels::kLevels - 1;
  int searched = next[kLast] == 0 ? 0 : next[kLast] + 1;
  while (next[kLast] < end[kLast]) {
    const int started = std::min(next[0] + 2 * kBlock, end[0]);
    StartOctave(grey, octave, next[0], started, lines);
    next[0] = started;
    for (std::size_t l = 1; l < kernels::kLevels; ++l) {
      const int ready = next[l - 1] == height ? height : next[l - 1] - blur_[l].radius;
      const int stop = std::min(ready, end[l]);
      if (stop <= next[l]) continue;
      BlurRows(octave, l, next[l], stop, lines);
      next[l] = stop;
    }
    const int stop = next[kLast] == height ? height : next[kLast] - 1;
    SearchRows(octave, searched, stop, lines);
    searched = std::max(searched, stop);
  }
}

void ScaleSpace::CloseSeam(std::size_t octave, int y, Lines& lines) {
  for (std::size_t l = 1; l < kernels::kLevels; ++l) BlurRows(octave, l, y - reach_[l], y + reach_[l], lines);
  const int reach = reach_.back() + 1;
  SearchRows(octave, y - reach, y + reach, lines);
}

void ScaleSpace::Build(const cv::Mat& grey, double min_difference) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1 && !grey.empty());
  threshold_ = static_cast<std::int16_t>(std::min(32000.0, min_difference * kernels::kLevelUnit));
  Allocate(grey.size());
  extrema_.clear();
  for (std::size_t octave = 0; octave < octaves_.size(); ++octave) {
    const int height = octaves_[octave][0].height;
    const int bands = std::clamp(height / kMinBandHeight, 1, oneapi::tbb::this_task_arena::max_concurrency());
    const auto edge = [&](int band) { return band == bands ? height : height / 2 * band / bands * 2; };
    while (lines_.size() < static_cast<std::size_t>(bands)) lines_.push_back(std::make_unique<Lines>());
    for (int band = 0; band < bands; ++band) lines_[static_cast<std::size_t>(band)]->Resize(octaves_[octave][0].width);
    oneapi::tbb::this_task_arena::isolate([&] {  // else a waiting thread could start on another image
      oneapi::tbb::parallel_for(0, bands, [&](int band) {
        RollBand(grey, octave, edge(band), edge(band + 1), *lines_[static_cast<std::size_t>(band)]);
      });
      oneapi::tbb::parallel_for(
          1, bands, [&](int band) { CloseSeam(octave, edge(band), *lines_[static_cast<std::size_t>(band)]); });
    });
    for (int band = 0; band < bands; ++band) {
      const Lines& lines = *lines_[static_cast<std::size_t>(band)];
      extrema_.insert(extrema_.end(), lines.found.begin(), lines.found.end());
    }
  }
}

}  // namespace victorious
