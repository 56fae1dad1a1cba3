// Starts a program as a child process that inherits nothing but what it is given. What happens between fork and exec is
// system calls only: the process that forks may have threads, and its child must not take a lock that one of them held.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "victorious/base/error.h"

namespace victorious {

/// The descriptor on which a child finds what its parent gave it.
inline constexpr int kChildDescriptor = 3;

struct ChildStart {
  std::filesystem::path executable;
  std::vector<std::string> arguments;  ///< the program's name first
  int descriptor = -1;                 ///< of this process; becomes kChildDescriptor
  bool has_own_group = false;          ///< Ctrl-C in the terminal of this process is not for the child
  bool has_stderr = false;             ///< that of this process; else /dev/null
};

/// Starts the child. Standard input and output are /dev/null, and no other descriptor than those above is open in it.
/// It is killed when the thread that calls this ends. Returns its process id; the caller waits for it.
/// Errors: those of fork. A child whose program cannot be executed ends with the status 127.
[[nodiscard]] Expected<pid_t> StartChild(const ChildStart& start);

}  // namespace victorious
