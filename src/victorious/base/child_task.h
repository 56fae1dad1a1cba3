// Runs a program as a child process, reads its events (program_events.h) and ends it in order. The child dies with the
// thread that started it: a killed server leaves no orphan that writes to the index.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/child_start.h"
#include "victorious/base/error.h"
#include "victorious/base/program_events.h"

namespace victorious {

/// The descriptor on which a child finds the pipe for its events.
inline constexpr int kChildEventDescriptor = kChildDescriptor;

/// What is run. Standard input and output are /dev/null, standard error is that of this process; it inherits no other
/// open file.
struct ChildCommand {
  std::filesystem::path executable;
  std::vector<std::string> arguments;  ///< the program's name first
};

/// This program itself, with its events on kChildEventDescriptor.
/// @param arguments  the command first: "index", …
[[nodiscard]] ChildCommand OwnProgram(const std::vector<std::string>& arguments);

enum class ChildControl {
  kContinue,
  kInterrupt,  ///< ask it to end (SIGINT), and kill it if it has not after the grace period
  kKill,       ///< at once
};

struct ChildTask {
  ChildCommand command;
  std::function<void(const ProgramEvent&)> on_event;
  std::function<ChildControl()> control;  ///< called after new events, and at least every 0.2 s
  std::chrono::milliseconds grace{60'000};
};

/// How a child ended.
struct ChildEnd {
  int status = 0;              ///< exit status; 128 + the number of the signal that killed it
  std::optional<Error> error;  ///< of its last error event
  bool is_killed = false;      ///< by RunChild
};

/// Runs the child to its end. A line that is no event is passed on as a warning. Errors: those of pipe and fork.
[[nodiscard]] Expected<ChildEnd> RunChild(const ChildTask& task);

/// Says why a child that did not end with the status 0 failed, on one line: its own error, or the likely cause.
[[nodiscard]] std::string DescribeFailure(const ChildEnd& end);

}  // namespace victorious
