#include "victorious/base/child_start.h"

#include <algorithm>
#include <cerrno>
#include <csignal>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace victorious {
namespace {

constexpr int kNotStarted = 127;  // as a shell says it

// What the child needs and may not compute itself.
struct PreparedStart {
  const char* executable;
  char** argv;
  pid_t parent;
  int descriptor;
  bool has_own_group;
  bool has_stderr;
  int descriptor_end;  // where the kernel has no close_range
};

// One above the greatest descriptor that can be open.
int DescriptorEnd() {
  constexpr rlim_t kMost = 1 << 20;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return kMost;
  return static_cast<int>(std::min(limit.rlim_cur, kMost));
}

void CloseFrom(int first, int end) {
#ifdef SYS_close_range
  if (::syscall(SYS_close_range, static_cast<unsigned>(first), ~0U, 0U) == 0) return;
#endif
  for (int descriptor = first; descriptor < end; ++descriptor) ::close(descriptor);
}

// In the child: async-signal-safe calls only.
[[noreturn]] void BecomeProgram(const PreparedStart& start) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != start.parent) ::_exit(kNotStarted);  // the parent died before
  if (start.has_own_group) ::setpgid(0, 0);
  // Above those that are replaced: a parent without standard input may have got a small number for it.
  const int kept = ::fcntl(start.descriptor, F_DUPFD, kChildDescriptor + 1);
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (kept < 0 || null < 0) ::_exit(kNotStarted);
  // dup2 of a descriptor onto itself leaves O_CLOEXEC, so none is one of its targets.
  const int high_null = ::fcntl(null, F_DUPFD, kChildDescriptor + 1);
  ::dup2(high_null, STDIN_FILENO);
  ::dup2(high_null, STDOUT_FILENO);
  if (!start.has_stderr) ::dup2(high_null, STDERR_FILENO);
  ::dup2(kept, kChildDescriptor);
  CloseFrom(kChildDescriptor + 1, start.descriptor_end);
  ::execv(start.executable, start.argv);
  ::_exit(kNotStarted);
}

}  // namespace

Expected<pid_t> StartChild(const ChildStart& start) {
  // All that allocates happens before fork.
  std::vector<std::string> words = start.arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const PreparedStart prepared{.executable = start.executable.c_str(),
                               .argv = argv.data(),
                               .parent = ::getpid(),
                               .descriptor = start.descriptor,
                               .has_own_group = start.has_own_group,
                               .has_stderr = start.has_stderr,
                               .descriptor_end = DescriptorEnd()};
  const pid_t child = ::fork();
  if (child < 0) return std::unexpected(ErrorFromErrno(errno, "start a process"));
  if (child == 0) BecomeProgram(prepared);
  return child;
}

}  // namespace victorious
