#include "victorious/object/model/model_library.h"

#include <algorithm>
#include <cerrno>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/folder.h"
#include "victorious/base/missing_path.h"
#include "victorious/base/write_access.h"
#include "victorious/object/model/model_file.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".vmodel";
constexpr std::size_t kMaxNameLength = 100;

Status CheckName(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-';
  };
  const bool good = !name.empty() && name.size() <= kMaxNameLength && name.front() != '.' && name.front() != '-' &&
                    std::ranges::all_of(name, allowed);
  if (good) return {};
  return Fail(ErrorCode::kInvalidArgument, fmt::format("model name \"{}\": up to {} letters, digits, '.', '_' and '-' "
                                                       "are allowed, the first a letter, a digit or '_'",
                                                       name, kMaxNameLength));
}

// OK if files can be written into the folder, or into one that it can be made in.
Status CheckFolder(const fs::path& folder) {
  for (fs::path at = folder; !at.empty(); at = at.parent_path()) {
    std::error_code error;
    const fs::file_status status = fs::status(at, error);
    if (!fs::exists(status)) continue;
    if (!fs::is_directory(status)) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: is a file: give a folder of models", at.string()));
    }
    if (!IsWritable(at)) return std::unexpected(ErrorFromErrno(errno, at.string()));
    break;
  }
  return {};
}

}  // namespace

fs::path ModelLibrary::PathOf(std::string_view name) const { return folder_ / fmt::format("{}{}", name, kSuffix); }

Status ModelLibrary::CheckNewName(std::string_view name) const {
  VICTORIOUS_RETURN_IF_ERROR(CheckName(name));
  std::error_code error;
  if (fs::exists(PathOf(name), error)) {
    return Fail(
        ErrorCode::kAlreadyExists,
        fmt::format("model {} is already in {}: choose another name, or remove it first", name, folder_.string()));
  }
  return CheckFolder(folder_);
}

Status ModelLibrary::Add(const ObjectModel& model) const {
  VICTORIOUS_RETURN_IF_ERROR(CheckNewName(model.name));
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), fmt::format("create folder {}", folder_.string())));
  return WriteModelFile(PathOf(model.name), model);
}

Status ModelLibrary::Replace(const ObjectModel& model) const {
  VICTORIOUS_RETURN_IF_ERROR(CheckName(model.name));
  return WriteModelFile(PathOf(model.name), model);
}

Expected<std::vector<std::string>> ModelLibrary::Names() const {
  VICTORIOUS_RETURN_IF_ERROR(CheckIsFolder(folder_, "`victorious model add` makes one"));
  std::error_code error;
  std::vector<std::string> names;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> paths, ListFolder(folder_));
  for (const fs::path& path : paths) {
    std::string name = path.stem().string();
    const bool is_model = path.extension() == kSuffix && fs::is_regular_file(path, error) && CheckName(name);
    if (is_model) names.push_back(std::move(name));
  }
  std::ranges::sort(names);
  return names;
}

Error ModelLibrary::NotFoundError(std::string_view name) const {
  const Expected<std::vector<std::string>> names = Names();
  if (!names) return names.error();
  return {ErrorCode::kNotFound, fmt::format("model {} is not in {}; there are: {}", name, folder_.string(),
                                            names->empty() ? "none" : fmt::format("{}", fmt::join(*names, ", ")))};
}

Expected<ObjectModel> ModelLibrary::Load(std::string_view name) const {
  VICTORIOUS_RETURN_IF_ERROR(CheckName(name));
  std::error_code error;
  if (!fs::exists(PathOf(name), error)) return std::unexpected(NotFoundError(name));
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model, ReadModelFile(PathOf(name)));
  // The file name gives the model's name: a file may be copied or renamed.
  model.name = name;
  return model;
}

Expected<std::vector<ObjectModel>> ModelLibrary::LoadAll() const {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::string> names, Names());
  std::vector<ObjectModel> models;
  models.reserve(names.size());
  for (const std::string& name : names) {
    VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model, Load(name));
    models.push_back(std::move(model));
  }
  return models;
}

Status ModelLibrary::Remove(std::string_view name) const {
  VICTORIOUS_RETURN_IF_ERROR(CheckName(name));
  std::error_code error;
  if (fs::remove(PathOf(name), error)) return {};
  if (error) return std::unexpected(ErrorFromErrno(error.value(), fmt::format("remove {}", PathOf(name).string())));
  return std::unexpected(NotFoundError(name));
}

}  // namespace victorious
