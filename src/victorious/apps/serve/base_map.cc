#include "victorious/apps/serve/base_map.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/absolute_path.h"

namespace victorious {
namespace {

// The header of a PMTiles file, version 3: https://github.com/protomaps/PMTiles/blob/main/spec/v3/spec.md
constexpr std::size_t kHeaderBytes = 127;
constexpr std::string_view kMagic = "PMTiles\x03";
constexpr std::size_t kTileTypeAt = 99;
constexpr std::size_t kMaxZoomAt = 101;
constexpr int kVectorTiles = 1;
constexpr int kLastImageType = 4;  // 2 PNG, 3 JPEG, 4 WebP

Expected<BaseMap> ReadUrl(const std::string& url, std::size_t scheme_length, const std::string& attribution) {
  const auto fail = [&](std::string_view why) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--tiles \"{}\": {}, as in https://tile.example.org/{{z}}/{{x}}/{{y}}.png", url, why));
  };
  const auto is_allowed = [](char c) {
    return c > ' ' && c < 0x7f && std::string_view("\"'<>\\^`|").find(c) == std::string_view::npos;
  };
  if (!std::ranges::all_of(url, is_allowed)) return fail("an address has no spaces, quotes or letters beyond ASCII");
  for (const std::string_view name : {"{z}", "{x}", "{y}"}) {
    const std::size_t at = url.find(name);
    if (at == std::string::npos || url.find(name, at + 1) != std::string::npos) {
      return fail(fmt::format("must have {} once", name));
    }
  }
  if (std::ranges::count(url, '{') != 3 || std::ranges::count(url, '}') != 3) {
    return fail("no other part in braces is known");
  }
  const std::size_t end = url.find_first_of("/?#", scheme_length);
  const std::string host = url.substr(scheme_length, std::min(end, url.size()) - scheme_length);
  // What goes into the content security policy.
  const auto is_of_host = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view(".-:[]").find(c) != std::string_view::npos;
  };
  if (host.empty() || !std::ranges::all_of(host, is_of_host))
    return fail("must name a host, without name and password");
  return BaseMap{.url = url,
                 .origin = url.substr(0, scheme_length) + host,
                 .file = {},
                 .attribution = attribution.empty() ? "Map: " + host : attribution};
}

Expected<BaseMap> ReadFile(const std::filesystem::path& path, const std::string& attribution) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::unexpected(ErrorFromErrno(errno, path.string()));
  std::array<char, kHeaderBytes> header{};
  file.read(header.data(), header.size());
  const std::string_view bytes(header.data(), static_cast<std::size_t>(file.gcount()));
  if (bytes.size() != kHeaderBytes || !bytes.starts_with(kMagic)) {
    return Fail(ErrorCode::kUnsupported,
                path.string() +
                    ": no PMTiles file of version 3: give one, or the address of a tile server with {z}, {x} "
                    "and {y}");
  }
  const int type = static_cast<unsigned char>(bytes[kTileTypeAt]);
  if (type < kVectorTiles || type > kLastImageType) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: has tiles of type {}: vectors, PNG, JPEG and WebP can be shown", path.string(), type));
  }
  return BaseMap{.url = {},
                 .origin = {},
                 .file = AbsolutePath(path),
                 .is_vector = type == kVectorTiles,
                 .max_zoom = static_cast<unsigned char>(bytes[kMaxZoomAt]),
                 .attribution = attribution};
}

}  // namespace

Expected<BaseMap> ReadBaseMap(const std::string& argument, const std::string& attribution) {
  for (const std::string_view scheme : {"https://", "http://"}) {
    if (argument.starts_with(scheme)) return ReadUrl(argument, scheme.size(), attribution);
  }
  if (argument.find("://") != std::string::npos) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--tiles \"{}\": must be an address with http or https, or a PMTiles file", argument));
  }
  std::error_code error;
  if (std::filesystem::is_directory(argument, error)) {
    return Fail(ErrorCode::kInvalidArgument, argument + ": a folder: --tiles takes a PMTiles file");
  }
  return ReadFile(argument, attribution);
}

}  // namespace victorious
