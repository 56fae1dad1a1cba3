// The API of `victorious serve`: from a request to its response. api/openapi.json describes the routes, api_routes.h
// has the one table of them. No network here: http_server.h calls Begin from several threads.
#pragma once

#include <chrono>
#include <expected>
#include <memory>
#include <span>

#include "victorious/apps/serve/api_options.h"
#include "victorious/apps/serve/http_message.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

/// Thread-safe.
class Api {
 public:
  /// @param cancel  ends long reading of videos; must outlive the Api
  /// Errors: those of IndexView::Open and AccessControl::Open; kInvalidArgument for telemetry with several videos;
  /// kNotFound for a models folder that is not there, or without victorious-decoder.
  [[nodiscard]] static Expected<std::unique_ptr<Api>> Open(ApiOptions options, const CancelToken& cancel);
  ~Api();

  [[nodiscard]] std::span<const ApiRoute> routes() const;

  /// @param port  of the server: the Host header must name it
  [[nodiscard]] HttpResponse Handle(const HttpRequest& request, int port);

  /// The same, but of a route that is slow a SlowResponse, once the request is admitted.
  [[nodiscard]] HttpResponse Begin(const HttpRequest& request, int port);

  /// Where the body of an upload goes, or the response that refuses it.
  [[nodiscard]] std::expected<UploadPlan, HttpResponse> PlanUpload(const HttpRequest& request, int port);

 private:
  /// What the routes share, and the routes.
  struct Parts;

  Api(std::unique_ptr<Parts> parts, const CancelToken& cancel);

  /// A request that may be answered.
  struct Admitted {
    RequestTarget target;
    RouteTable::Match match;  ///< without a route: for a file of the page
    Caller caller;
  };
  /// Refuses what comes from elsewhere, what has no route, and whom its role does not admit.
  [[nodiscard]] std::expected<Admitted, HttpResponse> Admit(const HttpRequest& request, int port);
  /// A refusal, counted.
  [[nodiscard]] HttpResponse Refused(const HttpRequest& request, HttpResponse refusal,
                                     std::chrono::steady_clock::time_point begun);
  /// What Make makes, counted.
  [[nodiscard]] HttpResponse Answer(const HttpRequest& request, const Admitted& admitted, int port,
                                    const CancelToken& cancel, std::chrono::steady_clock::time_point begun);
  /// The response, once it is in the log of reads; if it cannot be written there, status 503.
  [[nodiscard]] HttpResponse Logged(const HttpRequest& request, const Admitted& admitted, HttpResponse response);
  [[nodiscard]] HttpResponse Make(const HttpRequest& request, const Admitted& admitted, int port,
                                  const CancelToken& cancel);
  ApiExpected<HttpResponse> AskHandler(const HttpRequest& request, const Admitted& admitted, int port,
                                       const CancelToken& cancel);

  const CancelToken& cancel_;
  std::unique_ptr<Parts> parts_;
};

}  // namespace victorious
