// A child process whose standard error is read line by line. It dies with the thread that started it: a killed server
// leaves no orphan that writes to the index.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

class ChildProcess {
 public:
  /// Starts this program's own executable with these arguments; standard input and output are /dev/null. Errors: those
  /// of pipe and fork.
  [[nodiscard]] static Expected<ChildProcess> StartSelf(const std::vector<std::string>& arguments);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Kills it if it runs, and waits for it.
  ~ChildProcess();

  /// Waits for lines of standard error, for at most `patience`. Returns the complete lines that came.
  [[nodiscard]] std::vector<std::string> ReadLines(std::chrono::milliseconds patience);

  /// True once standard error is closed, which is when the process ends.
  [[nodiscard]] bool has_ended() const { return descriptor_ < 0; }

  /// Asks it to end (SIGINT).
  void Interrupt();

  /// Waits for its end. Returns the exit status; 128 + the number of the signal that killed it.
  [[nodiscard]] int Wait();

 private:
  ChildProcess(int pid, int descriptor) : pid_(pid), descriptor_(descriptor) {}

  int pid_;         ///< -1: waited for
  int descriptor_;  ///< -1: closed
  std::string line_;
};

/// Says how a process ended that gave no error of its own, and what is the likely cause, on one line.
/// @param status  as ChildProcess::Wait returns it, not 0
[[nodiscard]] std::string DescribeFailure(int status);

}  // namespace victorious
