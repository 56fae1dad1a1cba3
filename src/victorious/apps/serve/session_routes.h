// The routes of sessions and of the log of what was done. Thread-safe.
#pragma once

#include "victorious/apps/serve/access_control.h"
#include "victorious/apps/serve/route_table.h"

namespace victorious {

class SessionRoutes {
 public:
  explicit SessionRoutes(AccessControl& access) : access_(access) {}

  ApiExpected<HttpResponse> Get(const ApiCall& call);
  ApiExpected<HttpResponse> LogIn(const ApiCall& call);
  ApiExpected<HttpResponse> LogOut(const ApiCall& call);
  ApiExpected<HttpResponse> Audit(const ApiCall& call);

 private:
  AccessControl& access_;
};

}  // namespace victorious
