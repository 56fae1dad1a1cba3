#include "victorious/apps/serve/byte_range.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

namespace victorious {
namespace {

// Digits only: no sign, no spaces. Larger than 64 bits: the largest.
std::optional<std::int64_t> ParseDigits(std::string_view text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  std::int64_t value = INT64_MAX;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

ByteRange ParseByteRange(std::string_view header, std::int64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit)) return {};
  header.remove_prefix(kUnit.size());
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos || header.find(',') != std::string_view::npos) return {};
  const auto first = ParseDigits(header.substr(0, dash));
  const auto last = ParseDigits(header.substr(dash + 1));
  const bool is_suffix = dash == 0;
  const bool is_open = dash + 1 == header.size();
  if (is_suffix) {
    if (!last) return {};
    if (*last == 0 || size == 0) return {.kind = RangeKind::kUnsatisfiable};
    return {RangeKind::kPart, std::max<std::int64_t>(0, size - *last), size - 1};
  }
  if (!first || (!last && !is_open) || (last && *last < *first)) return {};
  if (*first >= size) return {.kind = RangeKind::kUnsatisfiable};
  return {RangeKind::kPart, *first, std::min(last.value_or(INT64_MAX), size - 1)};
}

bool MatchesEtag(std::string_view if_none_match, std::string_view etag) {
  return if_none_match == "*" || (!etag.empty() && if_none_match.find(etag) != std::string_view::npos);
}

HttpResponse FileResponse(const HttpRequest& request, const std::filesystem::path& path, std::int64_t size,
                          const std::string& content_type, const std::string& etag) {
  HttpResponse response{.content_type = content_type,
                        .headers = {{"Accept-Ranges", "bytes"}, {"ETag", etag}, {"Cache-Control", "no-cache"}},
                        .body = {},
                        .file = {}};
  if (MatchesEtag(request.if_none_match, etag)) {
    response.status = 304;
    response.content_type.clear();
    return response;
  }
  const bool is_current = request.if_range.empty() || request.if_range == etag;
  const ByteRange range = is_current ? ParseByteRange(request.range, size) : ByteRange{};
  switch (range.kind) {
    case RangeKind::kUnsatisfiable:
      response.status = 416;
      response.content_type.clear();
      response.headers.emplace_back("Content-Range", fmt::format("bytes */{}", size));
      return response;
    case RangeKind::kPart:
      response.status = 206;
      response.headers.emplace_back("Content-Range", fmt::format("bytes {}-{}/{}", range.first, range.last, size));
      response.file = FileSlice{.path = path, .offset = range.first, .length = range.last - range.first + 1};
      return response;
    case RangeKind::kWhole:
      response.file = FileSlice{.path = path, .offset = 0, .length = size};
      return response;
  }
  return response;
}

}  // namespace victorious
