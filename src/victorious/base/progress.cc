#include "victorious/base/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "victorious/base/credentials.h"

namespace victorious {
namespace {

thread_local const ProgressReceiver* current_receiver = nullptr;

}  // namespace

ProgressCapture::ProgressCapture(ProgressReceiver receive)
    : receive_(std::move(receive)), before_(std::exchange(current_receiver, &receive_)) {}

ProgressCapture::~ProgressCapture() { current_receiver = before_; }

const ProgressReceiver* ProgressCapture::Current() { return current_receiver; }

Progress::Progress(std::string label, std::optional<std::int64_t> total, std::string unit)
    : label_(WithoutCredentials(std::move(label))),
      total_(total),
      unit_(std::move(unit)),
      receiver_(ProgressCapture::Current()),
      on_terminal_(receiver_ == nullptr && ::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_draw_(start_) {}

Progress::~Progress() {
  // A bar must still end its line; a line of a log, or an event, of the same number is complete.
  if (first_done_ && (on_terminal_ || last_drawn_ != done_)) Draw(true);
}

std::string TimeLeftText(double seconds) {
  constexpr double kLongest_s = 360'000;
  if (!(seconds >= 0 && seconds < kLongest_s)) return "";
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  const std::int64_t hours = whole / 3600;
  return hours > 0 ? fmt::format("{}:{:02}:{:02} left", hours, whole / 60 % 60, whole % 60)
                   : fmt::format("{}:{:02} left", whole / 60, whole % 60);
}

void Progress::Update(std::int64_t done, std::optional<double> behind_s) {
  if (!first_done_) first_done_ = done;
  done_ = done;
  behind_s_ = behind_s;
  const auto now = Clock::now();
  if (now - last_draw_ < Interval()) return;
  last_draw_ = now;
  Draw(false);
}

std::chrono::milliseconds Progress::Interval() const {
  if (receiver_ == nullptr && HasEventOutput()) return std::chrono::seconds(1);
  return receiver_ != nullptr || on_terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(5);
}

void Progress::Draw(bool last) {
  last_drawn_ = done_;
  const double seconds = std::max(1e-3, std::chrono::duration<double>(Clock::now() - start_).count());
  if (receiver_ != nullptr || HasEventOutput()) {
    const ProgressEvent event{
        .label = label_, .done = done_, .total = total_, .unit = unit_, .elapsed_s = seconds, .behind_s = behind_s_};
    receiver_ != nullptr ? (*receiver_)(event) : ReportEvent(event);
    return;
  }
  const double rate = static_cast<double>(done_ - *first_done_) / seconds;
  const std::string of_total = total_ ? fmt::format("{} of {}", done_, *total_) : fmt::format("{}", done_);
  std::string left;
  if (total_ && *total_ > done_ && rate > 0 && !last) {
    left = TimeLeftText(static_cast<double>(*total_ - done_) / rate);
    if (!left.empty()) left = ", " + left;
  }
  if (behind_s_) left = fmt::format(", up to {:.1f} s behind", *behind_s_);
  std::string line;
  if (on_terminal_) {
    std::string bar;
    if (total_ && *total_ > 0) {
      constexpr std::int64_t kWidth = 30;
      const auto filled = static_cast<std::size_t>(std::clamp<std::int64_t>(done_ * kWidth / *total_, 0, kWidth));
      bar = "[" + std::string(filled, '#') + std::string(kWidth - filled, ' ') + "] ";
    }
    line = fmt::format("\r{}: {}{} {}, {:.1f} a second{}\x1b[K{}", label_, bar, of_total, unit_, rate, left,
                       last ? "\n" : "");
  } else {
    line = fmt::format("{}: {} {}, {:.1f} a second{}\n", label_, of_total, unit_, rate, left);
  }
  // Not fmt::print, which throws: a closed stderr must not stop the work.
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace victorious
