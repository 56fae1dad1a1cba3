#include "victorious/mesh/isolated.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <optional>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "victorious/base/file_descriptor.h"

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

// Exit codes of the child process.
constexpr int kDone = 0;         // the file contains its result
constexpr int kFailed = 1;       // the file contains its error: one byte for the code, then the message
constexpr int kOutOfMemory = 2;  // the content of the file is undefined

bool WriteAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

Expected<std::string> ReadAll(int fd) {
  struct stat status = {};
  if (fstat(fd, &status) != 0) return std::unexpected(ErrorFromErrno(errno, "read the result of the isolated process"));
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = pread(fd, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Fail(ErrorCode::kInternal, "cannot read the result of the isolated process");
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

// The address space of this process; the limit is relative to it.
std::uint64_t AddressSpaceBytes() {
  std::uint64_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    unsigned long long total = 0;
    if (std::fscanf(file, "%llu", &total) == 1) pages = total;
    std::fclose(file);
  }
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void Limit(__rlimit_resource resource, std::uint64_t soft, std::uint64_t hard) {
  const rlimit limit{soft, hard};
  setrlimit(resource, &limit);  // fails if a stricter limit is set, which then stays
}

// Sets up the child process: no output, no core dump, resource limits, killed with the parent.
void ConfineThisProcess(const IsolationLimits& limits, std::uint64_t address_space_bytes) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  const int null = open("/dev/null", O_RDWR);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, standard);
  Limit(RLIMIT_CORE, 0, 0);
  Limit(RLIMIT_CPU, limits.processor_s, limits.processor_s + 1);
  if (!kSanitized) {
    const std::uint64_t bytes = address_space_bytes + limits.memory_bytes;
    Limit(RLIMIT_AS, bytes, bytes);
    Limit(RLIMIT_FSIZE, limits.memory_bytes, limits.memory_bytes);
  }
}

int RunAndWrite(const std::function<Expected<std::string>()>& work, int fd) {
  try {
    const Expected<std::string> result = work();
    if (result) return WriteAll(fd, *result) ? kDone : kOutOfMemory;
    const std::string error = static_cast<char>(result.error().code) + result.error().message;
    return WriteAll(fd, error) ? kFailed : kOutOfMemory;
  } catch (const cv::Exception& exception) {
    if (exception.code != cv::Error::StsNoMem) throw;
    return kOutOfMemory;
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  }
}

Error TooLarge(const IsolationLimits& limits) {
  return {ErrorCode::kUnsupported,
          fmt::format("takes more than {} MiB of memory to read: use a smaller file", limits.memory_bytes >> 20)};
}

Expected<std::string> ReadChildResult(int wait_status, int fd, const IsolationLimits& limits) {
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    if (signal == SIGXCPU) {
      return Fail(ErrorCode::kUnsupported,
                  fmt::format("takes more than {} s of processor time to read: use a smaller file, or one that is not "
                              "damaged",
                              limits.processor_s));
    }
    if (signal == SIGKILL) {
      return Fail(ErrorCode::kUnsupported, "killed while it was read: the machine may be out of memory");
    }
    if (signal == SIGXFSZ) return std::unexpected(TooLarge(limits));
    if (signal == SIGINT || signal == SIGTERM) return Fail(ErrorCode::kCancelled, "cancelled");
    return Fail(ErrorCode::kDataLoss, "damaged: the importer crashed");
  }
  switch (WEXITSTATUS(wait_status)) {
    case kDone:
      return ReadAll(fd);
    case kFailed: {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::string error, ReadAll(fd));
      return Fail(static_cast<ErrorCode>(error.at(0)), error.substr(1));
    }
    case kOutOfMemory:
      return std::unexpected(TooLarge(limits));
    default:  // a sanitizer stopped the process
      return Fail(ErrorCode::kDataLoss, "damaged: the importer crashed");
  }
}

}  // namespace

Expected<std::string> RunIsolated(const std::function<Expected<std::string>()>& work, const IsolationLimits& limits) {
  const FileDescriptor result(memfd_create("isolated", MFD_CLOEXEC));
  if (result.fd() < 0) return std::unexpected(ErrorFromErrno(errno, "create the result file of the isolated process"));
  const std::uint64_t address_space_bytes = AddressSpaceBytes();
  const pid_t child = fork();
  if (child < 0) return std::unexpected(ErrorFromErrno(errno, "start the isolated process"));
  if (child == 0) {
    ConfineThisProcess(limits, address_space_bytes);
    _exit(RunAndWrite(work, result.fd()));
  }
  int wait_status = 0;
  while (waitpid(child, &wait_status, 0) < 0) {
    if (errno != EINTR) return std::unexpected(ErrorFromErrno(errno, "wait for the isolated process"));
  }
  return ReadChildResult(wait_status, result.fd(), limits);
}

}  // namespace victorious
