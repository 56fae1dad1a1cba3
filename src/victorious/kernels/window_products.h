// kernels/, the correlation of templates with a map: the sum of products of each template with the map's window at each
// position,
//   p_t(y, x) = sum over r, c, d of map(y + r, x + c, d) template_t(r, c, d).
// Maps and templates are cells of some values each, the values of a cell side by side ("channels last"): a row of a
// template and the part of the map's row below it are contiguous, and their scalar product is a loop over both.
//
// window_products_ref.cc is the reference; window_products_simd.cc (Highway, every instruction set) returns identical
// bits. C++20: no <expected> here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace victorious::kernels {

inline constexpr std::int16_t kMaxMapValue = 255;        ///< of a map, whose values are not negative
inline constexpr std::int16_t kMaxTemplateValue = 1023;  ///< absolute, of a template
/// Values of a template: as many products of the largest values add up to less than 2^31.
inline constexpr std::size_t kMaxWindowValues = 8192;

/// Cells of some values each, row by row, without gaps: the value d of the cell in row y and column x is
/// values[(y cols + x) depth + d]. Non-owning.
struct MapView {
  const std::int16_t* values = nullptr;  ///< rows x cols x depth, each in [0, kMaxMapValue]
  std::size_t rows = 0;
  std::size_t cols = 0;
  std::size_t depth = 0;
};

/// Templates of one size one after another, each like a map with cells of the map's depth. Non-owning.
struct BankView {
  const std::int16_t* values = nullptr;  ///< templates x height x width x depth, each of at most kMaxTemplateValue
  std::size_t templates = 0;
  std::size_t height = 0;
  std::size_t width = 0;
};

/// The sums of products of each template t with the map's window at each position, exactly:
///   out[(t (rows - height + 1) + y) (cols - width + 1) + x] = p_t(y, x).
/// 1 <= height <= rows; 1 <= width <= cols; 1 <= depth; height width depth <= kMaxWindowValues.
/// @param out  templates x (rows - height + 1) x (cols - width + 1) values
/// Cost: templates height width depth products of 16 bits for each position; copies of the map and of the bank.
void WindowProducts(const MapView& map, const BankView& bank, std::span<std::int32_t> out);
void WindowProductsRef(const MapView& map, const BankView& bank, std::span<std::int32_t> out);

}  // namespace victorious::kernels
