// The route of workers: what those do that share the videos of an index in a database. Thread-safe.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "victorious/apps/cluster/cluster_status.h"
#include "victorious/apps/serve/route_table.h"

namespace victorious {

class ClusterRoutes {
 public:
  /// @param index  by the name that OpenStore takes
  explicit ClusterRoutes(std::string index) : index_(std::move(index)) {}

  ApiExpected<HttpResponse> List(const ApiCall& call);

  /// What they do; std::nullopt: the index is a file, which has none. Errors: those of ClusterReader.
  [[nodiscard]] Expected<std::optional<ClusterStatus>> Status();

 private:
  [[nodiscard]] Expected<ClusterStatus> Read();  ///< needs the mutex

  std::string index_;
  std::mutex mutex_;
  std::unique_ptr<ClusterReader> cluster_;  ///< opened by the first request for it
  std::string body_;                        ///< of the last answer, for those who ask at once
  std::chrono::steady_clock::time_point read_;
};

}  // namespace victorious
