// serve/, from the messages of Boost.Beast to those of http_message.h.
#pragma once

#include <string>

#include <boost/beast/http/field.hpp>
#include <boost/beast/http/message.hpp>

#include "victorious/serve/http_message.h"

namespace victorious {

/// The value of a header; empty if it was not sent.
[[nodiscard]] std::string HeaderText(const boost::beast::http::request_header<>& request,
                                     boost::beast::http::field field);

/// All but the body, the client and the upload.
[[nodiscard]] HttpRequest FromBeast(const boost::beast::http::request_header<>& request);

}  // namespace victorious
