// The Range header of a request (RFC 9110, section 14): which bytes of a file to send. One range; a request for
// several gets the whole file, as the RFC allows.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

enum class RangeKind {
  kWhole,          ///< no range, one of another unit, several, or malformed: send everything (200)
  kPart,           ///< send `first` to `last` (206)
  kUnsatisfiable,  ///< beyond the end (416)
};

struct ByteRange {
  RangeKind kind = RangeKind::kWhole;
  std::int64_t first = 0;  ///< of kPart
  std::int64_t last = 0;   ///< of kPart, inclusive, < size
};

/// Accepts any bytes: "bytes=0-99", "bytes=100-" and "bytes=-100".
[[nodiscard]] ByteRange ParseByteRange(std::string_view header, std::int64_t size);

/// The response to a request for a file: 200, 206, 304 (If-None-Match), 416.
/// @param etag  with its quotes; a range applies only if If-Range is absent or equals it
[[nodiscard]] HttpResponse FileResponse(const HttpRequest& request, const std::filesystem::path& path,
                                        std::int64_t size, const std::string& content_type, const std::string& etag);

/// True if If-None-Match names this entity.
[[nodiscard]] bool MatchesEtag(std::string_view if_none_match, std::string_view etag);

}  // namespace victorious
