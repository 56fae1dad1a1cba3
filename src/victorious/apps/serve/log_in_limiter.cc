#include "victorious/apps/serve/log_in_limiter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "victorious/apps/serve/connection_count.h"
#include "victorious/base/text.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxBuckets = 10'000;

struct Limit {
  double tokens;    // when full
  double refill_s;  // for one token
};
constexpr Limit kClientLimit{.tokens = 20, .refill_s = 10};
constexpr Limit kNameLimit{.tokens = 100, .refill_s = 6};
constexpr Limit kClientAndNameLimit{.tokens = 10, .refill_s = 60};

struct Key {
  std::string key;
  Limit limit;
};

// The first character of a key tells its limit.
std::array<Key, 3> KeysOf(const std::string& client, const std::string& name) {
  const std::string folded = LowerCase(name);
  const std::string network = ClientNetwork(client);
  return {Key{"c" + network, kClientLimit}, Key{"n" + folded, kNameLimit},
          Key{"b" + network + " " + folded, kClientAndNameLimit}};
}

Limit LimitOf(const std::string& key) {
  return key.front() == 'c' ? kClientLimit : key.front() == 'n' ? kNameLimit : kClientAndNameLimit;
}

double Refilled(double tokens, const Limit& limit, std::int64_t passed_us) {
  return std::min(limit.tokens, tokens + 1e-6 * static_cast<double>(passed_us) / limit.refill_s);
}

}  // namespace

std::optional<std::int64_t> LogInLimiter::Take(const std::string& client, const std::string& name,
                                               std::int64_t now_us) {
  const std::scoped_lock lock(mutex_);
  if (buckets_.size() > kMaxBuckets) ForgetFullBuckets(now_us);
  // More clients and names than are kept: an attack from everywhere. Nobody is let in unlimited.
  if (buckets_.size() > kMaxBuckets) return 60;
  const std::array<Key, 3> keys = KeysOf(client, name);
  double wait_s = 0;
  for (const Key& key : keys) {
    const auto [found, is_new] = buckets_.try_emplace(key.key, Bucket{key.limit.tokens, now_us});
    Bucket& bucket = found->second;
    bucket.tokens = Refilled(bucket.tokens, key.limit, now_us - bucket.at_us);
    bucket.at_us = now_us;
    if (bucket.tokens < 1) wait_s = std::max(wait_s, (1 - bucket.tokens) * key.limit.refill_s);
  }
  if (wait_s > 0) return static_cast<std::int64_t>(std::ceil(wait_s));
  for (const Key& key : keys) buckets_[key.key].tokens -= 1;
  return std::nullopt;
}

void LogInLimiter::PutBack(const std::string& client, const std::string& name) {
  const std::scoped_lock lock(mutex_);
  for (const Key& key : KeysOf(client, name)) {
    if (const auto found = buckets_.find(key.key); found != buckets_.end()) {
      found->second.tokens = std::min(key.limit.tokens, found->second.tokens + 1);
    }
  }
}

void LogInLimiter::ForgetFullBuckets(std::int64_t now_us) {
  std::erase_if(buckets_, [&](const auto& entry) {
    const Limit limit = LimitOf(entry.first);
    return Refilled(entry.second.tokens, limit, now_us - entry.second.at_us) >= limit.tokens;
  });
}

}  // namespace victorious
