// kernels/, FindNearestK (nearest.h) on a CUDA device, for the queries of many templates at once. Exhaustive and exact:
// the same bits as the reference.
//
// nearest_cuda.cu is the implementation, in builds with VICTORIOUS_CUDA; nearest_no_cuda.cc stands in for it in others.
// C++20, no CUDA types: callers are compiled without it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

/// Descriptors in a device's memory, which must outlive them. Freed with the object.
class DeviceSet {
 public:
  virtual ~DeviceSet() = default;
};

/// The same of queries.
class DeviceQueries {
 public:
  virtual ~DeviceQueries() = default;
};

/// A device that computes distances. Thread-safe: calls of several threads overlap on it.
///
/// A call that fails (the device was lost, its memory is full, more than 2^24 descriptors) returns null or false: the
/// caller computes on the processor instead, with the same result.
class NearestDevice {
 public:
  virtual ~NearestDevice() = default;

  /// As in "NVIDIA H100 80GB HBM3".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Calls that failed, and why the last of them did.
  [[nodiscard]] virtual std::size_t failed_calls() const = 0;
  [[nodiscard]] virtual std::string last_error() const = 0;

  /// Null: failed.
  [[nodiscard]] virtual std::unique_ptr<const DeviceSet> Upload(const PackedDescriptors& set) = 0;
  /// Of several templates, one after the other. Null: failed.
  [[nodiscard]] virtual std::unique_ptr<const DeviceQueries> Upload(std::span<const PackedQueries> templates) = 0;

  /// FindNearestK for the queries of all templates, in their order: the k nearest of query i in out[k i] to
  /// out[k i + k - 1]. False: failed.
  /// @param queries  from Upload() of this device, as `set`
  /// @param out      k a query; empty: the results stay on the device, for a benchmark
  [[nodiscard]] virtual bool FindNearestK(const DeviceQueries& queries, const DeviceSet& set, std::size_t k,
                                          std::span<Neighbour> out) = 0;
};

/// The machine's first CUDA device of compute capability 8.0 or higher.
/// @param why_not  why there is none, if the result is null
[[nodiscard]] std::shared_ptr<NearestDevice> OpenNearestDevice(std::string& why_not);

}  // namespace victorious::kernels
