// A part of a file that is being sent.
#pragma once

#include <cstdint>
#include <vector>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

/// Closes the file when it is destroyed.
class OpenFile {
 public:
  explicit OpenFile(const FileSlice& slice);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] std::int64_t left() const { return left_; }  ///< bytes

  /// Reads the next chunk. Returns false if the file ended early or cannot be
  /// read.
  bool ReadChunk(std::vector<char>& chunk);

 private:
  std::shared_ptr<const void> hold_;
  int descriptor_;
  std::int64_t offset_;
  std::int64_t left_;
};

}  // namespace victorious
