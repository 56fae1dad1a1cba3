// What long work reports, and how it is ended early.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace libvictorious {

struct Progress {
  std::string label;                  ///< the item that is processed, as a file name
  std::int64_t done = 0;              ///< units
  std::optional<std::int64_t> total;  ///< units; std::nullopt: not known
  std::string unit;                   ///< their name in the plural: "frames"
  double elapsed_s = 0;               ///< since the step began
};

/// Called about every 0.1 s while the work goes on, from one thread at a time, which need not be the one that started
/// it. Returns false to end the work: the function then throws kCancelled, and what is stored until then stays. What it
/// throws ends the work as well, and is thrown again by the function.
using ProgressCallback = std::function<bool(const Progress& progress)>;

/// Called with one line of text, from one thread at a time: what was doubtful, and what was done about it. It must not
/// throw.
using WarningCallback = std::function<void(const std::string& warning)>;

}  // namespace libvictorious
