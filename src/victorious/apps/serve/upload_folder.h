// Where uploaded files go: DIR/ID/NAME, with an id of our own for each upload, so that equal names do not meet.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

class UploadFolder {
 public:
  /// @param folder  created with the first upload
  explicit UploadFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Makes the folder of a new upload. Returns the path of its file, which is not there yet. Errors: kInvalidArgument
  /// for a name that is not a plain file name (a hidden one, one with a slash or a control character, or longer than
  /// 200 bytes); those of creating folders.
  [[nodiscard]] Expected<std::filesystem::path> Create(std::string_view name) const;

  /// The id of the upload that a path made by Create belongs to.
  [[nodiscard]] static std::string IdOf(const std::filesystem::path& file);

  /// The file of an upload. Error: kNotFound.
  [[nodiscard]] Expected<std::filesystem::path> Find(std::string_view id) const;

  /// Removes the file of an upload that broke off, and its folder. What cannot be removed stays with the other uploads.
  static void RemoveFile(const std::filesystem::path& file);

  /// The ids of uploads in a text with paths, such as the input of a job; each once.
  [[nodiscard]] static std::set<std::string> IdsIn(std::string_view text);

  struct Listed {
    std::string id;
    std::filesystem::file_time_type written;  ///< when its file was written last
  };
  /// All uploads, also those whose file is still being written.
  [[nodiscard]] std::vector<Listed> List() const;

  /// Removes an upload with its file; none is no error. What cannot be removed is logged.
  void Remove(std::string_view id) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace victorious
