#include "victorious/object/mesh/cad_folder.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/text.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace fs = std::filesystem;
namespace {

// Percent-decoding (RFC 3986): "my%20tank.png" becomes "my tank.png".
std::string PercentDecoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char code = 0;
    const char* digits = text.data() + i + 1;
    const bool escaped =
        text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    decoded.push_back(escaped ? static_cast<char>(code) : text[i]);
    if (escaped) i += 2;
  }
  return decoded;
}

}  // namespace

CadFolder::CadFolder(std::span<const std::byte> bytes, std::string name, std::optional<fs::path> folder)
    : bytes_(bytes), name_(std::move(name)) {
  if (!folder) return;
  std::error_code error;
  fs::path canonical = fs::canonical(folder->empty() ? fs::path(".") : *folder, error);
  if (!error) folder_ = std::move(canonical);
}

CadFolder CadFolder::WithBytes(std::span<const std::byte> bytes) const {
  CadFolder other = *this;
  other.bytes_ = bytes;
  return other;
}

std::optional<fs::path> CadFolder::Inside(const fs::path& relative) const {
  std::error_code error;
  fs::path path = fs::canonical(*folder_ / relative, error);  // resolves links: the target must be in the folder
  if (error || !fs::is_regular_file(path, error)) return std::nullopt;
  const auto [folder_end, rest] = std::ranges::mismatch(*folder_, path);
  return folder_end == folder_->end() ? std::optional(std::move(path)) : std::nullopt;
}

std::optional<fs::path> CadFolder::InsideInAnyCase(const fs::path& relative) const {
  fs::path path;
  for (const fs::path& part : relative) {
    if (part == "." || part == "..") {
      path /= part;
      continue;
    }
    const std::string wanted = LowerCase(part.string());
    std::optional<fs::path> only;
    const auto entries = ListFolder(*folder_ / path);
    if (!entries) return std::nullopt;
    for (const fs::path& entry : *entries) {
      if (LowerCase(entry.filename().string()) != wanted) continue;
      if (only) return std::nullopt;
      only = entry.filename();
    }
    if (!only) return std::nullopt;
    path /= *only;
  }
  return Inside(path);
}

std::optional<fs::path> CadFolder::Find(std::string_view name) const {
  if (!folder_) return std::nullopt;
  std::vector<fs::path> paths;
  for (std::string candidate : {std::string(name), PercentDecoded(name)}) {
    if (candidate.find('\0') != std::string::npos) continue;
    std::ranges::replace(candidate, '\\', '/');
    const fs::path path(candidate);
    paths.push_back(path);
    paths.push_back(path.filename());
  }
  for (const fs::path& path : paths) {
    if (auto found = Inside(path)) return found;
  }
  for (const fs::path& path : paths) {
    if (auto found = path.is_absolute() ? std::nullopt : InsideInAnyCase(path)) return found;
  }
  return std::nullopt;
}

Expected<std::string> CadFolder::Read(std::string_view name) const {
  if (name == name_) return std::string(text());
  const auto path = Find(name);
  if (!path) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such file in the CAD file's folder", name));
  return ReadFile(*path, kMaxCadBytes);
}

}  // namespace victorious
