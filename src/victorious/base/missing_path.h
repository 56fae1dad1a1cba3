// What every command says of a file or a folder that is not there.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "victorious/base/error.h"
#include "victorious/base/one_line.h"

namespace victorious {

/// "NAME: no such file: ADVICE", kNotFound.
[[nodiscard]] inline Error NoSuchFile(const std::string& name, std::string_view advice) {
  return {ErrorCode::kNotFound, OneLine(name) + ": no such file: " + std::string(advice)};
}

/// Errors: "PATH: no such folder: ADVICE", kNotFound; "PATH: a file, not a folder: ADVICE", kInvalidArgument; those of
/// the file system.
[[nodiscard]] inline Status CheckIsFolder(const std::filesystem::path& path, std::string_view advice) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) return {};
  const std::string ending = ": " + std::string(advice);
  if (std::filesystem::exists(status)) {
    return Fail(ErrorCode::kInvalidArgument, OneLine(path.string()) + ": a file, not a folder" + ending);
  }
  const bool is_absent = !error || error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory;
  if (!is_absent) return std::unexpected(ErrorFromErrno(error.value(), OneLine(path.string())));
  return Fail(ErrorCode::kNotFound, OneLine(path.string()) + ": no such folder" + ending);
}

}  // namespace victorious
