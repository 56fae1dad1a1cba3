#include "victorious/apps/serve/open_file.h"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace victorious {
namespace {

constexpr std::int64_t kChunkBytes = std::int64_t{256} << 10;

}  // namespace

OpenFile::OpenFile(const FileSlice& slice)
    : hold_(slice.hold),
      descriptor_(::open(slice.path.c_str(), O_RDONLY | O_CLOEXEC)),
      offset_(slice.offset),
      left_(slice.length) {}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool OpenFile::ReadChunk(std::vector<char>& chunk) {
  chunk.resize(static_cast<std::size_t>(std::min(left_, kChunkBytes)));
  ssize_t got = 0;
  do {
    got = ::pread(descriptor_, chunk.data(), chunk.size(), offset_);
  } while (got < 0 && errno == EINTR);
  if (got <= 0) return false;
  chunk.resize(static_cast<std::size_t>(got));
  offset_ += got;
  left_ -= got;
  return true;
}

}  // namespace victorious
