// An entry of the log of who did what. An entry is written in the transaction of the change that it tells of, so that
// neither is kept without the other.
#pragma once

#include <cstdint>
#include <string>

namespace victorious {

struct AuditRecord {
  std::int64_t id = 0;
  std::int64_t time_utc_us = 0;  ///< microseconds since 1970
  std::string actor;             ///< the account; without accounts the name that a reviewer gave; empty: none
  std::string action;            ///< docs/formats/index.md lists them
  std::string subject;           ///< what it was done to
  std::string detail;            ///< JSON, or empty
};

}  // namespace victorious
