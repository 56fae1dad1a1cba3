// kernels/, FindNearestK (nearest.h) on a CUDA device, for the queries of many templates at once. Exhaustive and exact:
// the same bits as the reference.
//
// nearest_device.cu is the implementation, in builds with VICTORIOUS_CUDA; nearest_device_none.cc stands in for it in
// others. C++20, no CUDA types: callers are compiled without it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

/// Descriptors, or queries, in a device's memory. Freed with the object, which must not outlive the device.
class DeviceMemory {
 public:
  virtual ~DeviceMemory() = default;
};

/// A device that computes distances. Thread-safe: calls of several threads overlap on it.
///
/// A call that fails (the device was lost, its memory is full) returns null or false and leaves the reason in
/// last_error(): the caller computes on the processor instead, with the same result.
class NearestDevice {
 public:
  virtual ~NearestDevice() = default;

  /// As in "NVIDIA H100 80GB HBM3".
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::string last_error() const = 0;

  /// Null: failed.
  [[nodiscard]] virtual std::unique_ptr<const DeviceMemory> Upload(const PackedDescriptors& set) = 0;
  /// Of several templates, one after the other. Null: failed.
  [[nodiscard]] virtual std::unique_ptr<const DeviceMemory> Upload(std::span<const PackedQueries> templates) = 0;

  /// FindNearestK for the queries of all templates, in their order: the k nearest of query i in out[k i] to
  /// out[k i + k - 1]. False: failed.
  /// @param queries  from Upload() of this device, as `set`
  /// @param out      k a query; empty: the results stay on the device, for a benchmark
  [[nodiscard]] virtual bool FindNearestK(const DeviceMemory& queries, const DeviceMemory& set, std::size_t k,
                                          std::span<Neighbour> out) = 0;
};

/// The machine's first CUDA device of compute capability 8.0 or higher.
/// @param why_not  why there is none, if the result is null
[[nodiscard]] std::shared_ptr<NearestDevice> OpenNearestDevice(std::string& why_not);

}  // namespace victorious::kernels
