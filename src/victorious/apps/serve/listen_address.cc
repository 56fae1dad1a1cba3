#include <algorithm>
#include <charconv>
#include <string_view>

#include <boost/asio/ip/address.hpp>
#include <fmt/format.h>

#include "victorious/apps/serve/http_server.h"

namespace victorious {

Expected<HttpServerOptions> ParseListenAddress(const std::string& text) {
  HttpServerOptions options;
  const std::size_t colon = text.rfind(':');
  std::string address = text.substr(0, std::min(colon, text.size()));
  if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  }
  const std::string_view port =
      colon == std::string::npos ? std::string_view() : std::string_view(text).substr(colon + 1);
  const auto [end, port_error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
  const bool is_port =
      port_error == std::errc() && end == port.data() + port.size() && options.port >= 0 && options.port <= 65535;
  if (address == "localhost") address = "127.0.0.1";
  boost::system::error_code error;
  const auto ip = boost::asio::ip::make_address(address, error);
  if (!is_port || error) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--listen \"{}\": must be an address and a port, "
                                                         "as in 127.0.0.1:8080",
                                                         text));
  }
  options.is_loopback = ip.is_loopback();
  options.address = ip.to_string();
  return options;
}

}  // namespace victorious
