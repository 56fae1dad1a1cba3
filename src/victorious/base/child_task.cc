#include "victorious/base/child_task.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "victorious/base/child_start.h"

namespace victorious {
namespace {

constexpr std::chrono::milliseconds kPoll{200};
constexpr std::chrono::milliseconds kEndPoll{2};  // between the end of its events and of the process

class ChildProcess {
 public:
  [[nodiscard]] static Expected<ChildProcess> Start(const ChildCommand& command);

  ChildProcess(ChildProcess&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)),
        descriptor_(std::exchange(other.descriptor_, -1)),
        line_(std::move(other.line_)) {}
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Kills it if it runs, and waits for it.
  ~ChildProcess();

  /// Waits for lines of events, for at most `patience`. Returns the complete lines that came.
  [[nodiscard]] std::vector<std::string> ReadLines(std::chrono::milliseconds patience);

  /// The exit status once it has ended and all its lines were read; 128 + the number of the signal that killed it.
  [[nodiscard]] std::optional<int> EndStatus();

  void Interrupt() const { ::kill(pid_, SIGINT); }

 private:
  ChildProcess(int pid, int descriptor) : pid_(pid), descriptor_(descriptor) {}

  int pid_;         ///< -1: waited for
  int descriptor_;  ///< -1: closed
  std::string line_;
};

Expected<ChildProcess> ChildProcess::Start(const ChildCommand& command) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::unexpected(ErrorFromErrno(errno, "pipe"));
  const Expected<pid_t> pid = StartChild({.executable = command.executable,
                                          .arguments = command.arguments,
                                          .descriptor = ends[1],
                                          .has_own_group = true,
                                          .has_stderr = true});
  ::close(ends[1]);
  if (!pid) {
    ::close(ends[0]);
    return std::unexpected(pid.error());
  }
  return ChildProcess(*pid, ends[0]);
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::vector<std::string> ChildProcess::ReadLines(std::chrono::milliseconds patience) {
  std::vector<std::string> lines;
  if (descriptor_ < 0) {  // a child may close its events before it ends
    std::this_thread::sleep_for(std::min(patience, kEndPoll));
    return lines;
  }
  pollfd wanted{.fd = descriptor_, .events = POLLIN, .revents = 0};
  if (::poll(&wanted, 1, static_cast<int>(patience.count())) <= 0) return lines;
  std::array<char, 4096> bytes;
  const ssize_t got = ::read(descriptor_, bytes.data(), bytes.size());
  if (got < 0 && errno == EINTR) return lines;
  if (got <= 0) {
    ::close(std::exchange(descriptor_, -1));
    if (!line_.empty()) lines.push_back(std::exchange(line_, {}));
    return lines;
  }
  for (const char c : std::string_view(bytes.data(), static_cast<std::size_t>(got))) {
    if (c != '\n') {
      if (line_.size() <= kMaxEventBytes) line_ += c;  // one byte more shows the parser that it is too long
      continue;
    }
    lines.push_back(std::exchange(line_, {}));
  }
  return lines;
}

std::optional<int> ChildProcess::EndStatus() {
  constexpr int kUnknownStatus = 255;  // the kernel kept none: this process was started with SIGCHLD ignored
  if (descriptor_ >= 0) return std::nullopt;
  int status = 0;
  const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
  if (ended == 0) return std::nullopt;
  pid_ = -1;
  if (ended < 0) return kUnknownStatus;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

ProgramEvent EventOfLine(std::string_view line) {
  Expected<ProgramEvent> event = ParseEvent(line);
  if (event) return *std::move(event);
  return WarningEvent{fmt::format("a line of its events was ignored: {}", event.error().message)};
}

}  // namespace

ChildCommand OwnProgram(const std::vector<std::string>& arguments) {
  ChildCommand command{.executable = "/proc/self/exe",
                       .arguments = {"victorious", "--events", std::to_string(kChildEventDescriptor)}};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  return command;
}

Expected<ChildEnd> RunChild(const ChildTask& task) {
  VICTORIOUS_ASSIGN_OR_RETURN(ChildProcess child, ChildProcess::Start(task.command));
  ChildEnd end;
  std::optional<std::chrono::steady_clock::time_point> interrupted;
  while (true) {
    for (const std::string& line : child.ReadLines(kPoll)) {
      const ProgramEvent event = EventOfLine(line);
      if (const auto* const failure = std::get_if<ErrorEvent>(&event)) end.error = failure->error;
      task.on_event(event);
    }
    if (const std::optional<int> status = child.EndStatus()) {
      end.status = *status;
      return end;
    }
    const ChildControl control = task.control();
    const auto now = std::chrono::steady_clock::now();
    const bool is_overdue = interrupted && now - *interrupted > task.grace;
    if (control == ChildControl::kKill || is_overdue) {
      end.status = 128 + SIGKILL;  // ~ChildProcess kills it
      end.is_killed = true;
      return end;
    }
    if (control == ChildControl::kInterrupt && !interrupted) {
      interrupted = now;
      child.Interrupt();
    }
  }
}

std::string DescribeFailure(const ChildEnd& end) {
  if (end.error) return end.error->message;
  if (end.status <= 128) return fmt::format("its process ended with the status {}", end.status);
  const int signal = end.status - 128;
  switch (signal) {
    case SIGKILL:
      return "its process was killed, by somebody or because the memory ran out";
    case SIGINT:
    case SIGTERM:
    case SIGHUP:
      return fmt::format("its process was ended from outside (signal {})", signal);
    default:
      return fmt::format("its process crashed (signal {}): the file may be damaged", signal);
  }
}

}  // namespace victorious
