#include "victorious/base/file_writer.h"

#include <atomic>
#include <cerrno>
#include <memory>
#include <ostream>
#include <span>
#include <streambuf>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "victorious/base/file_descriptor.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// Collects what a stream gives, and writes it when the buffer is full. After an error it takes nothing more.
class DescriptorBuffer final : public std::streambuf {
 public:
  DescriptorBuffer(int fd, std::string_view name) : fd_(fd), name_(name) { Empty(); }

  [[nodiscard]] const Status& status() const { return status_; }

  /// Writes what is collected.
  bool Flush() {
    const bool is_written = WriteAll({pbase(), pptr()});
    Empty();
    return is_written;
  }

 protected:
  int_type overflow(int_type c) override {
    if (!Flush()) return traits_type::eof();
    return traits_type::eq_int_type(c, traits_type::eof()) ? traits_type::not_eof(c)
                                                           : sputc(traits_type::to_char_type(c));
  }

  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    if (count <= epptr() - pptr()) return std::streambuf::xsputn(bytes, count);
    return Flush() && WriteAll({bytes, bytes + count}) ? count : 0;
  }

 private:
  void Empty() { setp(buffer_.get(), buffer_.get() + kWriterBufferBytes); }

  bool WriteAll(std::span<const char> bytes) {
    while (status_ && !bytes.empty()) {
      const ssize_t count = ::write(fd_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        status_ = std::unexpected(ErrorFromErrno(errno, fmt::format("write {}", name_)));
      } else {
        bytes = bytes.subspan(static_cast<std::size_t>(count));
      }
    }
    return status_.has_value();
  }

  int fd_;
  std::string name_;
  std::unique_ptr<char[]> buffer_ = std::make_unique_for_overwrite<char[]>(kWriterBufferBytes);
  Status status_;
};

// Creates a temporary file beside `path`. Returns its name and descriptor (negative: errno gives the reason).
std::pair<fs::path, int> CreateBeside(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  while (true) {
    fs::path name = path.string() + fmt::format(".tmp-{}-{}", ::getpid(), counter++);
    const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    // An existing name was left by a killed process with the same process id: tries the next one.
    if (fd >= 0 || errno != EEXIST) return {std::move(name), fd};
  }
}

// Follows a chain of symbolic links to its target, which need not exist.
Expected<fs::path> FollowLinks(fs::path path) {
  constexpr int kMaxLinks = 40;  // the limit of the operating system
  for (int links = 0; links < kMaxLinks; ++links) {
    std::error_code not_a_link;
    const fs::path target = fs::read_symlink(path, not_a_link);
    if (not_a_link) return path;
    path = path.parent_path() / target;  // an absolute target replaces the path
  }
  return std::unexpected(ErrorFromErrno(ELOOP, path.string()));
}

// Writes to a device or a pipe, which has no old content to preserve.
Status WriteInPlace(const fs::path& path, const WriteContent& write) {
  const FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.fd() < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("write {}", path.string())));
  return WriteInParts(file.fd(), path.string(), write);
}

Status Replace(const fs::path& path, const WriteContent& write) {
  auto [temporary, fd] = CreateBeside(path);
  if (fd < 0) return std::unexpected(ErrorFromErrno(errno, fmt::format("create {}", path.string())));
  FileDescriptor file(fd);
  const auto give_up = [&](Error error) {
    ::unlink(temporary.c_str());
    return std::unexpected(std::move(error));
  };
  const auto failed = [&](std::string_view verb) {
    return give_up(ErrorFromErrno(errno, fmt::format("{} {}", verb, path.string())));
  };
  if (Status written = WriteInParts(file.fd(), path.string(), write); !written) {
    return give_up(std::move(written).error());
  }
  if (::fsync(file.fd()) != 0) return failed("write");
  if (file.Close() != 0) return failed("write");
  if (::rename(temporary.c_str(), path.c_str()) != 0) return failed("rename to");
  return {};
}

}  // namespace

Status WriteInParts(int descriptor, std::string_view name, const WriteContent& write) {
  DescriptorBuffer buffer(descriptor, name);
  std::ostream out(&buffer);
  const Status made = write(out);
  if (made) buffer.Flush();
  // A writer of a stream knows only that it failed.
  return buffer.status() ? made : buffer.status();
}

Status WriteFileInParts(const fs::path& path, const WriteContent& write) {
  struct stat info{};
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) return WriteInPlace(path, write);
  VICTORIOUS_ASSIGN_OR_RETURN(const fs::path target, FollowLinks(path));
  return Replace(target, write);
}

}  // namespace victorious
