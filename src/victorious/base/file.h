// Files as the rest of the program wants them: read whole with a bound, written so that nothing half-written is ever
// left under a final name, mapped read-only, and fingerprinted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

/// The whole file as bytes. Files larger than `max_bytes`, folders and pipes are refused (kInvalidArgument).
Expected<std::string> ReadFile(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{1} << 30);

/// Writes `bytes` under a temporary name beside `path`, syncs it to disk, and renames it to `path`: a reader sees the
/// old file or the new one, whole. Links stay: what they lead to is replaced. What is there and no regular file (a
/// device, a pipe) is written to. Fails with kNoSpace on a full disk, kPermissionDenied on a read-only folder.
Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

/// A read-only view of a file's bytes, paged in as they are touched. Shared by everything that points into it.
class MappedFile {
 public:
  static Expected<std::shared_ptr<const MappedFile>> Open(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  MappedFile(const std::byte* data, std::size_t size) : data_(data), size_(size) {}

  const std::byte* data_;
  std::size_t size_;
};

/// XXH3, 64 bits: fast, not cryptographic; finds damage, not malice.
[[nodiscard]] std::uint64_t Checksum(std::span<const std::byte> bytes);

/// Told now and then while contents are read: bytes so far, and bytes in all.
using ByteProgress = std::function<void(std::int64_t done, std::int64_t total)>;

/// The content of a file as 32 hexadecimal digits (XXH3, 128 bits). Reads everything once, which takes minutes for
/// hours of video on a slow disk. Errors: those of reading; kCancelled.
Expected<std::string> ContentId(const std::filesystem::path& file, const CancelToken& cancel = CancelToken(),
                                const ByteProgress& progress = {});

/// The contents of several files, in this order, with their names (not their folders').
Expected<std::string> ContentIdOfFiles(std::span<const std::filesystem::path> files,
                                       const CancelToken& cancel = CancelToken(), const ByteProgress& progress = {});

}  // namespace victorious
