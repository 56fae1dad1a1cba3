#include "victorious/base/file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <map>
#include <mutex>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "victorious/base/file_descriptor.h"
#include "victorious/base/file_writer.h"
#include "victorious/base/mapped_pages.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

struct RegularFile {
  FileDescriptor descriptor;
  std::size_t size;  // bytes
};

Expected<RegularFile> OpenRegularFile(const fs::path& path) {
  // Without O_NONBLOCK, opening a pipe would block until a writer opens it, before it can be rejected.
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat info{};
  if (file.fd() < 0 || ::fstat(file.fd(), &info) != 0) return std::unexpected(ErrorFromErrno(errno, path.string()));
  if (!S_ISREG(info.st_mode)) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not a regular file", path.string()));
  }
  return RegularFile{std::move(file), static_cast<std::size_t>(info.st_size)};
}

// Reads until `buffer` is full or the file ends. Returns the number of bytes read.
Expected<std::size_t> ReadInto(std::span<char> buffer, int fd, const fs::path& path) {
  std::size_t done = 0;
  while (done < buffer.size()) {
    const ssize_t count = ::read(fd, buffer.data() + done, buffer.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("read {}", path.string())));
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

// Hashes files one after the other, with progress and cancellation.
class Hasher {
 public:
  Hasher(const CancelToken& cancel, const ByteProgress& progress, std::int64_t total_bytes)
      : cancel_(cancel), progress_(progress), total_bytes_(total_bytes) {}

  Expected<XXH128_hash_t> Hash(const fs::path& path) {
    VICTORIOUS_ASSIGN_OR_RETURN(const RegularFile file, OpenRegularFile(path));
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    while (true) {
      if (cancel_.IsCancelled()) {
        return Fail(ErrorCode::kCancelled, fmt::format("{}: cancelled while computing the content id", path.string()));
      }
      VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t count, ReadInto(buffer_, file.descriptor.fd(), path));
      XXH3_128bits_update(&state, buffer_.data(), count);
      done_bytes_ += static_cast<std::int64_t>(count);
      if (progress_) progress_(done_bytes_, std::max(done_bytes_, total_bytes_));
      if (count < buffer_.size()) return XXH3_128bits_digest(&state);
    }
  }

 private:
  const CancelToken& cancel_;
  const ByteProgress& progress_;
  std::int64_t total_bytes_;
  std::int64_t done_bytes_ = 0;
  std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 20);
};

std::int64_t TotalBytes(std::span<const fs::path> files) {
  std::int64_t total = 0;
  for (const fs::path& file : files) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (!error) total += static_cast<std::int64_t>(size);
  }
  return total;
}

std::string IdText(const XXH128_hash_t& hash) { return fmt::format("{:016x}{:016x}", hash.high64, hash.low64); }

// The mapped files of this process. Only their pages may be given back: those of other memory would be lost.
class FileMappings {
 public:
  void Add(const std::byte* data, std::size_t size) {
    const std::scoped_lock lock(mutex_);
    sizes_[Address(data)] = size;
  }

  void Remove(const std::byte* data) {
    const std::scoped_lock lock(mutex_);
    sizes_.erase(Address(data));
  }

  void Release(std::span<const std::byte> bytes) {
    const std::scoped_lock lock(mutex_);  // also while the mapping is in use: it must not be removed
    auto mapping = sizes_.upper_bound(Address(bytes.data()));
    if (bytes.empty() || mapping == sizes_.begin()) return;
    --mapping;
    const auto& [begin, size] = *mapping;
    const std::uintptr_t end = Address(bytes.data()) + bytes.size();
    if (end > begin + size) return;
    const std::uintptr_t first = std::max(begin, Address(bytes.data()) / kMappedTogether * kMappedTogether);
    const std::uintptr_t last = std::min(begin + size, (end + kMappedTogether - 1) / kMappedTogether * kMappedTogether);
    // A failure leaves the pages where they are, which is harmless.
    static_cast<void>(::madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED));
  }

 private:
  // Linux maps the pages of so many bytes with the one that is read, if it has them in memory (fault_around_bytes).
  static constexpr std::uintptr_t kMappedTogether = 65536;

  static std::uintptr_t Address(const std::byte* byte) { return reinterpret_cast<std::uintptr_t>(byte); }

  std::mutex mutex_;
  std::map<std::uintptr_t, std::size_t> sizes_;  // by first address
};

FileMappings& Mappings() {
  static FileMappings* const mappings = new FileMappings;  // never destroyed: files may be unmapped at exit
  return *mappings;
}

}  // namespace

Expected<std::string> ReadFile(const fs::path& path, std::size_t max_bytes) {
  VICTORIOUS_ASSIGN_OR_RETURN(const RegularFile file, OpenRegularFile(path));
  if (file.size > max_bytes) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} bytes, above the limit of {}", path.string(), file.size, max_bytes));
  }
  std::string bytes(file.size, '\0');
  VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t count, ReadInto(bytes, file.descriptor.fd(), path));
  bytes.resize(count);
  return bytes;
}

Status WriteFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
  return WriteFileInParts(path, [&](std::ostream& out) -> Status {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return {};
  });
}

Status WriteFileAtomically(const fs::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text)));
}

Expected<std::shared_ptr<const MappedFile>> MappedFile::Open(const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const RegularFile file, OpenRegularFile(path));
  if (file.size == 0) return std::shared_ptr<const MappedFile>(new MappedFile(nullptr, 0));
  void* data = ::mmap(nullptr, file.size, PROT_READ, MAP_PRIVATE, file.descriptor.fd(), 0);
  if (data == MAP_FAILED) return std::unexpected(ErrorFromErrno(errno, fmt::format("map {}", path.string())));
  Mappings().Add(static_cast<const std::byte*>(data), file.size);
  return std::shared_ptr<const MappedFile>(new MappedFile(static_cast<const std::byte*>(data), file.size));
}

MappedFile::~MappedFile() {
  if (size_ > 0) Mappings().Remove(data_);
  if (size_ > 0) ::munmap(const_cast<std::byte*>(data_), size_);
}

void MappedFile::ReleasePages() const { ReleaseMappedPages(bytes()); }

void ReleaseMappedPages(std::span<const std::byte> bytes) { Mappings().Release(bytes); }

std::uint64_t Checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

Expected<std::string> ContentId(const fs::path& file, const CancelToken& cancel, const ByteProgress& progress) {
  Hasher hasher(cancel, progress, TotalBytes(std::span(&file, 1)));
  VICTORIOUS_ASSIGN_OR_RETURN(const XXH128_hash_t hash, hasher.Hash(file));
  return IdText(hash);
}

// Hashes each file's name and hash, so that moving bytes between names and contents changes the result.
Expected<std::string> ContentIdOfFiles(std::span<const fs::path> files, const CancelToken& cancel,
                                       const ByteProgress& progress) {
  Hasher hasher(cancel, progress, TotalBytes(files));
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  for (const fs::path& file : files) {
    VICTORIOUS_ASSIGN_OR_RETURN(const XXH128_hash_t hash, hasher.Hash(file));
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, hash);
    const std::string name = file.filename().string();
    XXH3_128bits_update(&state, name.c_str(), name.size() + 1);
    XXH3_128bits_update(&state, canonical.digest, sizeof(canonical.digest));
  }
  return IdText(XXH3_128bits_digest(&state));
}

}  // namespace victorious
