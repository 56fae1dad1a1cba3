// The model library: a folder with one file per model, NAME.vmodel (docs/formats/model.md).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/types/object_model.h"

namespace victorious {

class ModelLibrary {
 public:
  explicit ModelLibrary(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// OK if a model of this name can be added. Errors: kInvalidArgument, the name is not a file name of letters, digits,
  /// '.', '_', '-', or the folder is a file; kAlreadyExists, the library has a model of this name; kPermissionDenied.
  [[nodiscard]] Status CheckNewName(std::string_view name) const;

  /// Writes the model; creates the folder if it does not exist. Errors: those of CheckNewName() and of writing.
  [[nodiscard]] Status Add(const ObjectModel& model) const;

  /// Writes the model in the place of the one of its name; that stays if writing fails. Errors: those of writing.
  [[nodiscard]] Status Replace(const ObjectModel& model) const;

  /// The names of all files with valid model names, in alphabetical order. Error: kNotFound, no such folder.
  [[nodiscard]] Expected<std::vector<std::string>> Names() const;

  /// The file of the model of this name, which need not exist.
  [[nodiscard]] std::filesystem::path PathOf(std::string_view name) const;

  /// Errors: kInvalidArgument, kNotFound, and those of ReadModelFile().
  [[nodiscard]] Expected<ObjectModel> Load(std::string_view name) const;
  [[nodiscard]] Expected<std::vector<ObjectModel>> LoadAll() const;
  [[nodiscard]] Status Remove(std::string_view name) const;

 private:
  [[nodiscard]] Error NotFoundError(std::string_view name) const;

  std::filesystem::path folder_;
};

}  // namespace victorious
