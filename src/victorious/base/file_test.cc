#include "victorious/base/file.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "testing/data.h"
#include "victorious/base/mapped_pages.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using victorious::testing::ScratchFolder;

void Put(const fs::path& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

std::size_t EntryCount(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

std::string_view TextOf(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

template <typename T>
std::optional<ErrorCode> CodeOf(const Expected<T>& result) {
  return result ? std::nullopt : std::optional(result.error().code);
}

// RAII: limits the file size of this process to `bytes`, to simulate a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int);
};

// RAII: drops root privileges, in case root runs the test.
class OrdinaryUser {
 public:
  OrdinaryUser() {
    constexpr uid_t kNobody = 65534;
    if (user_ == 0 && ::seteuid(kNobody) != 0) ADD_FAILURE() << "cannot drop root's rights";
  }
  ~OrdinaryUser() {
    if (::seteuid(user_) != 0) ADD_FAILURE() << "cannot take the rights back";
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  uid_t user_ = ::geteuid();
};

TEST(ReadFile, ReadsEveryByte) {
  const ScratchFolder scratch;
  const std::string bytes("a\0b\r\n\xff", 6);
  Put(scratch / "file", bytes);
  EXPECT_EQ(ReadFile(scratch / "file"), bytes);
  Put(scratch / "empty", "");
  EXPECT_EQ(ReadFile(scratch / "empty"), "");
}

TEST(ReadFile, RefusesFilesAboveTheLimit) {
  const ScratchFolder scratch;
  Put(scratch / "file", "12345678");
  EXPECT_EQ(ReadFile(scratch / "file", 8), "12345678");
  const auto refused = ReadFile(scratch / "file", 7);
  EXPECT_EQ(CodeOf(refused), ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message, HasSubstr("8 bytes"));
}

TEST(ReadFile, ErrorNamesMissingFile) {
  const ScratchFolder scratch;
  const auto missing = ReadFile(scratch / "absent");
  EXPECT_EQ(CodeOf(missing), ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr((scratch / "absent").string()));
}

TEST(ReadFile, RefusesNonRegularFiles) {
  const ScratchFolder scratch;
  EXPECT_EQ(CodeOf(ReadFile(scratch.path())), ErrorCode::kInvalidArgument);
  // A pipe without a writer must not block the program.
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(CodeOf(ReadFile(scratch / "pipe")), ErrorCode::kInvalidArgument);
  EXPECT_EQ(CodeOf(MappedFile::Open(scratch / "pipe")), ErrorCode::kInvalidArgument);
  EXPECT_EQ(CodeOf(ContentId(scratch / "pipe")), ErrorCode::kInvalidArgument);
}

TEST(ReadFile, UnreadableFileIsPermissionDenied) {
  const ScratchFolder scratch;
  Put(scratch / "secret", "x");
  fs::permissions(scratch.path(), fs::perms::owner_all | fs::perms::others_exec);
  fs::permissions(scratch / "secret", fs::perms::none);
  const OrdinaryUser user;
  EXPECT_EQ(CodeOf(ReadFile(scratch / "secret")), ErrorCode::kPermissionDenied);
}

TEST(WriteFileAtomically, CreatesAndReplaces) {
  const ScratchFolder scratch;
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", "old and long"));
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", "new"));
  EXPECT_EQ(ReadFile(scratch / "file"), "new");
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", ""));
  EXPECT_EQ(ReadFile(scratch / "file"), "");
  EXPECT_EQ(EntryCount(scratch.path()), 1U);
}

TEST(WriteFileAtomically, FullDiskKeepsTheOldFileAndLeavesNoTemporary) {
  const ScratchFolder scratch;
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", "old"));
  {
    const FileSizeLimit limit(4096);
    EXPECT_EQ(CodeOf(WriteFileAtomically(scratch / "file", std::string(100'000, 'x'))), ErrorCode::kNoSpace);
  }
  EXPECT_EQ(ReadFile(scratch / "file"), "old");
  EXPECT_EQ(EntryCount(scratch.path()), 1U);
}

TEST(WriteFileAtomically, ReadOnlyFolderIsPermissionDenied) {
  const ScratchFolder scratch;
  fs::permissions(scratch.path(), fs::perms::owner_read | fs::perms::owner_exec);
  {
    const OrdinaryUser user;
    const auto refused = WriteFileAtomically(scratch / "file", "x");
    EXPECT_EQ(CodeOf(refused), ErrorCode::kPermissionDenied);
    EXPECT_THAT(refused.error().message, HasSubstr((scratch / "file").string()));
  }
  fs::permissions(scratch.path(), fs::perms::owner_all);
  EXPECT_EQ(EntryCount(scratch.path()), 0U);
}

TEST(WriteFileAtomically, RefusesMissingFoldersAndFolders) {
  const ScratchFolder scratch;
  EXPECT_EQ(CodeOf(WriteFileAtomically(scratch / "absent/file", "x")), ErrorCode::kNotFound);
  fs::create_directory(scratch / "folder");
  EXPECT_EQ(CodeOf(WriteFileAtomically(scratch / "folder", "x")), ErrorCode::kInvalidArgument);
  EXPECT_EQ(EntryCount(scratch.path()), 1U);
}

TEST(WriteFileAtomically, IgnoresTemporaryOfKilledProcessWithSameId) {
  // In a container, the program has the same process id each time, and its counter starts at 0.
  const ScratchFolder scratch;
  for (int i = 0; i < 500; ++i) Put(scratch / fmt::format("file.tmp-{}-{}", ::getpid(), i), "half");
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", "whole"));
  EXPECT_EQ(ReadFile(scratch / "file"), "whole");
}

TEST(WriteFileAtomically, SymbolicLinkIsKeptAndItsTargetReplaced) {
  const ScratchFolder scratch;
  fs::create_directory(scratch / "far");
  Put(scratch / "far/file", "old");
  fs::create_symlink("far/file", scratch / "link");
  fs::create_symlink(scratch / "link", scratch / "link-to-link");
  ASSERT_TRUE(WriteFileAtomically(scratch / "link-to-link", "new"));
  EXPECT_TRUE(fs::is_symlink(scratch / "link"));
  EXPECT_TRUE(fs::is_symlink(scratch / "link-to-link"));
  EXPECT_FALSE(fs::is_symlink(scratch / "far/file"));
  EXPECT_EQ(ReadFile(scratch / "far/file"), "new");
  EXPECT_EQ(EntryCount(scratch / "far"), 1U);

  fs::create_symlink("far/later", scratch / "dangling");
  ASSERT_TRUE(WriteFileAtomically(scratch / "dangling", "made"));
  EXPECT_TRUE(fs::is_symlink(scratch / "dangling"));
  EXPECT_EQ(ReadFile(scratch / "far/later"), "made");

  fs::create_symlink("circle", scratch / "circle");
  EXPECT_FALSE(WriteFileAtomically(scratch / "circle", "x"));
  EXPECT_TRUE(fs::is_symlink(scratch / "circle"));
}

// Uses links, so that a failure of this test cannot damage the machine's devices.
TEST(WriteFileAtomically, WritesToDevicesAndPipes) {
  const ScratchFolder scratch;
  fs::create_symlink("/dev/null", scratch / "null");
  EXPECT_TRUE(WriteFileAtomically(scratch / "null", "nothing"));
  EXPECT_TRUE(fs::is_character_file(scratch / "null"));
  fs::create_symlink("/dev/full", scratch / "full");
  EXPECT_EQ(CodeOf(WriteFileAtomically(scratch / "full", "nothing")), ErrorCode::kNoSpace);

  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  const int reader = ::open((scratch / "pipe").c_str(), O_RDONLY | O_NONBLOCK);
  EXPECT_TRUE(WriteFileAtomically(scratch / "pipe", "through"));
  EXPECT_TRUE(fs::is_fifo(scratch / "pipe"));
  std::string text(7, '\0');
  EXPECT_EQ(::read(reader, text.data(), text.size()), 7);
  EXPECT_EQ(text, "through");
  ::close(reader);
  EXPECT_EQ(EntryCount(scratch.path()), 3U);
}

TEST(WriteFileAtomically, ReaderSeesOldOrCompleteNewFile) {
  const ScratchFolder scratch;
  const std::string old_text(200'000, 'a');
  const std::string new_text(300'000, 'b');
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", old_text));
  std::atomic<bool> writing = true;
  std::thread writer([&] {
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(WriteFileAtomically(scratch / "file", i % 2 == 0 ? new_text : old_text));
    writing = false;
  });
  int torn = 0;
  while (writing) {
    const auto text = ReadFile(scratch / "file");
    if (!text || (*text != old_text && *text != new_text)) ++torn;
  }
  writer.join();
  EXPECT_EQ(torn, 0);
}

TEST(MappedFile, MapsTheBytesAlsoAfterUnlink) {
  const ScratchFolder scratch;
  Put(scratch / "file", "mapped bytes");
  const auto file = MappedFile::Open(scratch / "file");
  ASSERT_TRUE(file);
  EXPECT_EQ(TextOf(**file), "mapped bytes");
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", "replaced"));
  EXPECT_EQ(TextOf(**file), "mapped bytes");
  fs::remove(scratch / "file");
  EXPECT_EQ(TextOf(**file), "mapped bytes");
}

// Bytes of files that are mapped into this process and resident (proc(5), statm).
std::size_t ResidentFileBytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0;
  std::size_t resident = 0;
  std::size_t shared = 0;
  statm >> size >> resident >> shared;
  return shared * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(MappedFile, GivesBackTheMemoryOfItsPages) {
  constexpr std::size_t kBytes = 32 << 20;
  const ScratchFolder scratch;
  Put(scratch / "file", std::string(kBytes, 'x'));
  const auto file = MappedFile::Open(scratch / "file");
  ASSERT_TRUE(file);
  const std::uint64_t checksum = Checksum((*file)->bytes());
  const std::size_t read = ResidentFileBytes();
  (*file)->ReleasePages();
  EXPECT_LT(ResidentFileBytes() + kBytes / 2, read);
  EXPECT_EQ(Checksum((*file)->bytes()), checksum) << "they are read again";
}

TEST(ReleaseMappedPages, ReleasesPartsOfMappedFilesOnly) {
  constexpr std::size_t kBytes = 32 << 20;
  const ScratchFolder scratch;
  Put(scratch / "file", std::string(kBytes, 'x'));
  const auto file = MappedFile::Open(scratch / "file");
  ASSERT_TRUE(file);
  const std::span<const std::byte> bytes = (*file)->bytes();
  const std::uint64_t checksum = Checksum(bytes);
  const std::size_t read = ResidentFileBytes();
  ReleaseMappedPages(bytes.subspan(kBytes / 4 + 1, kBytes / 2));
  const std::size_t released = read - ResidentFileBytes();
  EXPECT_GT(released, kBytes / 2 - kBytes / 8);
  EXPECT_LT(released, kBytes / 2 + kBytes / 8);
  EXPECT_EQ(Checksum(bytes), checksum);

  const std::vector<std::byte> own(4 << 20, std::byte{7});
  ReleaseMappedPages(own);
  EXPECT_EQ(std::ranges::count(own, std::byte{7}), std::ssize(own)) << "no file: would be lost";
}

TEST(MappedFile, EmptyFileHasNoBytes) {
  const ScratchFolder scratch;
  Put(scratch / "empty", "");
  const auto file = MappedFile::Open(scratch / "empty");
  ASSERT_TRUE(file);
  EXPECT_TRUE((*file)->bytes().empty());
}

TEST(MappedFile, RefusesMissingAndNonRegularFiles) {
  const ScratchFolder scratch;
  EXPECT_EQ(CodeOf(MappedFile::Open(scratch / "absent")), ErrorCode::kNotFound);
  EXPECT_EQ(CodeOf(MappedFile::Open(scratch.path())), ErrorCode::kInvalidArgument);
}

TEST(Checksum, IsXxh3OfSixtyFourBits) {
  EXPECT_EQ(Checksum({}), 0x2d06800538d394c2U);  // the algorithm's published value for no bytes, seed 0
}

TEST(Checksum, DetectsEveryFlippedBit) {
  std::string text = "descriptors of one block, as they stand in a model file";
  const std::uint64_t whole = Checksum(std::as_bytes(std::span(text)));
  for (std::size_t bit = 0; bit < text.size() * 8; ++bit) {
    const auto mask = static_cast<char>(1U << (bit % 8));
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ mask);
    EXPECT_NE(Checksum(std::as_bytes(std::span(text))), whole) << "bit " << bit;
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ mask);
  }
}

TEST(ContentId, IsXxh3Of128BitsRegardlessOfName) {
  const ScratchFolder scratch;
  Put(scratch / "empty", "");
  EXPECT_EQ(ContentId(scratch / "empty"), "99aa06d3014798d86001c324468d497f");  // published, as above
  const std::string bytes(3'000'001, 'v');                                      // more than one read
  Put(scratch / "a.mp4", bytes);
  Put(scratch / "b.mp4", bytes);
  Put(scratch / "c.mp4", bytes.substr(1));
  EXPECT_EQ(ContentId(scratch / "a.mp4"), ContentId(scratch / "b.mp4"));
  EXPECT_NE(ContentId(scratch / "a.mp4"), ContentId(scratch / "c.mp4"));
}

TEST(ContentId, MissingPathIsNotFound) {
  const ScratchFolder scratch;
  EXPECT_EQ(CodeOf(ContentId(scratch / "absent")), ErrorCode::kNotFound);
}

TEST(ContentId, ReportsProgressAndIsCancellable) {
  const ScratchFolder scratch;
  constexpr std::int64_t kBytes = 5'000'000;
  Put(scratch / "file", std::string(kBytes, 'v'));
  std::int64_t last = 0;
  ASSERT_TRUE(ContentId(scratch / "file", CancelToken(), [&](std::int64_t done, std::int64_t total) {
    EXPECT_GT(done, last);
    EXPECT_EQ(total, kBytes);
    last = done;
  }));
  EXPECT_EQ(last, kBytes);

  CancelToken cancel;
  std::int64_t read = 0;
  const auto stopped = ContentId(scratch / "file", cancel, [&](std::int64_t done, std::int64_t /*total*/) {
    read = done;
    cancel.Cancel();
  });
  EXPECT_EQ(CodeOf(stopped), ErrorCode::kCancelled);
  EXPECT_THAT(stopped.error().message, HasSubstr((scratch / "file").string()));
  EXPECT_LT(read, kBytes);
}

class ContentIdOfFilesTest : public ::testing::Test {
 protected:
  std::string IdOf(std::initializer_list<std::pair<const char*, const char*>> files) {
    const ScratchFolder scratch;
    std::vector<fs::path> paths;
    for (const auto& [name, text] : files) Put(paths.emplace_back(scratch / name), text);
    return ContentIdOfFiles(paths).value();
  }
};

TEST_F(ContentIdOfFilesTest, DependsOnNamesContentsAndOrderOnly) {
  const std::string id = IdOf({{"0.png", "first"}, {"1.png", "second"}});
  EXPECT_EQ(id, IdOf({{"0.png", "first"}, {"1.png", "second"}})) << "in another folder";
  EXPECT_NE(id, IdOf({{"1.png", "second"}, {"0.png", "first"}}));
  EXPECT_NE(id, IdOf({{"0.png", "second"}, {"1.png", "first"}}));
  EXPECT_NE(id, IdOf({{"0.png", "first"}, {"2.png", "second"}}));
  EXPECT_NE(id, IdOf({{"0.png", "first"}}));
}

TEST_F(ContentIdOfFilesTest, DependsOnFileBoundaries) {
  EXPECT_NE(IdOf({{"a", "xb"}, {"c", "y"}}), IdOf({{"a", "x"}, {"bc", "y"}}));
  EXPECT_NE(IdOf({{"a", "1c2"}, {"d", "3"}}), IdOf({{"a", "1"}, {"c", "2d3"}}));
  EXPECT_NE(IdOf({{"a", "x"}}), IdOf({{"b", "x"}}));
}

TEST_F(ContentIdOfFilesTest, ProgressCountsBytesOfAllFiles) {
  const ScratchFolder scratch;
  Put(scratch / "a", std::string(1000, 'a'));
  Put(scratch / "b", std::string(2000, 'b'));
  const std::vector<fs::path> files = {scratch / "a", scratch / "b"};
  std::vector<std::int64_t> progress;
  ASSERT_TRUE(ContentIdOfFiles(files, CancelToken(), [&](std::int64_t done, std::int64_t total) {
    EXPECT_EQ(total, 3000);
    progress.push_back(done);
  }));
  EXPECT_THAT(progress, ::testing::ElementsAre(1000, 3000));
}

TEST_F(ContentIdOfFilesTest, ErrorNamesUnreadableFile) {
  const ScratchFolder scratch;
  const std::vector<fs::path> files = {scratch / "absent"};
  const auto missing = ContentIdOfFiles(files);
  EXPECT_EQ(CodeOf(missing), ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("absent"));
}

}  // namespace
}  // namespace victorious
