#include "victorious/render/cad_folder.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/render/load_mesh.h"

namespace victorious {
namespace fs = std::filesystem;

CadFolder::CadFolder(std::span<const std::byte> bytes, std::string name, std::optional<fs::path> folder)
    : bytes_(bytes), name_(std::move(name)) {
  if (!folder) return;
  std::error_code error;
  fs::path canonical = fs::canonical(folder->empty() ? fs::path(".") : *folder, error);
  if (!error) folder_ = std::move(canonical);
}

std::optional<fs::path> CadFolder::Inside(const fs::path& relative) const {
  std::error_code error;
  fs::path path = fs::canonical(*folder_ / relative, error);  // follows links: what counts is where the bytes lie
  if (error || !fs::is_regular_file(path, error)) return std::nullopt;
  const auto [folder_end, rest] = std::ranges::mismatch(*folder_, path);
  return folder_end == folder_->end() ? std::optional(std::move(path)) : std::nullopt;
}

std::optional<fs::path> CadFolder::Find(std::string_view name) const {
  if (!folder_ || name.empty() || name.find('\0') != std::string_view::npos) return std::nullopt;
  std::string slashed(name);
  std::ranges::replace(slashed, '\\', '/');
  const fs::path path(slashed);
  if (auto found = Inside(path)) return found;
  return path.has_filename() ? Inside(path.filename()) : std::nullopt;
}

Expected<std::string> CadFolder::Read(std::string_view name) const {
  if (name == name_) return std::string(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  const auto path = Find(name);
  if (!path) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such file in the CAD file's folder", name));
  return ReadFile(*path, kMaxCadBytes);
}

}  // namespace victorious
