// External test data, read from $VICTORIOUS_DATA (default ../shared/data beside the project), never copied into the
// repository; and scratch folders.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace victorious::testing {

/// Returns $VICTORIOUS_DATA/relative, which need not exist.
std::filesystem::path DataPath(std::string_view relative);

/// A temporary empty folder; the destructor removes it.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace victorious::testing

/// Declares `variable` as the path of external data; skips the test with a message if it does not exist.
#define VICTORIOUS_DATA_OR_SKIP(variable, relative)                                 \
  const std::filesystem::path variable = ::victorious::testing::DataPath(relative); \
  if (!std::filesystem::exists(variable)) GTEST_SKIP() << "SKIPPED: no outside data at " << variable
