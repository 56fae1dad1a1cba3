#include "victorious/base/sandbox.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace victorious {
namespace {

// ---- Landlock, whose header of Debian 12 knows the first versions only

constexpr unsigned kLandlockVersionFlag = 1;
constexpr int kLandlockPathBeneath = 1;
constexpr std::uint64_t kReadFile = 1 << 2;
constexpr std::uint64_t kReadFolder = 1 << 3;

struct LandlockRuleset {
  std::uint64_t file_access = 0;
  std::uint64_t network_access = 0;  // from version 4
  std::uint64_t scope = 0;           // from version 6
};

struct [[gnu::packed]] LandlockPath {
  std::uint64_t access = 0;
  std::int32_t parent = -1;
};

// All that a version can refuse.
LandlockRuleset RefuseAll(int version) {
  LandlockRuleset all;
  const int file_rights = version == 1 ? 13 : version == 2 ? 14 : version < 5 ? 15 : 16;
  all.file_access = (std::uint64_t{1} << file_rights) - 1;
  if (version >= 4) all.network_access = 3;  // bind, connect
  if (version >= 6) all.scope = 3;           // abstract Unix sockets, signals
  return all;
}

// What the kernel of a version knows of the structure.
std::size_t RulesetBytes(int version) {
  if (version >= 6) return sizeof(LandlockRuleset);
  return version >= 4 ? offsetof(LandlockRuleset, scope) : offsetof(LandlockRuleset, network_access);
}

int LandlockVersion() {
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, kLandlockVersionFlag);
  return version > 0 ? static_cast<int>(version) : 0;
}

Error Refused(const char* what) { return ErrorFromErrno(errno, fmt::format("confine a decoder by {}", what)); }

Status AllowReading(int ruleset, const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (descriptor < 0) return {};  // who reads it gets the error
  struct stat status = {};
  const bool is_folder = ::fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode);
  const LandlockPath rule{.access = is_folder ? kReadFile | kReadFolder : kReadFile, .parent = descriptor};
  const long result = ::syscall(SYS_landlock_add_rule, ruleset, kLandlockPathBeneath, &rule, 0);
  const Status added = result == 0 ? Status() : std::unexpected(Refused("Landlock"));
  ::close(descriptor);
  return added;
}

Status EnterLandlock(std::span<const std::filesystem::path> readable) {
  const int version = LandlockVersion();
  if (version == 0) return {};
  const LandlockRuleset refused = RefuseAll(version);
  const auto ruleset = static_cast<int>(::syscall(SYS_landlock_create_ruleset, &refused, RulesetBytes(version), 0));
  if (ruleset < 0) return std::unexpected(Refused("Landlock"));
  Status entered;
  for (const std::filesystem::path& path : readable) {
    if (entered) entered = AllowReading(ruleset, path);
  }
  if (entered && ::syscall(SYS_landlock_restrict_self, ruleset, 0) != 0) entered = std::unexpected(Refused("Landlock"));
  ::close(ruleset);
  return entered;
}

// ---- seccomp

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kMachine = 0;  // the filter has no table of this machine's system calls
#endif

// What decoders call most, which the filter lets pass first.
constexpr auto kFrequent = std::to_array<int>({SYS_read, SYS_write, SYS_lseek, SYS_pread64, SYS_mmap, SYS_munmap,
                                               SYS_mprotect, SYS_madvise, SYS_brk, SYS_futex, SYS_fstat, SYS_close});

constexpr auto kRefused = std::to_array<int>({
    // the network, and descriptors from elsewhere
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_sendto,
    SYS_sendmsg,
    SYS_sendmmsg,
    SYS_recvmsg,
    SYS_recvmmsg,
    SYS_io_uring_setup,
    SYS_io_uring_enter,
    SYS_io_uring_register,
    // programs and other processes
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_process_madvise,
    SYS_kcmp,
    SYS_tkill,
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    SYS_setpgid,
    SYS_setsid,
    SYS_setpriority,
    SYS_ioprio_set,
    SYS_sched_setscheduler,
    SYS_sched_setattr,
    SYS_sched_setparam,
    // the kernel
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_syslog,
    SYS_acct,
    SYS_quotactl,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_adjtimex,
    SYS_clock_adjtime,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_personality,
    SYS_vhangup,
    // the file system: all but reading
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_unshare,
    SYS_setns,
    SYS_move_mount,
    SYS_open_tree,
    SYS_fsopen,
    SYS_fsconfig,
    SYS_fsmount,
    SYS_fspick,
    SYS_mount_setattr,
    SYS_open_by_handle_at,
    SYS_name_to_handle_at,
    SYS_truncate,
    SYS_mkdirat,
    SYS_mknodat,
    SYS_unlinkat,
    SYS_symlinkat,
    SYS_linkat,
    SYS_renameat,
    SYS_renameat2,
    SYS_fchmod,
    SYS_fchmodat,
    SYS_fchown,
    SYS_fchownat,
    SYS_utimensat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    SYS_fanotify_init,
    SYS_inotify_init1,
#if defined(__x86_64__)
    // the older forms of these
    SYS_fork,
    SYS_vfork,
    SYS_creat,
    SYS_unlink,
    SYS_rename,
    SYS_mkdir,
    SYS_rmdir,
    SYS_link,
    SYS_symlink,
    SYS_mknod,
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
    SYS_inotify_init,
    SYS_iopl,
    SYS_ioperm,
    SYS_modify_ldt,
    SYS_uselib,
#endif
});

// The program of the filter, in the order of its tests.
class FilterWriter {
 public:
  FilterWriter() {
    Load(offsetof(seccomp_data, arch));
    JumpUnlessEqual(kMachine, 1);  // another machine's system calls have other numbers
    Jump(1);
    Return(SECCOMP_RET_KILL_PROCESS);
    Load(offsetof(seccomp_data, nr));
    constexpr std::uint32_t kFirstUnknown =
        SYS_set_mempolicy_home_node + 1;  // of later kernels, and x32's of all others
    code_.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, kFirstUnknown, 0, 1));
    Refuse(ENOSYS);
  }

  void Allow(int call) {
    JumpUnlessEqual(static_cast<std::uint32_t>(call), 1);
    Return(SECCOMP_RET_ALLOW);
  }

  void Refuse(int call, int error) {
    JumpUnlessEqual(static_cast<std::uint32_t>(call), 1);
    Refuse(error);
  }

  /// Allows a call if the bits of `mask` of an argument are `wanted`.
  void AllowIf(int call, int argument, std::uint32_t mask, std::uint32_t wanted, int error) {
    JumpUnlessEqual(static_cast<std::uint32_t>(call), 5);
    Load(static_cast<std::uint32_t>(offsetof(seccomp_data, args) + sizeof(std::uint64_t) * std::size_t(argument)));
    code_.push_back(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, mask));
    JumpUnlessEqual(wanted, 1);
    Return(SECCOMP_RET_ALLOW);
    Refuse(error);
  }

  std::vector<sock_filter> Finish() {
    Return(SECCOMP_RET_ALLOW);
    return std::move(code_);
  }

 private:
  void Load(std::size_t offset) {
    code_.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  }
  void JumpUnlessEqual(std::uint32_t value, std::uint8_t skipped) {
    code_.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, skipped));
  }
  void Jump(std::uint32_t skipped) { code_.push_back(BPF_STMT(BPF_JMP | BPF_JA, skipped)); }
  void Return(std::uint32_t action) { code_.push_back(BPF_STMT(BPF_RET | BPF_K, action)); }
  void Refuse(int error) { Return(SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error)); }

  std::vector<sock_filter> code_;
};

std::vector<sock_filter> MakeFilter() {
  constexpr std::uint32_t kAll = ~0U;
  constexpr std::uint32_t kThread = CLONE_VM | CLONE_THREAD;
  constexpr std::uint32_t kWriting = O_ACCMODE | O_CREAT | O_TRUNC;
  const auto own = static_cast<std::uint32_t>(::getpid());
  FilterWriter filter;
  for (const int call : kFrequent) filter.Allow(call);
  for (const int call : kRefused) filter.Refuse(call, EPERM);
  filter.AllowIf(SYS_clone, 0, kThread, kThread, EPERM);
  // Their flags are in memory, which a filter cannot read; the library then takes clone and openat.
  filter.Refuse(SYS_clone3, ENOSYS);
  filter.Refuse(SYS_openat2, ENOSYS);
  filter.AllowIf(SYS_openat, 2, kWriting, O_RDONLY, EACCES);
#if defined(__x86_64__)
  filter.AllowIf(SYS_open, 1, kWriting, O_RDONLY, EACCES);
#endif
  filter.AllowIf(SYS_kill, 0, kAll, own, EPERM);    // abort() and raise()
  filter.AllowIf(SYS_tgkill, 0, kAll, own, EPERM);  // the same
  filter.AllowIf(SYS_prlimit64, 0, kAll, 0, EPERM);
  return filter.Finish();
}

bool HasSeccomp() {
  if (kMachine == 0) return false;
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

Status EnterSeccomp() {
  if (!HasSeccomp()) return {};
  std::vector<sock_filter> code = MakeFilter();
  const sock_fprog program{.len = static_cast<unsigned short>(code.size()), .filter = code.data()};
  if (::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0) return {};
  return std::unexpected(Refused("seccomp"));
}

}  // namespace

SandboxSupport FindSandboxSupport() { return {.has_seccomp = HasSeccomp(), .landlock_version = LandlockVersion()}; }

std::string DescribeSandbox(const SandboxSupport& support) {
  const bool has_landlock = support.landlock_version > 0;
  if (support.has_seccomp && has_landlock) return "seccomp, Landlock";
  if (support.has_seccomp) return "seccomp; this kernel has no Landlock, so decoders can read other files";
  if (has_landlock) return "Landlock; this kernel has no seccomp, so decoders can start processes";
  return "none: this kernel has neither seccomp nor Landlock";
}

Status EnterSandbox(std::span<const std::filesystem::path> readable) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return std::unexpected(Refused("no_new_privs"));
  VICTORIOUS_RETURN_IF_ERROR(EnterLandlock(readable));
  return EnterSeccomp();  // last: it would refuse to open what Landlock asks for
}

}  // namespace victorious
