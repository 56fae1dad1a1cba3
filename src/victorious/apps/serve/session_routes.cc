#include "victorious/apps/serve/session_routes.h"

#include <cstdint>

#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/base/json.h"

namespace victorious {

ApiExpected<HttpResponse> SessionRoutes::Get(const ApiCall& call) { return access_.Session(call.caller); }

ApiExpected<HttpResponse> SessionRoutes::LogIn(const ApiCall& call) { return access_.LogIn(call.request, call.port); }

ApiExpected<HttpResponse> SessionRoutes::LogOut(const ApiCall& call) { return access_.LogOut(call.caller, call.port); }

ApiExpected<HttpResponse> SessionRoutes::Audit(const ApiCall& call) {
  constexpr std::int64_t kDefaultLimit = 100;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto limit, call.query.Integer("limit", 1, 1000));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto before, call.query.Integer("before", 1, INT64_MAX));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto records, access_.Audit(limit.value_or(kDefaultLimit), before));
  return JsonResponse(AuditToJson(records));
}

}  // namespace victorious
