// serve/, from the messages of Boost.Beast to those of http_message.h.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <boost/beast/http/field.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/system/error_code.hpp>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

/// The value of a header; empty if it was not sent.
[[nodiscard]] std::string HeaderText(const boost::beast::http::request_header<>& request,
                                     boost::beast::http::field field);

/// True if two readers of the request may see its end, or its server, elsewhere: another transfer coding than `chunked`
/// alone, one beside a length (RFC 9112, 6.1), or two headers Host (3.2). A proxy before the server could be smuggled
/// past.
[[nodiscard]] bool IsAmbiguous(const boost::beast::http::request_header<>& request);

/// The answer to a request that could not be read; std::nullopt: none, as nobody waits for one.
/// @param max_header_bytes, max_body_bytes  that it may have had
[[nodiscard]] std::optional<HttpResponse> ResponseToUnread(const boost::system::error_code& error,
                                                           std::size_t max_header_bytes, std::size_t max_body_bytes);

/// All but the body, the client and the upload.
[[nodiscard]] HttpRequest FromBeast(const boost::beast::http::request_header<>& request);

}  // namespace victorious
