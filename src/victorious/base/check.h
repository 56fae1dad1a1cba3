// VICTORIOUS_CHECK: a programmer's mistake, never reachable from input. It prints where and ends the program.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace victorious::internal {

[[noreturn]] inline void CheckFailed(const char* file, int line, const char* condition) {
  std::fprintf(stderr, "%s:%d: check failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace victorious::internal

#define VICTORIOUS_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::victorious::internal::CheckFailed(__FILE__, __LINE__, #condition))
