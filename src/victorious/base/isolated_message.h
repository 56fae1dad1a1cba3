// Private to base/: what a program and its isolated process say to each other, each message a header and its bytes.
#pragma once

#include <cstdint>

namespace victorious {

enum class IsolatedMessage : std::uint32_t {
  kCopy,    ///< to a process without limits, with the socket of the copy; the answer is a result, the copy's process id
  kLimits,  ///< to the process: memory and processor time, then the paths that it may read
  kRequest,  ///< to the process
  kResult,   ///< from the process: of the function
  kError,    ///< from the process: one byte for the code, then the message
};

/// Both ends are of one build, so that their bytes are those of memory.
struct IsolatedHeader {
  IsolatedMessage kind = IsolatedMessage::kRequest;
  std::uint32_t unused = 0;
  std::uint64_t size = 0;  ///< bytes that follow
};

}  // namespace victorious
