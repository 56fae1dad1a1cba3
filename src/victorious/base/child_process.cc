#include "victorious/base/child_process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace victorious {

Expected<ChildProcess> ChildProcess::StartSelf(const std::vector<std::string>& arguments) {
  // All that allocates happens before fork: the child of a process with threads
  // may only make system calls.
  std::vector<std::string> words = {"victorious"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::unexpected(ErrorFromErrno(errno, "pipe"));
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) {
    const int error = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    return std::unexpected(ErrorFromErrno(error, "fork"));
  }
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);  // the parent died before
    ::setpgid(0, 0);                          // Ctrl-C in the server's terminal is for the server
    const int null = ::open("/dev/null", O_RDWR);
    ::dup2(null, STDIN_FILENO);
    ::dup2(null, STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::execv("/proc/self/exe", argv.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  return ChildProcess(pid, ends[0]);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      line_(std::move(other.line_)) {}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    [[maybe_unused]] const int status = Wait();
  }
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::vector<std::string> ChildProcess::ReadLines(std::chrono::milliseconds patience) {
  constexpr std::size_t kMaxLine = 4096;
  std::vector<std::string> lines;
  pollfd wanted{.fd = descriptor_, .events = POLLIN, .revents = 0};
  if (descriptor_ < 0 || ::poll(&wanted, 1, static_cast<int>(patience.count())) <= 0) return lines;
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
      if (line_.size() < kMaxLine) line_ += c;
      continue;
    }
    lines.push_back(std::exchange(line_, {}));
  }
  return lines;
}

void ChildProcess::Interrupt() {
  if (pid_ > 0) ::kill(pid_, SIGINT);
}

int ChildProcess::Wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::string DescribeFailure(int status) {
  if (status <= 128) return fmt::format("its process ended with the status {}", status);
  const int signal = status - 128;
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
