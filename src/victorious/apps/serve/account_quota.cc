#include "victorious/apps/serve/account_quota.h"

#include <algorithm>

#include <fmt/format.h>

namespace victorious {

Status AccountQuota::Check(const std::set<std::string>& present, const std::string& account) {
  std::erase_if(owners_, [&](const auto& owner) { return !present.contains(owner.first); });
  if (present.size() >= limits_.in_all) {
    return Fail(ErrorCode::kConflict, fmt::format("there are {} {} already, as many as this server takes: wait, or "
                                                  "remove some",
                                                  present.size(), what_));
  }
  const auto own = static_cast<std::size_t>(
      std::ranges::count_if(owners_, [&](const auto& owner) { return owner.second == account; }));
  if (account.empty() || own < limits_.an_account) return {};
  return Fail(ErrorCode::kConflict,
              fmt::format("the account {} has {} {} already, as many as one account may have: wait, or remove some",
                          account, own, what_));
}

}  // namespace victorious
