// How many of something there may be at once, of one account and of all: uploads, open jobs.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

/// Whose each one is stays in memory: those of an earlier process count among all only. Not thread-safe.
class AccountQuota {
 public:
  struct Limits {
    std::size_t in_all = 0;
    std::size_t an_account = 0;
  };

  /// @param what  several of them, for messages
  AccountQuota(std::string_view what, Limits limits) : what_(what), limits_(limits) {}

  /// Fails with kConflict if there may be no further one of the account.
  /// @param present  the ids of all that there are; the others are forgotten
  /// @param account  empty: nobody in particular, who has no limit of an own
  [[nodiscard]] Status Check(const std::set<std::string>& present, const std::string& account);
  void Add(const std::string& id, const std::string& account) { owners_[id] = account; }

 private:
  std::string what_;
  Limits limits_;
  std::map<std::string, std::string> owners_;  ///< by id
};

}  // namespace victorious
