#include "victorious/apps/serve/static_files.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/byte_range.h"
#include "victorious/base/text.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, std::string_view>, 21> kContentTypes = {{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".txt", "text/plain; charset=utf-8"},
    {".mp4", "video/mp4"},
    {".m4v", "video/mp4"},
    {".mov", "video/mp4"},
    {".webm", "video/webm"},
    {".mkv", "video/x-matroska"},
    {".ts", "video/mp2t"},
    {".m2ts", "video/mp2t"},
    {".avi", "video/x-msvideo"},
    {".mpg", "video/mpeg"},
    {".mpeg", "video/mpeg"},
    {".ogv", "video/ogg"},
}};

constexpr std::string_view kNotBuilt =
    "<!doctype html><meta charset=utf-8><title>VICTORIOUS</title><body style='font:16px system-ui;margin:3rem'>"
    "<h1>The page is not built</h1><p>The API is at <a href=/api/v1/project>/api/v1/project</a>. <code>make "
    "build</code> "
    "builds the page; <code>victorious serve --web FOLDER</code> names its folder.</p>";

}  // namespace

std::string ContentTypeOf(const fs::path& name) {
  const std::string extension = LowerCase(name.extension().string());
  const auto* const found =
      std::ranges::find(kContentTypes, extension, &std::pair<std::string_view, std::string_view>::first);
  return std::string(found == kContentTypes.end() ? "application/octet-stream" : found->second);
}

std::string FileEtag(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error) return "";
  const auto changed = fs::last_write_time(file, error).time_since_epoch().count();
  return error ? "" : fmt::format("\"{:x}-{:x}\"", size, changed);
}

StaticFiles::StaticFiles(fs::path folder) {
  std::error_code error;
  if (folder.empty() || !fs::is_regular_file(folder / "index.html", error)) return;
  folder_ = fs::canonical(folder, error);
}

HttpResponse StaticFiles::Get(const HttpRequest& request, const std::vector<std::string>& segments) const {
  if (folder_.empty() && segments.empty()) {
    return {.content_type = ContentTypeOf("index.html"), .headers = {}, .body = std::string(kNotBuilt), .file = {}};
  }
  const auto not_found = [] { return ErrorResponse(404, "not_found", "there is no such page"); };
  if (folder_.empty()) return not_found();
  fs::path path = folder_;
  for (const std::string& segment : segments) path /= segment;
  if (segments.empty()) path /= "index.html";
  std::error_code error;
  path = fs::canonical(path, error);
  if (error || !fs::is_regular_file(path, error)) return not_found();
  const auto [folder_end, path_at] = std::ranges::mismatch(folder_, path);
  if (folder_end != folder_.end()) return not_found();
  const auto size = static_cast<std::int64_t>(fs::file_size(path, error));
  if (error) return not_found();
  HttpResponse response = FileResponse(request, path, size, ContentTypeOf(path), FileEtag(path));
  // Vite names the files of assets/ by their content.
  if (!segments.empty() && segments.front() == "assets") {
    for (auto& [name, value] : response.headers) {
      if (name == "Cache-Control") value = "public, max-age=31536000, immutable";
    }
  }
  return response;
}

}  // namespace victorious
