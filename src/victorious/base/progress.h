// Progress of long work: a bar on a terminal, plain lines every few seconds otherwise, both on stderr.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace victorious {

/// Not thread-safe: one thread reports. Ends its line when destroyed.
class Progress {
 public:
  /// @param label  what is being worked on, e.g. a file's name
  /// @param total  units of work, if known
  /// @param unit   what is counted, in the plural: "frames"
  Progress(std::string label, std::optional<std::int64_t> total, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` units so far; draws at most ten times a second on a terminal, once in five seconds elsewhere.
  void Update(std::int64_t done);

 private:
  void Draw(bool last);

  using Clock = std::chrono::steady_clock;
  std::string label_;
  std::optional<std::int64_t> total_;
  std::string unit_;
  bool on_terminal_;
  std::optional<std::int64_t> first_done_;
  std::int64_t done_ = 0;
  Clock::time_point start_;
  Clock::time_point last_draw_;
};

}  // namespace victorious
