#include "victorious/base/isolated_main.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "victorious/base/child_start.h"
#include "victorious/base/isolated_message.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/base/sandbox.h"
#include "victorious/base/version.h"

namespace victorious {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
#else
constexpr bool kSanitized = false;
#endif

constexpr int kBadUsage = 2;

struct ProcessLimits {
  std::uint64_t memory_bytes = 0;
  std::uint64_t processor_s = 0;
  std::vector<std::filesystem::path> readable;
};

// read() and write(), not the calls of sockets, which the sandbox refuses.
bool ReadBytes(char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::read(kChildDescriptor, bytes, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

// The first bytes of a message, and the descriptor that comes with them; -1: none. Not for a confined process.
bool ReadWithDescriptor(char* bytes, std::size_t size, int& descriptor) {
  iovec part{.iov_base = bytes, .iov_len = size};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  ssize_t got = 0;
  do {
    got = ::recvmsg(kChildDescriptor, &message, MSG_CMSG_CLOEXEC);
  } while (got < 0 && errno == EINTR);
  if (got <= 0) return false;
  const cmsghdr* const rights = CMSG_FIRSTHDR(&message);
  descriptor = -1;
  if (rights != nullptr && rights->cmsg_type == SCM_RIGHTS) {
    std::memcpy(&descriptor, CMSG_DATA(rights), sizeof(descriptor));
  }
  return ReadBytes(bytes + got, size - static_cast<std::size_t>(got));
}

bool WriteBytes(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(kChildDescriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

bool WriteMessage(IsolatedMessage kind, std::string_view bytes) {
  const IsolatedHeader header{.kind = kind, .size = bytes.size()};
  return WriteBytes({reinterpret_cast<const char*>(&header), sizeof(header)}) && WriteBytes(bytes);
}

ProcessLimits ParseLimits(std::string_view message) {
  ByteReader reader(std::as_bytes(std::span(message)));
  ProcessLimits limits;
  limits.memory_bytes = reader.Get<std::uint64_t>();
  limits.processor_s = reader.Get<std::uint64_t>();
  for (auto left = reader.GetCount(sizeof(std::uint64_t)); left > 0; --left) {
    limits.readable.emplace_back(reader.GetText());
  }
  return limits;
}

// The address space of this process; the limit is relative to it.
std::uint64_t AddressSpaceBytes() {
  std::uint64_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    unsigned long long total = 0;
    if (std::fscanf(file, "%llu", &total) == 1) pages = total;
    std::fclose(file);
  }
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void Limit(__rlimit_resource resource, std::uint64_t soft, std::uint64_t hard) {
  const rlimit limit{soft, hard};
  ::setrlimit(resource, &limit);  // fails if a stricter limit is set, which then stays
}

Status ConfineThisProcess(const ProcessLimits& limits) {
  ::prctl(PR_SET_DUMPABLE, 0);  // others cannot trace it, and it leaves no core
  Limit(RLIMIT_CORE, 0, 0);
  Limit(RLIMIT_FSIZE, 0, 0);
  Limit(RLIMIT_CPU, limits.processor_s, limits.processor_s + 1);
  if (!kSanitized) {
    const std::uint64_t bytes = AddressSpaceBytes() + limits.memory_bytes;
    Limit(RLIMIT_AS, bytes, bytes);
  }
  return EnterSandbox(limits.readable);
}

Expected<std::string> Answer(const IsolatedFunction& function, std::string_view request, const ProcessLimits& limits) {
  try {
    return function.answer(request);
  } catch (const std::bad_alloc&) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("takes more than {} MiB of memory to read: use a smaller file", limits.memory_bytes >> 20));
  }
}

bool SendAnswer(const Expected<std::string>& answer) {
  if (answer) return WriteMessage(IsolatedMessage::kResult, *answer);
  return WriteMessage(IsolatedMessage::kError, static_cast<char>(answer.error().code) + answer.error().message);
}

// Copies this process, which has one thread: its copy goes on with a socket of its own. The copy is a child of the same
// parent, which waits for it. False if it cannot be copied, or the parent has gone.
bool CopyThisProcess(int socket) {
  const long pid = ::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::dup2(socket, kChildDescriptor);
    ::close(socket);
    return true;
  }
  ::close(socket);
  const auto id = static_cast<pid_t>(pid);
  return pid > 0 && WriteMessage(IsolatedMessage::kResult, {reinterpret_cast<const char*>(&id), sizeof(id)});
}

// Until the parent has gone.
void Serve(const IsolatedFunction& function) {
  ProcessLimits limits;
  std::optional<Status> confined;
  IsolatedHeader header;
  int descriptor = -1;
  const auto read_header = [&] {
    const auto bytes = reinterpret_cast<char*>(&header);
    return confined ? ReadBytes(bytes, sizeof(header)) : ReadWithDescriptor(bytes, sizeof(header), descriptor);
  };
  while (read_header()) {
    if (header.kind == IsolatedMessage::kCopy) {
      if (confined || !CopyThisProcess(descriptor)) return;
      continue;
    }
    std::string message;
    try {
      message.resize(header.size);
    } catch (const std::bad_alloc&) {
      return;
    }
    if (!ReadBytes(message.data(), message.size())) return;
    if (header.kind == IsolatedMessage::kLimits) {
      limits = ParseLimits(message);
      confined = ConfineThisProcess(limits);
      continue;
    }
    const Status is_confined =
        confined.value_or(Fail(ErrorCode::kInternal, "a decoder without limits answers nothing"));
    const Expected<std::string> answer =
        is_confined ? Answer(function, message, limits) : std::unexpected(is_confined.error());
    if (!SendAnswer(answer)) return;
  }
}

}  // namespace

int RunIsolatedFunction(int argc, char** argv, std::span<const IsolatedFunction> functions) {
  const auto found =
      argc == 3 ? std::ranges::find(functions, std::string_view(argv[1]), &IsolatedFunction::name) : functions.end();
  if (found == functions.end() || std::string_view(argv[2]) != kVersion) {
    std::fputs("victorious starts this program by itself, to read files in a process without rights\n", stderr);
    return kBadUsage;
  }
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  Serve(*found);
  // Without destructors: the sandbox refuses what some of them do.
  ::_exit(0);
}

}  // namespace victorious
