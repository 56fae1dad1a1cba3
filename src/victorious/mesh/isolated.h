// Private to mesh/: runs code that may crash in a forked process with limited memory and CPU time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

struct IsolationLimits {
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< address space in addition to that of the parent process
  unsigned processor_s = 10;                            ///< CPU time, s
};

/// Runs `work` in a forked copy of this process and returns its result. The copy has one thread only. `work` sees the
/// memory of the parent as it is at the call; its writes to that memory are lost. `work` must not start or wait for
/// threads.
/// Errors: those of `work`; kDataLoss if it crashes; kUnsupported if it exceeds the limits; kInternal if the process
/// cannot be started. Under a sanitizer only the sanitizer limits the memory.
[[nodiscard]] Expected<std::string> RunIsolated(const std::function<Expected<std::string>()>& work,
                                                const IsolationLimits& limits = {});

}  // namespace victorious
