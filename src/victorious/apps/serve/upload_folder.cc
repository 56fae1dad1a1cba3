#include "victorious/apps/serve/upload_folder.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>

#include "victorious/base/folder.h"
#include "victorious/base/log.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxNameBytes = 200;
constexpr std::size_t kIdDigits = 16;

bool IsPlainName(std::string_view name) {
  const auto is_bad = [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  return !name.empty() && name.size() <= kMaxNameBytes && name.front() != '.' && std::ranges::none_of(name, is_bad);
}

bool IsId(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == kIdDigits && std::ranges::all_of(text, is_digit);
}

}  // namespace

Expected<fs::path> UploadFolder::Create(std::string_view name) const {
  if (!IsPlainName(name)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("name: must be a file name of at most {} bytes, without a folder", kMaxNameBytes));
  }
  std::random_device random;
  const std::string id = fmt::format("{:08x}{:08x}", random(), random());
  std::error_code error;
  fs::create_directories(folder_ / id, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), (folder_ / id).string()));
  return folder_ / id / name;
}

std::string UploadFolder::IdOf(const fs::path& file) { return file.parent_path().filename().string(); }

Expected<fs::path> UploadFolder::Find(std::string_view id) const {
  std::error_code error;
  if (IsId(id)) {
    for (const fs::path& path : ListFolder(folder_ / id).value_or(std::vector<fs::path>())) {
      if (fs::is_regular_file(path, error)) return path;
    }
  }
  return Fail(ErrorCode::kNotFound, fmt::format("there is no upload \"{}\"", id.substr(0, kIdDigits)));
}

std::vector<UploadFolder::Listed> UploadFolder::List() const {
  std::vector<Listed> uploads;
  for (const fs::path& folder : ListFolder(folder_).value_or(std::vector<fs::path>())) {
    if (!IsId(folder.filename().string())) continue;
    const auto file = Find(folder.filename().string());
    std::error_code error;
    const fs::file_time_type written = fs::last_write_time(file ? *file : folder, error);
    if (!error) uploads.push_back({.id = folder.filename(), .written = written});
  }
  return uploads;
}

void UploadFolder::RemoveFile(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
  fs::remove(file.parent_path(), ignored);  // fails if it has other files
}

std::set<std::string> UploadFolder::IdsIn(std::string_view text) {
  std::set<std::string> ids;
  for (std::size_t at = text.find('/'); at != text.npos; at = text.find('/', at + 1)) {
    const std::string_view id = text.substr(at + 1, kIdDigits);
    if (IsId(id) && text.substr(at + 1 + kIdDigits, 1) == "/") ids.emplace(id);
  }
  return ids;
}

void UploadFolder::Remove(std::string_view id) const {
  if (!IsId(id)) return;
  std::error_code error;
  fs::remove_all(folder_ / id, error);
  if (error) LogWarning("remove {}: {}", (folder_ / id).string(), error.message());
}

}  // namespace victorious
