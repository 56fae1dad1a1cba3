// Private to mesh/: resolves the file names in a CAD file. Only files in the CAD file's own folder, and below it, are
// accessible.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

class CadFolder {
 public:
  /// @param bytes   content of the CAD file; must outlive this object
  /// @param name    its file name, without a folder
  /// @param folder  its folder; std::nullopt if no other files are accessible
  CadFolder(std::span<const std::byte> bytes, std::string name, std::optional<std::filesystem::path> folder);

  /// The same folder, with another content of the CAD file, which must outlive the result.
  [[nodiscard]] CadFolder WithBytes(std::span<const std::byte> bytes) const;

  [[nodiscard]] const std::string& name() const { return name_; }

  /// The content of the CAD file.
  [[nodiscard]] std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

  /// The path of a file that the CAD file refers to. std::nullopt if the file does not exist or lies outside the
  /// folder. A path from another machine ("C:\work\tank.png") is also tried by its last component; URI escapes ("%20")
  /// are also tried decoded. If there is no such file, one whose name differs in case only, if it is the only one.
  [[nodiscard]] std::optional<std::filesystem::path> Find(std::string_view name) const;

  /// The content of a file: `bytes` for the CAD file's own name, else the file that Find() returns. Errors: kNotFound,
  /// and those of ReadFile().
  [[nodiscard]] Expected<std::string> Read(std::string_view name) const;

 private:
  [[nodiscard]] std::optional<std::filesystem::path> Inside(const std::filesystem::path& relative) const;
  /// Inside() of the only path that differs from it in case only.
  [[nodiscard]] std::optional<std::filesystem::path> InsideInAnyCase(const std::filesystem::path& relative) const;

  std::span<const std::byte> bytes_;
  std::string name_;
  std::optional<std::filesystem::path> folder_;  ///< canonical
};

}  // namespace victorious
