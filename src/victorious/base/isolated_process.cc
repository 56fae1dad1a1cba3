#include "victorious/base/isolated_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "victorious/base/child_start.h"
#include "victorious/base/isolated_message.h"
#include "victorious/base/one_line.h"
#include "victorious/base/own_file.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/base/version.h"

namespace victorious {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxMessageBytes = 2000;

std::string HeaderBytes(IsolatedMessage kind, std::size_t size) {
  const IsolatedHeader header{.kind = kind, .size = size};
  return {reinterpret_cast<const char*>(&header), sizeof(header)};
}

// One message with its descriptor; a descriptor goes with the first byte.
ssize_t SendPart(int socket, std::string_view bytes, int descriptor) {
  iovec part{.iov_base = const_cast<char*>(bytes.data()), .iov_len = bytes.size()};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  if (descriptor >= 0) {
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* const rights = CMSG_FIRSTHDR(&message);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(rights), &descriptor, sizeof(int));
  }
  return ::sendmsg(socket, &message, MSG_NOSIGNAL);
}

struct SocketPair {
  int own;
  int of_child;
};

Expected<SocketPair> OpenSocketPair() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return std::unexpected(ErrorFromErrno(errno, "start a decoder"));
  }
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return SocketPair{.own = ends[0], .of_child = ends[1]};
}

Error NoMeaning() { return {ErrorCode::kDataLoss, "damaged: its decoder gave an answer without a meaning"}; }

}  // namespace

Expected<std::filesystem::path> DecoderProgram() {
  std::error_code error;
  const std::filesystem::path folder = OwnFile().parent_path();
  if (folder.empty())
    return Fail(ErrorCode::kNotFound, "victorious-decoder: the system does not say where the program is");
  // The last one: from a library in lib/ARCHITECTURE.
  for (const char* relative : {"victorious-decoder", "../libexec/victorious/victorious-decoder",
                               "../../libexec/victorious/victorious-decoder"}) {
    std::filesystem::path program = folder / relative;
    if (std::filesystem::exists(program, error)) return program;
  }
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: is not there: `make build` builds it, and `make install` installs it",
                          (folder / "victorious-decoder").string()));
}

IsolatedProcess& IsolatedProcess::operator=(IsolatedProcess&& other) noexcept {
  if (this == &other) return *this;
  End();
  pid_ = std::exchange(other.pid_, -1);
  descriptor_ = std::exchange(other.descriptor_, -1);
  limits_ = std::move(other.limits_);
  end_ = std::move(other.end_);
  return *this;
}

Expected<IsolatedProcess> IsolatedProcess::Start(std::string_view function, const IsolatedStart& start) {
  std::filesystem::path program = start.program;
  if (program.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(program, DecoderProgram());
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const SocketPair ends, OpenSocketPair());
  const Expected<pid_t> pid = StartChild({.executable = program,
                                          .arguments = {program.filename().string(), std::string(function), kVersion},
                                          .descriptor = ends.of_child,
                                          .has_own_group = start.has_own_group});
  ::close(ends.of_child);
  if (!pid) {
    ::close(ends.own);
    return std::unexpected(pid.error());
  }
  return IsolatedProcess(*pid, ends.own);
}

void IsolatedProcess::Confine(IsolationLimits limits) {
  limits_ = std::move(limits);
  ByteWriter writer;
  writer.Put(limits_.memory_bytes);
  writer.Put(std::uint64_t{limits_.processor_s});
  writer.Put(std::uint64_t{limits_.readable.size()});
  for (const std::filesystem::path& path : limits_.readable) {
    writer.PutText(path.native());
  }
  const std::string limits_text = writer.TakeText();
  const std::string message = HeaderBytes(IsolatedMessage::kLimits, limits_text.size()) + limits_text;
  constexpr std::chrono::seconds kPatience{60};
  if (Status sent = Send(message, {}, Clock::now() + kPatience); !sent) end_ = std::move(sent.error());
}

Expected<std::string> IsolatedProcess::Ask(std::string_view request, const AskOptions& options) {
  if (!IsRunning()) return std::unexpected(end_.value_or(Error{ErrorCode::kInternal, "its decoder has ended"}));
  const Deadline deadline = Clock::now() + options.patience;
  const auto exchange = [&]() -> Expected<Expected<std::string>> {
    VICTORIOUS_RETURN_IF_ERROR(Send(HeaderBytes(IsolatedMessage::kRequest, request.size()), options, deadline));
    VICTORIOUS_RETURN_IF_ERROR(Send(request, options, deadline));
    return ReceiveAnswer(options, deadline);
  };
  Expected<Expected<std::string>> answer = exchange();
  if (answer) return *std::move(answer);
  End();
  return std::unexpected(std::move(answer).error());
}

Expected<Expected<std::string>> IsolatedProcess::ReceiveAnswer(const AskOptions& options, Deadline deadline) {
  std::string head;
  IsolatedHeader header;
  VICTORIOUS_RETURN_IF_ERROR(Receive(head, sizeof(header), options, deadline));
  std::memcpy(&header, head.data(), sizeof(header));
  const bool is_error = header.kind == IsolatedMessage::kError;
  if ((!is_error && header.kind != IsolatedMessage::kResult) || (is_error && header.size == 0) ||
      header.size > options.max_answer_bytes) {
    return std::unexpected(NoMeaning());
  }
  std::string answer;
  VICTORIOUS_RETURN_IF_ERROR(Receive(answer, header.size, options, deadline));
  if (!is_error) return answer;
  if (static_cast<unsigned char>(answer.front()) >= kErrorCodeTexts.size()) return std::unexpected(NoMeaning());
  // Who has taken the process over writes the message, too.
  return Expected<std::string>(
      Fail(static_cast<ErrorCode>(answer.front()), OneLine(answer.substr(1, kMaxMessageBytes))));
}

Expected<IsolatedProcess> IsolatedProcess::Copy() {
  const AskOptions options;
  const Deadline deadline = Clock::now() + options.patience;
  VICTORIOUS_ASSIGN_OR_RETURN(const SocketPair ends, OpenSocketPair());
  const auto exchange = [&]() -> Expected<Expected<std::string>> {
    VICTORIOUS_RETURN_IF_ERROR(Send(HeaderBytes(IsolatedMessage::kCopy, 0), options, deadline, ends.of_child));
    return ReceiveAnswer(options, deadline);
  };
  const Expected<Expected<std::string>> answer = exchange();
  ::close(ends.of_child);
  pid_t pid = -1;
  if (answer && *answer && (*answer)->size() == sizeof(pid)) std::memcpy(&pid, (*answer)->data(), sizeof(pid));
  if (pid > 0) return IsolatedProcess(pid, ends.own);
  ::close(ends.own);
  End();
  if (!answer) return std::unexpected(answer.error());
  return std::unexpected(*answer ? NoMeaning() : answer->error());
}

Status IsolatedProcess::Send(std::string_view bytes, const AskOptions& options, Deadline deadline, int descriptor) {
  while (!bytes.empty()) {
    const ssize_t sent = SendPart(descriptor_, bytes, descriptor);
    if (sent >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
      descriptor = -1;
    } else if (errno == EAGAIN) {
      VICTORIOUS_RETURN_IF_ERROR(WaitFor(POLLOUT, options, deadline));
    } else if (errno != EINTR) {
      return std::unexpected(DescribeEnd());
    }
  }
  return {};
}

Status IsolatedProcess::Receive(std::string& bytes, std::size_t size, const AskOptions& options, Deadline deadline) {
  constexpr std::size_t kPart = std::size_t{1} << 20;  // memory grows with what comes, not with what is announced
  while (bytes.size() < size) {
    const std::size_t before = bytes.size();
    bytes.resize(std::min(size, before + kPart));
    const ssize_t got = ::recv(descriptor_, bytes.data() + before, bytes.size() - before, 0);
    const int error = errno;
    bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got > 0 || (got < 0 && error == EINTR)) continue;
    if (got == 0 || error != EAGAIN) return std::unexpected(DescribeEnd());
    VICTORIOUS_RETURN_IF_ERROR(WaitFor(POLLIN, options, deadline));
  }
  return {};
}

Status IsolatedProcess::WaitFor(short events, const AskOptions& options, Deadline deadline) {
  constexpr std::chrono::milliseconds kCancelPoll{50};
  while (true) {
    if (options.cancel != nullptr && options.cancel->IsCancelled()) return Fail(ErrorCode::kCancelled, "cancelled");
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) {
      return Fail(ErrorCode::kUnsupported,
                  fmt::format("takes more than {:g} s to read: use a smaller file, or one that is not damaged",
                              std::chrono::duration<double>(options.patience).count()));
    }
    pollfd wanted{.fd = descriptor_, .events = events, .revents = 0};
    if (::poll(&wanted, 1, static_cast<int>(std::min(left + std::chrono::milliseconds(1), kCancelPoll).count())) > 0) {
      return {};
    }
  }
}

Error IsolatedProcess::DescribeEnd() {
  // It has closed its socket, or ends now: it has no time to do anything else.
  constexpr std::chrono::seconds kPatience{2};
  constexpr timespec kPoll{.tv_sec = 0, .tv_nsec = 1'000'000};
  const Deadline deadline = Clock::now() + kPatience;
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(pid_, &status, WNOHANG)) == 0 && Clock::now() < deadline) ::nanosleep(&kPoll, nullptr);
  if (ended != pid_) {
    End();
    return NoMeaning();
  }
  pid_ = -1;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  switch (signal) {
    case 0:
      break;
    case SIGXCPU:
      return {ErrorCode::kUnsupported,
              fmt::format("takes more than {} s of processor time to read: use a smaller file, or one that is not "
                          "damaged",
                          limits_.processor_s)};
    case SIGKILL:
      return {ErrorCode::kUnsupported, "killed while it was read: the machine may be out of memory"};
    case SIGINT:
    case SIGTERM:
      return {ErrorCode::kCancelled, "cancelled"};
    default:
      return {ErrorCode::kDataLoss, "damaged: its decoder crashed"};
  }
  constexpr int kNotStarted = 127;
  constexpr int kOfAnotherVersion = 2;
  if (WEXITSTATUS(status) == kNotStarted) return {ErrorCode::kInternal, "victorious-decoder cannot be executed"};
  if (WEXITSTATUS(status) == kOfAnotherVersion) {
    return {ErrorCode::kInternal,
            "victorious-decoder is of another version: install it and victorious together, and "
            "start victorious again"};
  }
  return {ErrorCode::kDataLoss, "damaged: its decoder crashed"};  // a sanitizer stopped it
}

void IsolatedProcess::End() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

}  // namespace victorious
