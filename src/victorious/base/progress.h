// Reports the progress of long work on stderr: a bar on a terminal, plain lines every few seconds otherwise,
// with the time left at the rate so far. With `--events`, as events instead (program_events.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace victorious {

/// "1:05 left", "2:01:00 left"; empty for a time that is negative, not finite or longer than 100 hours.
[[nodiscard]] std::string TimeLeftText(double seconds);

/// Not thread-safe: report from one thread. The destructor ends the line.
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
  bool on_terminal_;
  std::optional<std::int64_t> first_done_;
  std::int64_t done_ = 0;
  std::optional<double> behind_s_;
  std::optional<std::int64_t> last_drawn_;
  Clock::time_point start_;
  Clock::time_point last_draw_;
};

}  // namespace victorious
