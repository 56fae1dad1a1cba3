#include "victorious/base/file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Closes the descriptor on every way out.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const { return fd_; }
  int Close() {
    if (fd_ < 0) return 0;
    return ::close(std::exchange(fd_, -1));
  }

 private:
  int fd_;
};

Expected<std::size_t> OpenRegularFile(const fs::path& path, Descriptor& file) {
  if (file.get() < 0) return std::unexpected(ErrorFromErrno(errno, path.string()));
  struct stat info{};
  if (::fstat(file.get(), &info) != 0) return std::unexpected(ErrorFromErrno(errno, path.string()));
  if (!S_ISREG(info.st_mode)) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not a regular file", path.string()));
  }
  return static_cast<std::size_t>(info.st_size);
}

Status HashFile(const fs::path& path, XXH3_state_t* state) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  VICTORIOUS_RETURN_IF_ERROR(OpenRegularFile(path, file));
  std::vector<char> buffer(std::size_t{1} << 20);
  while (true) {
    const ssize_t count = ::read(file.get(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("read {}", path.string())));
    if (count == 0) return {};
    XXH3_128bits_update(state, buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

Expected<std::string> ReadFile(const fs::path& path, std::size_t max_bytes) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t size, OpenRegularFile(path, file));
  if (size > max_bytes) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {} bytes, more than the {} that can be read", path.string(), size, max_bytes));
  }
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = ::read(file.get(), bytes.data() + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("read {}", path.string())));
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

Status WriteFileAtomically(const fs::path& path, std::span<const std::byte> bytes) {
  static std::atomic<unsigned> counter{0};
  const fs::path temporary = path.string() + fmt::format(".tmp-{}-{}", ::getpid(), counter++);
  const auto fail = [&](int error, std::string_view verb) {
    ::unlink(temporary.c_str());
    return std::unexpected(ErrorFromErrno(error, fmt::format("{} {}", verb, path.string())));
  };
  Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (file.get() < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("create {}", path.string())));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail(errno, "write");
    done += static_cast<std::size_t>(count);
  }
  if (::fsync(file.get()) != 0) return fail(errno, "write");
  if (file.Close() != 0) return fail(errno, "write");
  if (::rename(temporary.c_str(), path.c_str()) != 0) return fail(errno, "rename to");
  return {};
}

Status WriteFileAtomically(const fs::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text)));
}

Expected<std::shared_ptr<const MappedFile>> MappedFile::Open(const fs::path& path) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t size, OpenRegularFile(path, file));
  if (size == 0) return std::shared_ptr<const MappedFile>(new MappedFile(nullptr, 0));
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (data == MAP_FAILED) return std::unexpected(ErrorFromErrno(errno, fmt::format("map {}", path.string())));
  return std::shared_ptr<const MappedFile>(new MappedFile(static_cast<const std::byte*>(data), size));
}

MappedFile::~MappedFile() {
  if (size_ > 0) ::munmap(const_cast<std::byte*>(data_), size_);
}

std::uint64_t Checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

Expected<std::string> ContentId(const fs::path& path) {
  std::vector<fs::path> files;
  std::error_code error;
  if (fs::is_directory(path, error)) {
    for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
      if (it->is_regular_file(error)) files.push_back(it->path());
    }
    if (error) return std::unexpected(ErrorFromErrno(error.value(), path.string()));
    std::ranges::sort(files);
  } else {
    files.push_back(path);
  }
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_128bits_reset(state.get());
  for (const fs::path& file : files) {
    if (files.size() > 1) {
      const std::string name = file.filename().string();
      XXH3_128bits_update(state.get(), name.c_str(), name.size() + 1);
    }
    VICTORIOUS_RETURN_IF_ERROR(HashFile(file, state.get()));
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace victorious
