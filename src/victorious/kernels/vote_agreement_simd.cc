// vote_agreement.h on any vector width, through Highway. The same bits as by the reference: the same operations in the
// same order, none fused.
#include "victorious/kernels/no_sve.h"
#include "victorious/kernels/vote_agreement.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "victorious/kernels/vote_agreement_simd.cc"
#include <hwy/foreach_target.h>
// Highway requires this order: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace victorious::kernels::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

void CountAgreeingVotesTarget(const VoteArrays& votes, std::span<const VoteWindow> windows, float turn_rad,
                              std::span<std::int32_t> counts) {
  CountAgreeingVotesRef(votes, windows, turn_rad, counts);
}

std::size_t FindAgreeingPairsTarget(const PairArrays& pairs, std::size_t begin, std::size_t end,
                                    const SimilarityMap& map, float reach2_px2, std::uint32_t* pair,
                                    float* error2_px2) {
  return FindAgreeingPairsRef(pairs, begin, end, map, reach2_px2, pair, error2_px2);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kVotePadding>;
using DI = hn::RebindToSigned<DF>;
using DU = hn::RebindToUnsigned<DF>;

void CountAgreeingVotesTarget(const VoteArrays& votes, std::span<const VoteWindow> windows, float turn_rad,
                              std::span<std::int32_t> counts) {
  const DF d;
  const DI di;
  const std::size_t lanes = hn::Lanes(d);
  const auto circle = hn::Set(d, 6.28318530717958647692F);
  const auto max_turn = hn::Set(d, turn_rad);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const auto x = hn::Set(d, votes.x[i]);
    const auto y = hn::Set(d, votes.y[i]);
    const auto turn = hn::Set(d, votes.turn_rad[i]);
    const auto reach2 = hn::Set(d, windows[i].reach2_px2);
    const auto agrees = [&](std::size_t j) HWY_ATTR {
      const auto dx = hn::Sub(hn::LoadU(d, votes.x + j), x);
      const auto dy = hn::Sub(hn::LoadU(d, votes.y + j), y);
      const auto difference = hn::Abs(hn::Sub(hn::LoadU(d, votes.turn_rad + j), turn));
      const auto between = hn::Min(difference, hn::Abs(hn::Sub(circle, difference)));
      return hn::And(hn::Lt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), reach2), hn::Lt(between, max_turn));
    };
    auto negative = hn::Zero(di);  // minus the count, by lane
    std::size_t j = windows[i].begin;
    const std::size_t end = windows[i].end;
    for (; j + lanes <= end; j += lanes)
      negative = hn::Add(negative, hn::VecFromMask(di, hn::RebindMask(di, agrees(j))));
    if (j < end) {
      const auto rest = hn::And(agrees(j), hn::FirstN(d, end - j));
      negative = hn::Add(negative, hn::VecFromMask(di, hn::RebindMask(di, rest)));
    }
    counts[i] = -hn::GetLane(hn::SumOfLanes(di, negative));
  }
}

std::size_t FindAgreeingPairsTarget(const PairArrays& pairs, std::size_t begin, std::size_t end,
                                    const SimilarityMap& map, float reach2_px2, std::uint32_t* pair,
                                    float* error2_px2) {
  const DF d;
  const DU du;
  const std::size_t lanes = hn::Lanes(d);
  const auto a = hn::Set(d, map.a);
  const auto b = hn::Set(d, map.b);
  const auto shift_x = hn::Set(d, map.shift_x);
  const auto shift_y = hn::Set(d, map.shift_y);
  const auto reach2 = hn::Set(d, reach2_px2);
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; i += lanes) {
    const auto x = hn::LoadU(d, pairs.template_x + i);
    const auto y = hn::LoadU(d, pairs.template_y + i);
    const auto dx = hn::Sub(hn::Add(hn::Sub(hn::Mul(a, x), hn::Mul(b, y)), shift_x), hn::LoadU(d, pairs.scene_x + i));
    const auto dy = hn::Sub(hn::Add(hn::Add(hn::Mul(b, x), hn::Mul(a, y)), shift_y), hn::LoadU(d, pairs.scene_y + i));
    const auto error2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    auto agrees = hn::Le(error2, reach2);
    if (end - i < lanes) agrees = hn::And(agrees, hn::FirstN(d, end - i));
    if (hn::AllFalse(d, agrees)) continue;
    hn::CompressStore(hn::Iota(du, static_cast<std::uint32_t>(i)), hn::RebindMask(du, agrees), du, pair + count);
    count += hn::CompressStore(error2, agrees, d, error2_px2 + count);
  }
  return count;
}

#endif

}  // namespace victorious::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace victorious::kernels {

HWY_EXPORT(CountAgreeingVotesTarget);
HWY_EXPORT(FindAgreeingPairsTarget);

void CountAgreeingVotes(const VoteArrays& votes, std::span<const VoteWindow> windows, float turn_rad,
                        std::span<std::int32_t> counts) {
  HWY_DYNAMIC_DISPATCH(CountAgreeingVotesTarget)(votes, windows, turn_rad, counts);
}

std::size_t FindAgreeingPairs(const PairArrays& pairs, std::size_t begin, std::size_t end, const SimilarityMap& map,
                              float reach2_px2, std::uint32_t* pair, float* error2_px2) {
  return HWY_DYNAMIC_DISPATCH(FindAgreeingPairsTarget)(pairs, begin, end, map, reach2_px2, pair, error2_px2);
}

}  // namespace victorious::kernels
#endif  // HWY_ONCE
