// Private to render/: work that may crash, in a process of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

struct IsolationLimits {
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< address space beyond what the program has already
  unsigned processor_s = 10;
};

/// Runs `work` in a copy of this process (fork) that nothing else runs in, and returns its result. `work` sees the
/// program's memory as it is; what it changes there is lost, and it must not start or wait for threads.
/// Errors: those of `work`; kDataLoss if it crashed; kUnsupported if it went beyond the limits; kInternal if no process
/// could be started. Under a sanitizer memory is bounded only by the sanitizer itself.
Expected<std::string> RunIsolated(const std::function<Expected<std::string>()>& work,
                                  const IsolationLimits& limits = {});

}  // namespace victorious
