#include "victorious/object/model/relit_template_folder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <ranges>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <unistd.h>

#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/base/program_id.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kTidyInterval{1};
constexpr std::size_t kMaxBytes = std::size_t{64} << 20;  // of one template

bool IsUsable(const RelitTemplate& one) {
  const std::size_t count = one.features.size();
  const auto is_usable_point = [](const Point3& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
  };
  return one.features.descriptors.size() == count * kDescriptorSize && one.points_in_model.size() == count &&
         one.shortened.rows.size() == count * kernels::kShortBytes && one.shortened.cells.size() == count &&
         std::ranges::all_of(one.features.keypoints, [](const Keypoint& each) { return victorious::IsUsable(each); }) &&
         std::ranges::all_of(one.points_in_model, is_usable_point) &&
         std::ranges::all_of(one.shortened.cells, [](std::uint16_t cell) { return cell < kDescriptorCells; });
}

struct ModelFolder {
  fs::path path;
  fs::file_time_type used;
  std::int64_t bytes = 0;
};

std::int64_t BytesOf(const fs::path& folder) {
  std::int64_t bytes = 0;
  for (const fs::path& file : ListFolder(folder).value_or(std::vector<fs::path>())) {
    std::error_code is_gone;
    const std::uintmax_t size = fs::file_size(file, is_gone);
    if (!is_gone) bytes += static_cast<std::int64_t>(size);
  }
  return bytes;
}

// Only folders that this file named are looked at: the folder may be anybody's.
bool IsModelFolder(const fs::path& path) {
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  const std::string name = path.filename().string();
  std::error_code ignored;
  return name.size() == 16 && name.find_first_not_of(kHexDigits) == std::string::npos &&
         fs::is_directory(path, ignored) && !fs::is_symlink(path, ignored);
}

void Tidy(const fs::path& folder, std::int64_t max_bytes) {
  const fs::path mark = folder / "tidied";
  std::error_code error;
  const fs::file_time_type last = fs::last_write_time(mark, error);
  if (!error && fs::file_time_type::clock::now() - last < kTidyInterval) return;
  std::ofstream(mark) << "when the folder was looked through last: the time of this file\n";
  std::vector<ModelFolder> models;
  std::int64_t bytes = 0;
  for (const fs::path& path : ListFolder(folder).value_or(std::vector<fs::path>())) {
    if (!IsModelFolder(path)) continue;
    std::error_code is_gone;
    models.push_back({.path = path, .used = fs::last_write_time(path, is_gone), .bytes = BytesOf(path)});
    bytes += models.back().bytes;
  }
  std::ranges::sort(models, {}, &ModelFolder::used);
  for (const ModelFolder& model : models) {
    if (bytes <= max_bytes) break;
    std::error_code ignored;
    fs::remove_all(model.path, ignored);
    bytes -= model.bytes;
  }
}

// Under its name at once, complete, but not synced: a checksum tells what a power failure left.
void WriteComplete(const fs::path& path, std::span<const std::byte> bytes) {
  static std::atomic<std::uint64_t> parts{0};
  const fs::path part = fmt::format("{}.{}-{}", path.string(), ::getpid(), ++parts);
  std::ofstream file(part, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code error;
  if (file) fs::rename(part, path, error);
  if (!file || error) fs::remove(part, error);
}

std::vector<std::byte> WithChecksum(std::span<const std::byte> bytes) {
  ByteWriter packed;
  packed.Put(Checksum(bytes));
  packed.PutItems(bytes);
  return packed.Take();
}

// std::nullopt for what WithChecksum did not write.
std::optional<std::vector<std::byte>> CheckedContent(std::span<const std::byte> bytes) {
  ByteReader packed(bytes);
  const auto checksum = packed.Get<std::uint64_t>();
  std::vector<std::byte> content = packed.GetItems<std::byte>();
  if (!packed.IsAtEnd() || Checksum(content) != checksum) return std::nullopt;
  return content;
}

}  // namespace

std::vector<std::byte> PackRelitTemplate(const RelitTemplate& one) {
  ByteWriter content;
  content.Put(one.features.image_width);
  content.Put(one.features.image_height);
  content.PutItems(std::span(one.features.keypoints));
  content.PutItems(std::span(one.features.descriptors));
  content.PutItems(std::span(one.points_in_model));
  content.PutItems(std::span(one.shortened.rows));
  content.PutItems(std::span(one.shortened.cells));
  return WithChecksum(content.Take());
}

std::optional<RelitTemplate> UnpackRelitTemplate(std::span<const std::byte> bytes) {
  const std::optional<std::vector<std::byte>> content = CheckedContent(bytes);
  if (!content) return std::nullopt;
  ByteReader reader(*content);
  RelitTemplate one;
  one.features.image_width = reader.Get<int>();
  one.features.image_height = reader.Get<int>();
  one.features.keypoints = reader.GetItems<Keypoint>();
  one.features.descriptors = reader.GetItems<std::uint8_t>();
  one.points_in_model = reader.GetItems<Point3>();
  one.shortened.rows = reader.GetItems<std::int8_t>();
  one.shortened.cells = reader.GetItems<std::uint16_t>();
  if (!reader.IsAtEnd() || !IsUsable(one)) return std::nullopt;
  return one;
}

std::optional<RelitTemplate> StoredRelitTemplates::Find(const RelitTemplateKey& key) const {
  const Expected<std::string> bytes = ReadFile(PathOf(key), kMaxBytes);
  return bytes ? UnpackRelitTemplate(std::as_bytes(std::span(*bytes))) : std::nullopt;
}

void StoredRelitTemplates::Put(const RelitTemplateKey& key, const RelitTemplate& made) const {
  WriteComplete(PathOf(key), PackRelitTemplate(made));
}

std::optional<std::vector<std::byte>> StoredRelitTemplates::FindBytes(const std::string& name) const {
  const Expected<std::string> bytes = ReadFile(folder_ / name, kMaxBytes);
  return bytes ? CheckedContent(std::as_bytes(std::span(*bytes))) : std::nullopt;
}

void StoredRelitTemplates::PutBytes(const std::string& name, std::span<const std::byte> bytes) const {
  WriteComplete(folder_ / name, WithChecksum(bytes));
}

fs::path StoredRelitTemplates::PathOf(const RelitTemplateKey& key) const {
  return folder_ / fmt::format("{}-{}{}", key.sun_view, key.view, key.half_resolution ? "h" : "");
}

RelitTemplateFolder::RelitTemplateFolder(fs::path folder, std::string build, std::int64_t max_bytes)
    : folder_(std::move(folder)), build_(std::move(build)) {
  std::error_code ignored;
  fs::create_directories(folder_, ignored);
  Tidy(folder_, max_bytes);
}

std::shared_ptr<const RelitTemplateFolder> RelitTemplateFolder::Open(fs::path folder) {
  const Expected<std::string> build = ProgramId();
  if (!build) return nullptr;
  return std::make_shared<const RelitTemplateFolder>(std::move(folder),
                                                     fmt::format("{} {}", *build, cv::getVersionString()));
}

std::unique_ptr<const StoredRelitTemplates> RelitTemplateFolder::Of(std::string_view model_id) const {
  const std::string content = fmt::format("{} {}", build_, model_id);
  fs::path folder = folder_ / fmt::format("{:016x}", Checksum(std::as_bytes(std::span(content))));
  std::error_code ignored;
  fs::create_directory(folder, ignored);
  fs::last_write_time(folder, fs::file_time_type::clock::now(), ignored);
  return std::make_unique<const StoredRelitTemplates>(std::move(folder));
}

std::shared_ptr<const RelitTemplateFolder> OpenUsersRelitTemplates() {
  const auto folder_of = [](const char* variable) -> fs::path {
    const char* const value = std::getenv(variable);
    return value == nullptr || !fs::path(value).is_absolute() ? fs::path() : fs::path(value);
  };
  fs::path cache = folder_of("XDG_CACHE_HOME");
  if (const fs::path home = folder_of("HOME"); cache.empty() && !home.empty()) cache = home / ".cache";
  return cache.empty() ? nullptr : RelitTemplateFolder::Open(cache / "victorious/templates");
}

}  // namespace victorious
