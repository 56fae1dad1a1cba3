#include "victorious/serve/upload_folder.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxNameBytes = 200;
constexpr std::size_t kIdDigits = 16;

bool IsPlainName(std::string_view name) {
  const auto is_bad = [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  return !name.empty() && name.size() <= kMaxNameBytes && name.front() != '.' && std::ranges::none_of(name, is_bad);
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
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  std::error_code error;
  if (id.size() == kIdDigits && std::ranges::all_of(id, is_digit)) {
    for (fs::directory_iterator at(folder_ / id, error), end; !error && at != end; at.increment(error)) {
      if (at->is_regular_file(error)) return at->path();
    }
  }
  return Fail(ErrorCode::kNotFound, fmt::format("there is no upload \"{}\"", id.substr(0, kIdDigits)));
}

}  // namespace victorious
