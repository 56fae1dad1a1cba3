// Addresses and who may ask for them: the table that the API goes by before anything else. api_routes.cc fills it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "victorious/apps/serve/access_control.h"
#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/http_message.h"
#include "victorious/apps/serve/request_target.h"
#include "victorious/base/cancel.h"

namespace victorious {

/// A request, as the handler of its route gets it.
struct ApiCall {
  const HttpRequest& request;
  const std::vector<std::string>& parameters;  ///< the segments in the places of {…}, in their order
  QueryReader& query;                          ///< checked to be empty for a route without kHasQuery
  const Caller& caller;
  int port = 0;
  const CancelToken& cancel;  ///< ends what takes long
};
using ApiHandler = std::function<ApiExpected<HttpResponse>(const ApiCall& call)>;

/// What a request can be for. The role stands between address and handler, so that none can be left out.
struct ApiRoute {
  HttpMethod method;          ///< kGet answers HEAD, too
  std::string_view path;      ///< as in api/openapi.json; {…} stands for one segment
  std::optional<Role> least;  ///< that an account needs; std::nullopt: open to everybody
  ApiHandler handler;
  bool has_query = false;  ///< the handler reads parameters of the query, and refuses others
  bool is_slow = false;    ///< it reads a video, or a whole list: waits for its turn (SlowResponse)
  bool is_upload = false;  ///< the body goes to a file (UploadPlan)
  bool is_probe = false;   ///< nobody is asked who he is, so that it is answered without the store, too
};

class RouteTable {
 public:
  using Segments = std::span<const std::string>;

  explicit RouteTable(std::vector<ApiRoute> routes) : routes_(std::move(routes)) {}

  [[nodiscard]] std::span<const ApiRoute> routes() const { return routes_; }

  struct Match {
    const ApiRoute* route = nullptr;
    std::vector<std::string> parameters;
  };
  /// The first route that fits. kHead finds a route of kGet.
  [[nodiscard]] std::optional<Match> Find(HttpMethod method, Segments segments) const;

  /// The methods of an address, as the header Allow names them; empty: there is no such address.
  [[nodiscard]] std::string AllowedMethods(Segments segments) const;

 private:
  std::vector<ApiRoute> routes_;
};

}  // namespace victorious
