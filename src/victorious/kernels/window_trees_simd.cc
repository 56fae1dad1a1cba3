// The scores of windows on any vector width, through Highway: one vector of neighbouring windows at a time, until
// all of them are rejected.
#include <algorithm>

#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/window_trees.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/window_trees_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void ScoreWindowsTarget(const std::uint8_t* cells, std::size_t count, std::span<const WindowTree> trees,
                        std::span<const std::int16_t> floors, std::int16_t* scores) {
  ScoreWindowsRef(cells, count, trees, floors, scores);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using D8 = hn::CappedTag<std::uint8_t, kWindowPadding>;
using DS8 = hn::RebindToSigned<D8>;
using D16 = hn::RepartitionToWide<DS8>;
using V16 = hn::Vec<D16>;

void ScoreWindowsTarget(const std::uint8_t* cells, std::size_t count, std::span<const WindowTree> trees,
                        std::span<const std::int16_t> floors, std::int16_t* scores) {
  const D8 d8;
  const DS8 ds8;
  const D16 d16;
  const hn::Half<DS8> half;
  const std::size_t lanes = hn::Lanes(d8);
  const auto leaf = [&](std::int8_t value) HWY_ATTR { return hn::Set(ds8, value); };
  for (std::size_t x = 0; x < count; x += lanes) {
    const std::uint8_t* const first = cells + x;
    V16 low = hn::Zero(d16);
    V16 high = hn::Zero(d16);
    auto low_rejected = hn::Lt(low, low);
    auto high_rejected = low_rejected;
    for (std::size_t stage = 0; stage < floors.size(); ++stage) {
      const std::size_t end = std::min(trees.size(), (stage + 1) * kTreesPerStage);
      for (std::size_t t = stage * kTreesPerStage; t < end; ++t) {
        const WindowTree& tree = trees[t];
        const auto below = hn::Lt(hn::LoadU(d8, first + tree.offset[0]), hn::Set(d8, tree.threshold[0]));
        const auto left = hn::Lt(hn::LoadU(d8, first + tree.offset[1]), hn::Set(d8, tree.threshold[1]));
        const auto right = hn::Lt(hn::LoadU(d8, first + tree.offset[2]), hn::Set(d8, tree.threshold[2]));
        const auto left_below = hn::RebindMask(ds8, left);
        const auto right_below = hn::RebindMask(ds8, right);
        const auto value = hn::IfThenElse(hn::RebindMask(ds8, below),
                                          hn::IfThenElse(left_below, leaf(tree.leaf[0]), leaf(tree.leaf[1])),
                                          hn::IfThenElse(right_below, leaf(tree.leaf[2]), leaf(tree.leaf[3])));
        low = hn::Add(low, hn::PromoteTo(d16, hn::LowerHalf(half, value)));
        high = hn::Add(high, hn::PromoteTo(d16, hn::UpperHalf(half, value)));
      }
      const V16 floor = hn::Set(d16, floors[stage]);
      low_rejected = hn::Or(low_rejected, hn::Lt(low, floor));
      high_rejected = hn::Or(high_rejected, hn::Lt(high, floor));
      if (hn::AllTrue(d16, hn::And(low_rejected, high_rejected))) break;
    }
    const V16 rejected = hn::Set(d16, kRejectedWindow);
    hn::StoreU(hn::IfThenElse(low_rejected, rejected, low), d16, scores + x);
    hn::StoreU(hn::IfThenElse(high_rejected, rejected, high), d16, scores + x + hn::Lanes(d16));
  }
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(ScoreWindowsTarget);

void ScoreWindows(const std::uint8_t* cells, std::size_t count, std::span<const WindowTree> trees,
                  std::span<const std::int16_t> floors, std::int16_t* scores) {
  HWY_DYNAMIC_DISPATCH(ScoreWindowsTarget)(cells, count, trees, floors, scores);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE
