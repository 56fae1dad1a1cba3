// A device (kernels/nearest_device.h) for tests without one: computes on the processor, by the reference.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/kernels/nearest_device.h"

namespace victorious::testing {

class ProcessorDevice : public kernels::NearestDevice {
 public:
  enum class Failing { kNothing, kSets, kQueries, kSearches };

  explicit ProcessorDevice(Failing failing = Failing::kNothing) : failing_(failing) {}

  [[nodiscard]] std::string_view name() const override { return "processor"; }
  [[nodiscard]] std::size_t failed_calls() const override { return failed_calls_; }
  [[nodiscard]] std::string last_error() const override { return failed_calls_ == 0 ? "" : "out of order"; }

  /// Queries that were searched.
  [[nodiscard]] std::size_t query_count() const { return query_count_; }

  [[nodiscard]] std::unique_ptr<const kernels::DeviceSet> Upload(const kernels::PackedDescriptors& set) override {
    if (Fails(Failing::kSets)) return nullptr;
    auto copy = std::make_unique<Set>();
    copy->descriptors = set;
    return copy;
  }

  [[nodiscard]] std::unique_ptr<const kernels::DeviceQueries> Upload(
      std::span<const kernels::PackedQueries> templates) override {
    if (Fails(Failing::kQueries)) return nullptr;
    auto copy = std::make_unique<Queries>();
    copy->templates.assign(templates.begin(), templates.end());
    return copy;
  }

  [[nodiscard]] bool FindNearestK(const kernels::DeviceQueries& queries, const kernels::DeviceSet& set, std::size_t k,
                                  std::span<kernels::Neighbour> out) override {
    if (Fails(Failing::kSearches)) return false;
    std::size_t first = 0;
    for (const kernels::PackedQueries& one : static_cast<const Queries&>(queries).templates) {
      kernels::FindNearestKRef(one, static_cast<const Set&>(set).descriptors, k, out.subspan(first * k, one.count * k));
      first += one.count;
    }
    query_count_ += first;
    return true;
  }

 private:
  struct Set : kernels::DeviceSet {
    kernels::PackedDescriptors descriptors;
  };
  struct Queries : kernels::DeviceQueries {
    std::vector<kernels::PackedQueries> templates;
  };

  bool Fails(Failing call) {
    if (failing_ == call) ++failed_calls_;
    return failing_ == call;
  }

  Failing failing_;
  std::atomic<std::size_t> failed_calls_ = 0;
  std::atomic<std::size_t> query_count_ = 0;
};

}  // namespace victorious::testing
