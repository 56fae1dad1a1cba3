#include "victorious/apps/cluster/content_file.h"

#include <algorithm>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "victorious/base/absolute_path.h"
#include "victorious/base/file.h"
#include "victorious/base/one_line.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kIdDigits = 32;

Error FileError(const std::error_code& error, std::string_view verb, const fs::path& path) {
  return ErrorFromErrno(error.value(), fmt::format("{} {}", verb, OneLine(path.string())));
}

// Whether this is the published file. A link to the file itself needs no comparison.
Expected<bool> HasContent(const fs::path& published, const ContentFile& file, const CancelToken& cancel) {
  std::error_code absent;
  const std::uintmax_t bytes = fs::file_size(published, absent);
  if (absent || bytes != static_cast<std::uintmax_t>(file.bytes)) return false;
  if (fs::equivalent(published, file.path, absent)) return true;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string content_id, ContentId(published, cancel));
  return content_id == file.content_id;
}

}  // namespace

bool IsValid(const ContentFile& file) {
  const fs::path path = file.path;
  const bool is_path = path.is_absolute() && path == path.lexically_normal() && path.has_filename();
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return is_path && file.content_id.size() == kIdDigits && std::ranges::all_of(file.content_id, is_digit) &&
         file.bytes >= 0;
}

fs::path PathInPlace(const ContentFile& file) { return fs::path(file.content_id.substr(0, 2)) / file.content_id; }

Expected<ContentFile> DescribeFile(const fs::path& file, const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::string content_id, ContentId(file, cancel));
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error) return std::unexpected(FileError(error, "read", file));
  return ContentFile{
      .path = AbsolutePath(file), .content_id = std::move(content_id), .bytes = static_cast<std::int64_t>(bytes)};
}

Status PublishFile(const ContentFile& file, const fs::path& place, const CancelToken& cancel) {
  const fs::path published = place / PathInPlace(file);
  VICTORIOUS_ASSIGN_OR_RETURN(const bool is_there, HasContent(published, file, cancel));
  if (is_there) return {};
  std::error_code error;
  fs::create_directories(published.parent_path(), error);
  if (error) return std::unexpected(FileError(error, "create", published.parent_path()));
  const fs::path source = fs::canonical(file.path, error);
  if (error) return std::unexpected(FileError(error, "read", file.path));
  const fs::path temporary = published.string() + fmt::format(".tmp-{}", ::getpid());
  fs::remove(temporary, error);
  fs::create_hard_link(source, temporary, error);
  if (error) fs::copy_file(source, temporary, error);
  if (!error) fs::rename(temporary, published, error);
  if (!error) return {};
  std::error_code ignored;
  fs::remove(temporary, ignored);
  return std::unexpected(FileError(error, "write", published));
}

}  // namespace victorious
