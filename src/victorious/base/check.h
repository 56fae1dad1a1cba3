// VICTORIOUS_CHECK: an assertion for programming errors, which input must never trigger. It prints file, line and
// condition, and aborts. Active in all builds.
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
