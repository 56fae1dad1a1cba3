// A file descriptor that closes itself.
#pragma once

#include <utility>

#include <unistd.h>

namespace victorious {

/// Owns an open descriptor; a negative one stands for none.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() { Close(); }
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&&) = delete;

  [[nodiscard]] int fd() const { return fd_; }

  /// The result of close(2); 0 if there is none.
  int Close() {
    if (fd_ < 0) return 0;
    return ::close(std::exchange(fd_, -1));
  }

 private:
  int fd_;
};

}  // namespace victorious
