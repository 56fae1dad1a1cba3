#include "victorious/base/stage_time.h"

#include <atomic>
#include <cstdint>
#include <ctime>

namespace victorious {
namespace {

constexpr std::int64_t kNotCounted = -1;
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::atomic<bool> measuring = false;
std::array<std::atomic<std::int64_t>, kStageCount> times_ns = {};
thread_local bool scope_is_open = false;

std::int64_t ThreadTimeNs() {
  std::timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return kNanosecondsPerSecond * now.tv_sec + now.tv_nsec;
}

}  // namespace

void MeasureStages(bool on) {
  measuring = on;
  if (!on) return;
  for (std::atomic<std::int64_t>& time_ns : times_ns) time_ns = 0;
}

std::array<double, kStageCount> StageTimes() {
  std::array<double, kStageCount> times_s = {};
  for (std::size_t i = 0; i < kStageCount; ++i) {
    times_s[i] = static_cast<double>(times_ns[i]) / static_cast<double>(kNanosecondsPerSecond);
  }
  return times_s;
}

StageScope::StageScope(Stage stage) : stage_(static_cast<std::size_t>(stage)), start_ns_(kNotCounted) {
  if (!measuring.load(std::memory_order_relaxed) || scope_is_open) return;
  scope_is_open = true;
  start_ns_ = ThreadTimeNs();
}

StageScope::~StageScope() {
  if (start_ns_ == kNotCounted) return;
  scope_is_open = false;
  times_ns[stage_] += ThreadTimeNs() - start_ns_;
}

}  // namespace victorious
