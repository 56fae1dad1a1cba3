// A device (kernels/nearest_device.h) for tests without one: computes on the processor, by the reference.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/kernels/nearest_device.h"

namespace victorious::testing {

/// Not thread-safe.
class ProcessorDevice : public kernels::NearestDevice {
 public:
  /// @param works  false: each call fails
  explicit ProcessorDevice(bool works = true) : works_(works) {}

  [[nodiscard]] std::string_view name() const override { return "processor"; }
  [[nodiscard]] std::string last_error() const override { return works_ ? "" : "out of order"; }

  /// Queries that were searched.
  [[nodiscard]] std::size_t query_count() const { return query_count_; }

  [[nodiscard]] std::unique_ptr<const kernels::DeviceMemory> Upload(const kernels::PackedDescriptors& set) override {
    if (!works_) return nullptr;
    auto memory = std::make_unique<Memory>();
    memory->set = set;
    return memory;
  }

  [[nodiscard]] std::unique_ptr<const kernels::DeviceMemory> Upload(
      std::span<const kernels::PackedQueries> templates) override {
    if (!works_) return nullptr;
    auto memory = std::make_unique<Memory>();
    memory->templates.assign(templates.begin(), templates.end());
    return memory;
  }

  [[nodiscard]] bool FindNearestK(const kernels::DeviceMemory& queries, const kernels::DeviceMemory& set, std::size_t k,
                                  std::span<kernels::Neighbour> out) override {
    std::size_t first = 0;
    for (const kernels::PackedQueries& one : static_cast<const Memory&>(queries).templates) {
      kernels::FindNearestKRef(one, static_cast<const Memory&>(set).set, k, out.subspan(first * k, one.count * k));
      first += one.count;
    }
    query_count_ += first;
    return works_;
  }

 private:
  struct Memory : kernels::DeviceMemory {
    kernels::PackedDescriptors set;
    std::vector<kernels::PackedQueries> templates;
  };

  bool works_;
  std::size_t query_count_ = 0;
};

}  // namespace victorious::testing
