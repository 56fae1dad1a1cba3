// What a server has done and does, as numbers for Prometheus (text format 0.0.4). Input: each answered request.
// Output: counters since the start, by route; the addresses, names and contents of requests are in none.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

/// A value at the moment of asking: name, labels as in `{state="queued"}` or empty, number.
struct MetricSample {
  std::string name;
  std::string help;  ///< one line
  std::string labels = {};
  double value = 0;
};

/// `text` as the value of a label, in quotes.
[[nodiscard]] std::string MetricLabel(std::string_view text);

/// Thread-safe.
class ServerMetrics : public std::enable_shared_from_this<ServerMetrics> {
 public:
  /// Which requests are measured together: their answers take about as long.
  enum class Group {
    kQuick,     ///< read from the index
    kSlow,      ///< read from a video, with the time in the queue for it
    kPageFile,  ///< files of the page
    kRefused,   ///< without a route, a credential or the role for it
  };

  /// @param route  as the table has it, not as it was asked
  void Count(Group group, HttpMethod method, std::string_view route, int status, std::chrono::nanoseconds took);

  /// A slow answer from its admission until it is made or dropped.
  class Decoding {
   public:
    explicit Decoding(std::shared_ptr<ServerMetrics> metrics);
    ~Decoding();
    Decoding(const Decoding&) = delete;
    Decoding& operator=(const Decoding&) = delete;

    /// It waits no longer.
    void Start();

   private:
    std::shared_ptr<ServerMetrics> metrics_;
    bool is_running_ = false;
  };

  /// All counters, and then `samples`, of which those with one name follow each other.
  [[nodiscard]] std::string Text(const std::vector<MetricSample>& samples) const;

 private:
  static constexpr std::array<double, 12> kBounds_s = {0.001, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 10, 30};
  struct Histogram {
    std::array<std::int64_t, kBounds_s.size()> at_most{};
    std::int64_t count = 0;
    double sum_s = 0;
  };

  mutable std::mutex mutex_;
  std::map<std::tuple<std::string, HttpMethod, int>, std::int64_t> requests_;  ///< by route, method and status
  std::map<Group, Histogram> durations_;
  std::int64_t waiting_ = 0;
  std::int64_t running_ = 0;
};

}  // namespace victorious
