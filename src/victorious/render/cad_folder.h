// Private to render/: the files that a CAD file may draw on, which are those in its own folder and below it.
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
  /// @param bytes   the CAD file itself, used as long as this object lives
  /// @param name    its name, without a folder
  /// @param folder  where it lies; nothing: it stands alone
  CadFolder(std::span<const std::byte> bytes, std::string name, std::optional<std::filesystem::path> folder);

  [[nodiscard]] const std::string& name() const { return name_; }

  /// Where a name that stands in the CAD file leads: nothing if there is no such file, or it lies elsewhere. A path of
  /// another machine ("C:\work\tank.png") is looked for by its last part, a URI's escapes ("%20") are undone.
  [[nodiscard]] std::optional<std::filesystem::path> Find(std::string_view name) const;

  /// The CAD file's bytes for its own name, else those of the file that Find() finds.
  [[nodiscard]] Expected<std::string> Read(std::string_view name) const;

 private:
  [[nodiscard]] std::optional<std::filesystem::path> Inside(const std::filesystem::path& relative) const;

  std::span<const std::byte> bytes_;
  std::string name_;
  std::optional<std::filesystem::path> folder_;  ///< canonical
};

}  // namespace victorious
