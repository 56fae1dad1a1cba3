// Runs networks by OpenCV's dnn, in an isolated process (base/isolated_process.h): what reads a hostile file, and what
// computes with its weights, has no rights, and its memory and time are limited.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

class NetworkRunner {
 public:
  NetworkRunner();
  ~NetworkRunner();
  NetworkRunner(const NetworkRunner&) = delete;
  NetworkRunner& operator=(const NetworkRunner&) = delete;

  /// Answers one request (network_request.h). Errors: kUnsupported for a network that OpenCV does not read or run, with
  /// its reason; kDataLoss for a file that is none. May throw std::bad_alloc.
  [[nodiscard]] Expected<std::string> Answer(std::string_view request);

 private:
  struct Loaded;

  std::unique_ptr<Loaded> loaded_;
};

}  // namespace victorious
