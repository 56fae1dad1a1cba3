#include "victorious/apps/serve/file_response.h"

#include <cstdint>
#include <system_error>

#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/byte_range.h"
#include "victorious/apps/serve/static_files.h"

namespace victorious {

ApiExpected<HttpResponse> SendFile(const HttpRequest& request, const std::filesystem::path& path,
                                   const std::filesystem::path& name) {
  std::error_code error;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  const std::string etag = FileEtag(path);
  if (error || etag.empty()) return NotFound(name.filename().string() + ": cannot be read");
  return FileResponse(request, path, size, ContentTypeOf(name), etag);
}

ApiExpected<HttpResponse> SendMade(const HttpRequest& request, CopyFolder& copies, const std::string& name) {
  const auto use = copies.Take(name);
  if (!use) return NotFound("the file was removed to make room for others: ask for it again");
  VICTORIOUS_ASSIGN_OR_RETURN(HttpResponse response, SendFile(request, use->path, use->path));
  if (response.file) response.file->hold = use->hold;
  return response;
}

}  // namespace victorious
