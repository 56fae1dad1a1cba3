// Outside data for tests: read from $VICTORIOUS_DATA (default ../shared/data beside the project), never copied into it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace victorious::testing {

/// $VICTORIOUS_DATA/relative, whether or not it exists.
std::filesystem::path DataPath(std::string_view relative);

/// An empty folder of this test's own, removed with the object.
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

/// Declares `variable` as the path of outside data, and skips the test, by name, where it is absent.
#define VICTORIOUS_DATA_OR_SKIP(variable, relative)                                 \
  const std::filesystem::path variable = ::victorious::testing::DataPath(relative); \
  if (!std::filesystem::exists(variable)) GTEST_SKIP() << "SKIPPED: no outside data at " << variable
