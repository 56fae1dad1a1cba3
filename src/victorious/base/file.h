// File access: bounded reading of whole files, atomic writing (no partial file under the final name), read-only memory
// mapping, and content hashes.
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

/// Returns the whole file as bytes. Error: kInvalidArgument for files larger than `max_bytes`, folders and pipes.
[[nodiscard]] Expected<std::string> ReadFile(const std::filesystem::path& path,
                                             std::size_t max_bytes = std::size_t{1} << 30);

/// Writes `bytes` under a temporary name beside `path`, syncs it to disk, and renames it to `path`: a reader sees the
/// complete old file or the complete new one. Symbolic links are kept: their target is replaced. An existing path that
/// is not a regular file (a device, a pipe) is written directly. Errors: kNoSpace on a full disk, kPermissionDenied in
/// a read-only folder.
[[nodiscard]] Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
[[nodiscard]] Status WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

/// A read-only memory mapping of a file. Shared by all objects that point into it.
class MappedFile {
 public:
  [[nodiscard]] static Expected<std::shared_ptr<const MappedFile>> Open(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }

  /// Gives back the memory of the bytes read so far; they are read again when next needed. For after a pass over a file
  /// of which little is needed again. Without effect on the bytes.
  void ReleasePages() const;

 private:
  MappedFile(const std::byte* data, std::size_t size) : data_(data), size_(size) {}

  const std::byte* data_;
  std::size_t size_;
};

/// XXH3, 64 bits: fast, not cryptographic; detects damage, not manipulation.
[[nodiscard]] std::uint64_t Checksum(std::span<const std::byte> bytes);

/// Called repeatedly while contents are read, with the bytes read so far and the total.
using ByteProgress = std::function<void(std::int64_t done, std::int64_t total)>;

/// Returns the hash of a file's content as 32 hexadecimal digits (XXH3, 128 bits). Reads the whole file once, which
/// takes minutes for hours of video on a slow disk. Errors: those of reading; kCancelled.
[[nodiscard]] Expected<std::string> ContentId(const std::filesystem::path& file,
                                              const CancelToken& cancel = CancelToken(),
                                              const ByteProgress& progress = {});

/// The same for several files: hashes their contents in this order, with their names (without folders).
[[nodiscard]] Expected<std::string> ContentIdOfFiles(std::span<const std::filesystem::path> files,
                                                     const CancelToken& cancel = CancelToken(),
                                                     const ByteProgress& progress = {});

}  // namespace victorious
