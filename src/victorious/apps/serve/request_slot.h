// The right to do costly work for a request, of which there are few at once.
#pragma once

#include <chrono>
#include <semaphore>

namespace victorious {

class RequestSlot {
 public:
  /// Waits for those before it for kMaxWait at most: each waits on one of the few threads that answer slow requests.
  explicit RequestSlot(std::counting_semaphore<>& free) : free_(free), is_taken_(free.try_acquire_for(kMaxWait)) {}
  RequestSlot(const RequestSlot&) = delete;
  RequestSlot& operator=(const RequestSlot&) = delete;
  ~RequestSlot() {
    if (is_taken_) free_.release();
  }
  [[nodiscard]] bool is_taken() const { return is_taken_; }

 private:
  static constexpr std::chrono::seconds kMaxWait{2};

  std::counting_semaphore<>& free_;
  bool is_taken_;
};

}  // namespace victorious
