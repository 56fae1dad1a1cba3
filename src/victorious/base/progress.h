// Reports the progress of long work on stderr: a bar on a terminal, plain lines every few seconds otherwise,
// with the time left at the rate so far. With `--events`, as events instead (program_events.h). In the library, to the
// caller (ProgressCapture).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "victorious/base/program_events.h"

namespace victorious {

/// "1:05 left", "2:01:00 left"; empty for a time that is negative, not finite or longer than 100 hours.
[[nodiscard]] std::string TimeLeftText(double seconds);

/// Receives the progress of work; from one thread at a time.
using ProgressReceiver = std::function<void(const ProgressEvent&)>;

/// While it lives, each Progress that this thread makes reports to `receive` alone, at most ten times a second and at
/// its end: who calls a library owns stderr. Of several the last one made counts.
class ProgressCapture {
 public:
  explicit ProgressCapture(ProgressReceiver receive);
  ~ProgressCapture();
  ProgressCapture(const ProgressCapture&) = delete;
  ProgressCapture& operator=(const ProgressCapture&) = delete;

  /// Of this thread; null: none.
  [[nodiscard]] static const ProgressReceiver* Current();

 private:
  ProgressReceiver receive_;
  const ProgressReceiver* before_;
};

/// Not thread-safe: report from one thread at a time. The destructor ends the line.
class Progress {
 public:
  /// @param label  the item being processed, e.g. a file name
  /// @param total  number of units of work, if known
  /// @param unit   the name of the units, in the plural: "frames"
  Progress(std::string label, std::optional<std::int64_t> total, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Reports the number of units done so far. Draws at most ten times a second on a terminal, every five seconds
  /// elsewhere; writes an event at most once a second.
  /// @param behind_s  of a live source (ProgressEvent)
  void Update(std::int64_t done, std::optional<double> behind_s = std::nullopt);

 private:
  void Draw(bool last);
  [[nodiscard]] std::chrono::milliseconds Interval() const;

  using Clock = std::chrono::steady_clock;
  std::string label_;
  std::optional<std::int64_t> total_;
  std::string unit_;
  const ProgressReceiver* receiver_;  // null: none
  bool on_terminal_;
  std::optional<std::int64_t> first_done_;
  std::int64_t done_ = 0;
  std::optional<double> behind_s_;
  std::optional<std::int64_t> last_drawn_;
  Clock::time_point start_;
  Clock::time_point last_draw_;
};

}  // namespace victorious
