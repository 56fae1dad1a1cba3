#include "victorious/object/features/sift_keypoint.h"

#include <algorithm>
#include <cmath>

#include "victorious/object/features/feature_extractor.h"

namespace victorious {
namespace {

constexpr int kMaxMoves = 5;
constexpr double kOrientationSigma = 1.5;  // of the window, in sigmas of the keypoint
constexpr double kPeakFraction = 0.8;      // of the maximum
constexpr float kMinLayer = 0.5F;          // refined layers lie between
constexpr float kMaxLayer = kOctaveLayers + 0.5F;

// Derivatives of D at a pixel by central differences, in fractions of the range of grey.
struct Derivatives {
  double value = 0;
  double x = 0, y = 0, s = 0;
  double xx = 0, yy = 0, ss = 0, xy = 0, xs = 0, ys = 0;
};

Derivatives DifferentiateDog(const OctaveLevels& levels, const GridExtremum& at) {
  constexpr double kUnit = 1.0 / (255.0 * kernels::kLevelUnit);
  const auto d = [&](int dx, int dy, int ds) {
    const auto layer = static_cast<std::size_t>(at.layer + ds);
    return static_cast<double>(levels[layer + 1].Row(at.y + dy)[at.x + dx] - levels[layer].Row(at.y + dy)[at.x + dx]);
  };
  const double twice = 2 * d(0, 0, 0);
  return {.value = kUnit * d(0, 0, 0),
          .x = kUnit / 2 * (d(1, 0, 0) - d(-1, 0, 0)),
          .y = kUnit / 2 * (d(0, 1, 0) - d(0, -1, 0)),
          .s = kUnit / 2 * (d(0, 0, 1) - d(0, 0, -1)),
          .xx = kUnit * (d(1, 0, 0) + d(-1, 0, 0) - twice),
          .yy = kUnit * (d(0, 1, 0) + d(0, -1, 0) - twice),
          .ss = kUnit * (d(0, 0, 1) + d(0, 0, -1) - twice),
          .xy = kUnit / 4 * (d(1, 1, 0) - d(-1, 1, 0) - d(1, -1, 0) + d(-1, -1, 0)),
          .xs = kUnit / 4 * (d(1, 0, 1) - d(-1, 0, 1) - d(1, 0, -1) + d(-1, 0, -1)),
          .ys = kUnit / 4 * (d(0, 1, 1) - d(0, -1, 1) - d(0, 1, -1) + d(0, -1, -1))};
}

struct Offset {
  double x = 0, y = 0, s = 0;
};

// Solves H offset = -gradient by Cramer's rule; nothing if H is singular.
std::optional<Offset> SolveOffset(const Derivatives& d) {
  const double minor_x = d.yy * d.ss - d.ys * d.ys;
  const double minor_y = d.xy * d.ss - d.ys * d.xs;
  const double minor_s = d.xy * d.ys - d.yy * d.xs;
  const double det = d.xx * minor_x - d.xy * minor_y + d.xs * minor_s;
  if (det == 0) return std::nullopt;
  const double in_x = d.x * minor_x - d.xy * (d.y * d.ss - d.ys * d.s) + d.xs * (d.y * d.ys - d.yy * d.s);
  const double in_y = d.xx * (d.y * d.ss - d.ys * d.s) - d.x * minor_y + d.xs * (d.xy * d.s - d.y * d.xs);
  const double in_s = d.xx * (d.yy * d.s - d.y * d.ys) - d.xy * (d.xy * d.s - d.y * d.xs) + d.x * minor_s;
  return Offset{-in_x / det, -in_y / det, -in_s / det};
}

bool IsInside(const OctaveLevels& levels, const GridExtremum& at) {
  constexpr int kBorder = ScaleSpace::kBorder_px;
  return at.layer >= 1 && at.layer <= kOctaveLayers && at.x >= kBorder && at.x < levels[0].width - kBorder &&
         at.y >= kBorder && at.y < levels[0].height - kBorder;
}

}  // namespace

double RefinedExtremum::Sigma() const {
  return kFirstLayerSigma_px * std::exp2(static_cast<double>(layer) / kOctaveLayers);
}

std::optional<RefinedExtremum> Refine(const OctaveLevels& levels, const GridExtremum& extremum,
                                      const RefineOptions& options) {
  constexpr double kMaxOffset = 1e6;  // a larger one fits in no octave
  GridExtremum at = extremum;
  for (int move = 0; move < kMaxMoves; ++move) {
    const Derivatives d = DifferentiateDog(levels, at);
    const std::optional<Offset> offset = SolveOffset(d);
    if (!offset) return std::nullopt;
    const double farthest = std::max({std::abs(offset->x), std::abs(offset->y), std::abs(offset->s)});
    if (farthest < 0.5) {
      const double contrast = std::abs(d.value + 0.5 * (d.x * offset->x + d.y * offset->y + d.s * offset->s));
      if (contrast * kOctaveLayers < options.contrast_threshold) return std::nullopt;
      const double trace = d.xx + d.yy;
      const double det = d.xx * d.yy - d.xy * d.xy;
      const double edge = options.edge_threshold;
      if (det <= 0 || trace * trace * edge >= (edge + 1) * (edge + 1) * det) return std::nullopt;
      return RefinedExtremum{at, static_cast<float>(at.x + offset->x), static_cast<float>(at.y + offset->y),
                             static_cast<float>(at.layer + offset->s), static_cast<float>(contrast)};
    }
    if (!(farthest < kMaxOffset)) return std::nullopt;
    at.x += static_cast<std::int32_t>(std::lround(offset->x));
    at.y += static_cast<std::int32_t>(std::lround(offset->y));
    at.layer += static_cast<std::int32_t>(std::lround(offset->s));
    if (!IsInside(levels, at)) return std::nullopt;
  }
  return std::nullopt;
}

Orientations FindPeaks(std::span<const std::int32_t, kernels::kOrientationBins> histogram) {
  constexpr std::size_t kBins = kernels::kOrientationBins;
  std::array<std::int32_t, kBins + 4> padded;  // bin i at i + 2
  std::ranges::copy(histogram, padded.begin() + 2);
  padded[0] = histogram[kBins - 2];
  padded[1] = histogram[kBins - 1];
  padded[kBins + 2] = histogram[0];
  padded[kBins + 3] = histogram[1];
  std::array<std::int32_t, kBins + 2> smooth;  // bin i at i + 1
  for (std::size_t i = 0; i < kBins; ++i) {
    smooth[i + 1] = padded[i] + padded[i + 4] + 4 * (padded[i + 1] + padded[i + 3]) + 6 * padded[i + 2];
  }
  smooth[0] = smooth[kBins];
  smooth[kBins + 1] = smooth[1];
  const double lowest = kPeakFraction * std::ranges::max(smooth);
  Orientations found;
  for (std::size_t i = 0; i < kBins && found.count < kMaxOrientations; ++i) {
    const std::int32_t left = smooth[i];
    const std::int32_t here = smooth[i + 1];
    const std::int32_t right = smooth[i + 2];
    if (here < lowest || here <= left || here <= right) continue;
    const double bend = static_cast<double>(left) - 2.0 * here + right;
    found.bin[found.count++] = static_cast<float>(static_cast<double>(i) + 0.5 * (left - right) / bend);
  }
  return found;
}

OrientationWindows::OrientationWindows() {
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(windows_.size() - 1);
    const double layer = kMinLayer + fraction * (kMaxLayer - kMinLayer);
    windows_[i] =
        kernels::MakeOrientationWindow(kOrientationSigma * kFirstLayerSigma_px * std::exp2(layer / kOctaveLayers));
  }
}

const kernels::OrientationWindow& OrientationWindows::At(float layer) const {
  const float last = static_cast<float>(windows_.size() - 1);
  const float place = (layer - kMinLayer) / (kMaxLayer - kMinLayer) * last + 0.5F;
  return windows_[static_cast<std::size_t>(std::clamp(place, 0.0F, last))];
}

}  // namespace victorious
