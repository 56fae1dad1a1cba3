// Runs functions that read hostile bytes in a process of its own: with limited memory, processor time and wall-clock
// time, without a network, and without files but those that are named (sandbox.h). A crash, or an attacker who takes
// the process over, then costs an answer.
//
// The process is the program victorious-decoder, which lies beside the running one or beside the library: a process
// with threads may only fork to execute another program (docs/adr/0033-decoders.md).
//
//   VICTORIOUS_ASSIGN_OR_RETURN(auto process, IsolatedProcess::Start("mesh", {}));
//   process.Confine({.memory_bytes = …});
//   return process.Ask(request, {.patience = …});
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

struct IsolationLimits {
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< address space in addition to that after its start
  unsigned processor_s = 10;                            ///< CPU time, s, of all its answers
  std::vector<std::filesystem::path> readable;          ///< files and folders that it may read, and no others
};

struct AskOptions {
  std::chrono::milliseconds patience{60'000};               ///< wall-clock time for the answer
  std::uint64_t max_answer_bytes = std::uint64_t{1} << 30;  ///< a longer one is not read
  const CancelToken* cancel = nullptr;                      ///< ends it within 50 ms
};

struct IsolatedStart {
  std::filesystem::path program;  ///< empty: DecoderProgram()
  bool has_own_group = false;     ///< Ctrl-C in the terminal does not end it
};

/// The program victorious-decoder: beside the running program or the shared library (own_file.h), or in
/// ../libexec/victorious from there. Error: kNotFound.
[[nodiscard]] Expected<std::filesystem::path> DecoderProgram();

/// Used by one thread at a time. It is killed with the thread that started it.
class IsolatedProcess {
 public:
  /// Starts the program, which then waits for questions. Does not wait for it.
  /// @param function  of the program, by its name
  /// Errors: those of DecoderProgram; kInternal.
  [[nodiscard]] static Expected<IsolatedProcess> Start(std::string_view function, const IsolatedStart& start);

  IsolatedProcess(IsolatedProcess&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)),
        descriptor_(std::exchange(other.descriptor_, -1)),
        limits_(std::move(other.limits_)),
        end_(std::move(other.end_)) {}
  IsolatedProcess& operator=(IsolatedProcess&& other) noexcept;
  /// Kills it if it runs, and waits for it.
  ~IsolatedProcess() { End(); }

  /// Starts a copy of this process, which is neither confined nor asked yet, in some milliseconds: what takes long when
  /// a program starts is to link its libraries. The copy is a child of the calling program, not of this process. Waits
  /// for the start of this process. Any error ends this process.
  [[nodiscard]] Expected<IsolatedProcess> Copy();

  /// Once, before the first question. A fault shows in the first answer.
  void Confine(IsolationLimits limits);

  /// Returns the function's result for a request.
  /// Errors: those of the function, on one line, after which the process goes on. All others end it: kDataLoss if it
  /// crashes or its answer is none; kUnsupported if it exceeds its limits or `patience`; kCancelled.
  [[nodiscard]] Expected<std::string> Ask(std::string_view request, const AskOptions& options);

  /// Whether it can be asked again.
  [[nodiscard]] bool IsRunning() const { return pid_ > 0; }

 private:
  using Deadline = std::chrono::steady_clock::time_point;

  IsolatedProcess(pid_t pid, int descriptor) : pid_(pid), descriptor_(descriptor) {}

  /// @param descriptor  sent with the bytes; -1: none
  [[nodiscard]] Status Send(std::string_view bytes, const AskOptions& options, Deadline deadline, int descriptor = -1);
  /// Reads an answer: a result, or the error that it says.
  [[nodiscard]] Expected<Expected<std::string>> ReceiveAnswer(const AskOptions& options, Deadline deadline);
  /// Appends what comes, until there are `size` bytes.
  [[nodiscard]] Status Receive(std::string& bytes, std::size_t size, const AskOptions& options, Deadline deadline);
  [[nodiscard]] Status WaitFor(short events, const AskOptions& options, Deadline deadline);
  /// Waits for its end, which has come, and says why.
  [[nodiscard]] Error DescribeEnd();
  void End();

  pid_t pid_;
  int descriptor_;
  IsolationLimits limits_;
  std::optional<Error> end_;  ///< why it ended, if that showed before a question
};

}  // namespace victorious
