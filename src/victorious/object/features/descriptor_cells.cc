#include "victorious/object/features/descriptor_cells.h"

#include <algorithm>

#include "victorious/kernels/short_nearest.h"

namespace victorious {
namespace {

// Less kernels::kShortCentre.
constexpr std::int8_t kCentres[kDescriptorCells][kernels::kShortBytes] = {
#include "victorious/object/features/descriptor_cells.inc"
};

kernels::ShortSet PackCentres() {
  std::vector<std::uint8_t> rows;
  for (const auto& centre : kCentres) {
    for (const std::int8_t value : centre) rows.push_back(static_cast<std::uint8_t>(value + kernels::kShortCentre));
  }
  return kernels::PackShort(rows);
}

}  // namespace

std::span<const std::int8_t> CellCentre(std::size_t cell) { return kCentres[cell]; }

ShortDescriptors ShortenDescriptors(std::span<const std::uint8_t> descriptors) {
  static const kernels::ShortSet kSet = PackCentres();
  ShortDescriptors made{.rows = kernels::ShortenToQueries(descriptors), .cells = {}};
  const std::size_t count = made.rows.size() / kernels::kShortBytes;
  std::vector<const std::int8_t*> queries(count);
  for (std::size_t i = 0; i < count; ++i) queries[i] = made.rows.data() + i * kernels::kShortBytes;
  const std::vector<kernels::QueryBlocks> blocks(count, {{0, kSet.block_count()}, {}});
  std::vector<std::uint32_t> nearest(count);
  kernels::FindShortNearest(queries, kSet, 1, blocks, nearest);
  made.cells.resize(count);
  std::ranges::transform(nearest, made.cells.begin(), [](std::uint32_t i) { return static_cast<std::uint16_t>(i); });
  return made;
}

}  // namespace victorious
