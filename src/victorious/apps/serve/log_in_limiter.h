// How often a log-in may fail. Thread-safe.
//
// Token buckets: an attempt takes a token from the bucket of its client, of its account name, and of both together; a
// success puts them back. So one client guesses at most 1,440 passwords of an account a day, all clients together
// 14,400, and somebody who locks an account out from one client does so for that client.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace victorious {

class LogInLimiter {
 public:
  /// Takes the tokens of an attempt; all or none. Returns the seconds to wait, or std::nullopt if it may be tried.
  /// @param client  its IP address; IPv6 addresses of one /64 network are one client
  /// @param name    compared without regard to the case of ASCII letters
  /// @param now_us  microseconds of a steady clock
  [[nodiscard]] std::optional<std::int64_t> Take(const std::string& client, const std::string& name,
                                                 std::int64_t now_us);
  /// Puts the tokens of an attempt that succeeded back.
  void PutBack(const std::string& client, const std::string& name);

 private:
  struct Bucket {
    double tokens = 0;
    std::int64_t at_us = 0;  ///< when it had them
  };

  void ForgetFullBuckets(std::int64_t now_us);

  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;  ///< those that are not full
};

}  // namespace victorious
