// The engine `sift`, first stage: an image's octaves of Gaussian levels in 16-bit integers, and the extrema of their
// differences. Rows roll through all levels of an octave while they are in the cache.
// Source: D. Lowe, IJCV 60(2), 2004, section 3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/kernels/blur.h"
#include "victorious/kernels/dog_extrema.h"
#include "victorious/kernels/level.h"

namespace victorious {

/// The levels 0 to 5 of an octave: level l has the blur 1.6 * 2^(l / 3) px of the octave.
using OctaveLevels = std::array<kernels::LevelView, kernels::kLevels>;

/// A pixel whose difference of levels layer + 1 and layer is an extremum among its 26 neighbours.
struct GridExtremum {
  std::int32_t octave = 0;  ///< 0: the doubled image
  std::int32_t y = 0;       ///< px of the octave
  std::int32_t x = 0;
  std::int32_t layer = 0;  ///< 1 to 3

  bool operator==(const GridExtremum&) const = default;

  /// The order of keypoints: by octave, tile of 64 x 64 px row by row, layer, y and x. The windows of neighbours in
  /// this order overlap, so that they are in the cache.
  [[nodiscard]] std::uint64_t Order() const {
    const auto field = [](std::int32_t value, int shift) { return static_cast<std::uint64_t>(value) << shift; };
    return field(octave, 48) | field(y >> 6, 32) | field(x >> 6, 16) | field(layer, 12) | field(y & 63, 6) |
           field(x & 63, 0);
  }
};

/// Memory is kept from image to image. Not thread-safe; uses oneTBB inside, with results that do not depend on the
/// number of threads.
class ScaleSpace {
 public:
  /// Extrema at least this far from the border of their octave are searched, px.
  static constexpr int kBorder_px = 5;

  ScaleSpace();
  ~ScaleSpace();

  /// @param grey  CV_8UC1, not empty
  /// @param min_difference  grey levels; smaller differences of Gaussians are no extrema
  void Build(const cv::Mat& grey, double min_difference);

  [[nodiscard]] const std::vector<OctaveLevels>& octaves() const { return octaves_; }
  /// In an order that depends on the number of threads.
  [[nodiscard]] const std::vector<GridExtremum>& extrema() const { return extrema_; }

 private:
  struct Lines;  // scratch memory of a task
  struct Band;   // rows of an octave that one task computes

  void Allocate(const cv::Size& size);
  void StartOctave(const cv::Mat& grey, std::size_t octave, int first_y, int end_y, Lines& lines);
  void BlurRows(std::size_t octave, std::size_t level, int first_y, int end_y, Lines& lines);
  void SearchRows(std::size_t octave, int first_y, int end_y, Lines& lines);
  void RollBand(const cv::Mat& grey, std::size_t octave, int first_y, int end_y, Lines& lines);
  void CloseSeam(std::size_t octave, int y, Lines& lines);
  [[nodiscard]] std::int16_t* MutableRow(std::size_t octave, std::size_t level, int y);

  kernels::DoublingTaps doubling_;
  std::array<kernels::BlurTaps, kernels::kLevels> blur_;  // [l]: from level l - 1 to l
  std::array<int, kernels::kLevels> reach_{};             // [l]: rows of level 0 around a row of level l
  std::int16_t threshold_ = 0;
  std::vector<std::int16_t> pixels_;
  std::vector<OctaveLevels> octaves_;
  std::vector<std::unique_ptr<Lines>> lines_;
  std::vector<GridExtremum> extrema_;
};

}  // namespace victorious
