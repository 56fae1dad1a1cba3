// The side of the isolated process (isolated_process.h): waits for the limits, confines itself, and answers requests,
// one after the other. It has one thread.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

/// A function that an isolated process runs.
struct IsolatedFunction {
  std::string_view name;
  /// May crash, and throw std::bad_alloc. It keeps its state between the requests of one process.
  std::function<Expected<std::string>(std::string_view request)> answer;
};

/// The body of main(): answers until the parent closes its end, and returns the exit status.
[[nodiscard]] int RunIsolatedFunction(int argc, char** argv, std::span<const IsolatedFunction> functions);

}  // namespace victorious
