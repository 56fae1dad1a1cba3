// Takes the rights from this process that the decoding of hostile bytes does not need: a decoder that an attacker has
// taken over can then compute, and answer, and nothing else. Two parts of the kernel do it, each where it is there:
//
//   seccomp   refuses system calls: sockets, new programs and processes, signals to others, tracing, writing by name
//   Landlock  refuses files: all but those that are named, and these are read only
//
// Source: seccomp(2), landlock(7) of the Linux manual.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

/// What this kernel offers.
struct SandboxSupport {
  bool has_seccomp = false;
  int landlock_version = 0;  ///< 0: it has no Landlock, or it is switched off
};

[[nodiscard]] SandboxSupport FindSandboxSupport();

/// "seccomp, Landlock", or what is absent; one line.
[[nodiscard]] std::string DescribeSandbox(const SandboxSupport& support);

/// Confines this process, which has one thread, for the rest of its life. Open descriptors stay usable. A part that the
/// kernel lacks is left out.
/// @param readable  files and folders that it may read, with all that is in the folders; those that do not exist are
///                  left out
/// Errors: kInternal if the kernel offers a part, and refuses it.
[[nodiscard]] Status EnterSandbox(std::span<const std::filesystem::path> readable);

}  // namespace victorious
