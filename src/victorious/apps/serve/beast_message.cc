#include "victorious/apps/serve/beast_message.h"

#include <boost/beast/core/string.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/verb.hpp>
#include <fmt/format.h>

#include "victorious/apps/serve/api_error.h"

namespace victorious {

namespace http = boost::beast::http;

std::string HeaderText(const http::request_header<>& request, http::field field) {
  const auto value = request[field];
  return {value.data(), value.size()};
}

bool IsAmbiguous(const http::request_header<>& request) {
  const auto codings = request.count(http::field::transfer_encoding);
  const auto coding = request.find(http::field::transfer_encoding);
  const bool is_chunked = codings == 1 && boost::beast::iequals(coding->value(), "chunked");
  if (codings > 0 && (!is_chunked || request.count(http::field::content_length) > 0)) return true;
  return request.count(http::field::content_length) > 1 || request.count(http::field::host) > 1;
}

std::optional<HttpResponse> ResponseToUnread(const boost::system::error_code& error, std::size_t max_header_bytes,
                                             std::size_t max_body_bytes) {
  if (error == http::error::body_limit) {
    return ErrorResponse(413, "body_too_large", fmt::format("the body has more than {} bytes", max_body_bytes));
  }
  if (error == http::error::header_limit) {
    return ErrorResponse(431, "header_too_large", fmt::format("the header has more than {} bytes", max_header_bytes));
  }
  const bool is_of_http = error.category() == http::make_error_code(http::error::bad_method).category();
  if (!is_of_http || error == http::error::end_of_stream || error == http::error::partial_message) return std::nullopt;
  return ErrorResponse(400, "bad_request", "not an HTTP request: " + error.message());
}

HttpRequest FromBeast(const http::request_header<>& request) {
  HttpRequest plain;
  switch (request.method()) {
    case http::verb::get:
      plain.method = HttpMethod::kGet;
      break;
    case http::verb::head:
      plain.method = HttpMethod::kHead;
      break;
    case http::verb::put:
      plain.method = HttpMethod::kPut;
      break;
    case http::verb::post:
      plain.method = HttpMethod::kPost;
      break;
    case http::verb::delete_:
      plain.method = HttpMethod::kDelete;
      break;
    default:
      plain.method = HttpMethod::kOther;
  }
  plain.target = std::string(request.target().data(), request.target().size());
  plain.host = HeaderText(request, http::field::host);
  plain.origin = HeaderText(request, http::field::origin);
  const auto site = request["Sec-Fetch-Site"];
  plain.fetch_site = std::string(site.data(), site.size());
  plain.content_type = HeaderText(request, http::field::content_type);
  plain.range = HeaderText(request, http::field::range);
  plain.if_range = HeaderText(request, http::field::if_range);
  plain.if_none_match = HeaderText(request, http::field::if_none_match);
  plain.cookie = HeaderText(request, http::field::cookie);
  plain.authorization = HeaderText(request, http::field::authorization);
  return plain;
}

}  // namespace victorious
