// The library of models: a folder with one file a model, NAME.vmodel (docs/formats/model.md).
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

  /// OK if a model of this name can be added: the name is a file name of letters, digits, '.', '_', '-'
  /// (kInvalidArgument) and not taken (kAlreadyExists).
  [[nodiscard]] Status CheckNewName(std::string_view name) const;

  /// Writes the model, making the folder if it is not there. Errors: CheckNewName's, and those of writing.
  [[nodiscard]] Status Add(const ObjectModel& model) const;

  /// The names in alphabetical order, of files that are named as models are; kNotFound if there is no such folder.
  [[nodiscard]] Expected<std::vector<std::string>> Names() const;

  [[nodiscard]] Expected<ObjectModel> Load(std::string_view name) const;
  [[nodiscard]] Expected<std::vector<ObjectModel>> LoadAll() const;
  [[nodiscard]] Status Remove(std::string_view name) const;

 private:
  [[nodiscard]] std::filesystem::path PathOf(std::string_view name) const;
  [[nodiscard]] Error NotThere(std::string_view name) const;

  std::filesystem::path folder_;
};

}  // namespace victorious
