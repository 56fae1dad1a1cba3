#include "victorious/store/sqlite/page_checksums.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <span>
#include <thread>

#include <sqlite3.h>

#include "victorious/base/file.h"
#include "victorious/store/sqlite/open_database.h"

namespace victorious::sqlite {
namespace {

constexpr const char* kLayer = "victorious-checksums";
constexpr std::size_t kSumSize = sizeof(std::uint64_t);
// The header of the file: page 1 begins with it.
constexpr std::size_t kHeaderSize = 100;
constexpr std::size_t kPageSizeAt = 16;
constexpr std::size_t kReservedAt = 20;
constexpr std::size_t kMinPage = 512;
constexpr std::size_t kMaxPage = 65536;
// Requests to a file of this layer. Those below 100 are SQLite's own.
constexpr int kGetIsSummed = 0x56494301;
constexpr int kSetIsSummed = 0x56494302;
constexpr int kCheck = 0x56494303;

// A database file: SQLite's own file follows it in memory.
struct SummedFile {
  sqlite3_file base;
  bool is_known;   // whether is_summed has been read from the header, or was set
  bool is_summed;  // the header says that each page ends with a checksum
};
static_assert(sizeof(SummedFile) % alignof(std::max_align_t) == 0);

SummedFile& Summed(sqlite3_file* file) { return *reinterpret_cast<SummedFile*>(file); }
sqlite3_file* Inner(sqlite3_file* file) { return reinterpret_cast<sqlite3_file*>(&Summed(file) + 1); }

bool IsPage(std::int64_t size, std::int64_t offset) {
  return size >= static_cast<std::int64_t>(kMinPage) && size <= static_cast<std::int64_t>(kMaxPage) &&
         std::has_single_bit(static_cast<std::uint64_t>(size)) && offset % size == 0;
}

// Never 0, which stands for none. Of the page's number as well: a page in the place of another one is damage.
std::uint64_t SumOf(std::span<const std::byte> page, std::int64_t number) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  const std::uint64_t sum = Checksum(page.first(page.size() - kSumSize)) ^ (static_cast<std::uint64_t>(number) * kOdd);
  return sum == 0 ? 1 : sum;
}

std::uint64_t StoredSum(std::span<const std::byte> page) {
  std::uint64_t sum = 0;
  std::memcpy(&sum, page.last(kSumSize).data(), kSumSize);
  return sum;
}

bool HasSums(const std::byte* header) { return std::to_integer<std::size_t>(header[kReservedAt]) == kSumSize; }

bool IsSummed(sqlite3_file* file) {
  SummedFile& summed = Summed(file);
  if (summed.is_known) return summed.is_summed;
  std::array<std::byte, kHeaderSize> header{};
  sqlite3_file* inner = Inner(file);
  if (inner->pMethods->xRead(inner, header.data(), static_cast<int>(header.size()), 0) != SQLITE_OK) return false;
  summed.is_known = true;
  summed.is_summed = HasSums(header.data());
  return summed.is_summed;
}

// A page that does not match may be one that another process writes at this moment.
int ReadSound(sqlite3_file* inner, std::span<std::byte> page, std::int64_t number, bool& is_sound) {
  constexpr int kAttempts = 3;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto size = static_cast<std::int64_t>(page.size());
    const int code = inner->pMethods->xRead(inner, page.data(), static_cast<int>(size), (number - 1) * size);
    if (code != SQLITE_OK) return code;
    is_sound = StoredSum(page) == 0 || StoredSum(page) == SumOf(page, number);
    if (is_sound) break;
  }
  return SQLITE_OK;
}

int Check(sqlite3_file* inner, PageCheck& check) {
  check = {};
  std::array<std::byte, kHeaderSize> header{};
  sqlite3_int64 size = 0;
  if (const int code = inner->pMethods->xFileSize(inner, &size); code != SQLITE_OK) return code;
  if (size < static_cast<sqlite3_int64>(kHeaderSize)) return SQLITE_OK;
  int code = inner->pMethods->xRead(inner, header.data(), static_cast<int>(header.size()), 0);
  if (code != SQLITE_OK) return code;
  const std::size_t stated =
      std::to_integer<std::size_t>(header[kPageSizeAt]) << 8 | std::to_integer<std::size_t>(header[kPageSizeAt + 1]);
  const std::size_t page_size = stated == 1 ? kMaxPage : stated;
  if (!IsPage(static_cast<std::int64_t>(page_size), 0)) return SQLITE_OK;  // SQLite refuses it
  std::vector<std::byte> page(page_size);
  check.pages = size / static_cast<std::int64_t>(page_size);
  check.is_summed = HasSums(header.data());
  if (!check.is_summed) {
    // The header may be what is damaged.
    if (check.pages == 0) return SQLITE_OK;
    code = inner->pMethods->xRead(inner, page.data(), static_cast<int>(page_size), 0);
    page[kReservedAt] = static_cast<std::byte>(kSumSize);
    if (code == SQLITE_OK && StoredSum(page) == SumOf(page, 1)) check.damaged.push_back(1);
    return code;
  }
  for (std::int64_t number = 1; number <= check.pages; ++number) {
    bool is_sound = false;
    code = ReadSound(inner, page, number, is_sound);
    if (code != SQLITE_OK) return code;
    if (!is_sound) check.damaged.push_back(number);
    if (StoredSum(page) == 0) ++check.without_checksum;
  }
  return SQLITE_OK;
}

int Close(sqlite3_file* file) { return Inner(file)->pMethods->xClose(Inner(file)); }

int Read(sqlite3_file* file, void* bytes, int size, sqlite3_int64 offset) {
  sqlite3_file* inner = Inner(file);
  const int code = inner->pMethods->xRead(inner, bytes, size, offset);
  if (code == SQLITE_OK && IsPage(size, offset) && IsSummed(file)) {
    std::memset(static_cast<std::byte*>(bytes) + size - kSumSize, 0, kSumSize);
  }
  return code;
}

int Write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  sqlite3_file* inner = Inner(file);
  const std::span given(static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size));
  if (!IsPage(size, offset)) return inner->pMethods->xWrite(inner, bytes, size, offset);
  if (offset == 0) {
    Summed(file).is_known = true;
    Summed(file).is_summed = HasSums(given.data());
  }
  if (!IsSummed(file)) return inner->pMethods->xWrite(inner, bytes, size, offset);
  // SQLite goes on using its page: the checksum is put into a copy. On the stack: an index may be closed after the
  // thread's own objects have ended.
  std::array<std::byte, kMaxPage> copy;
  const std::span page(copy.data(), given.size());
  std::ranges::copy(given, page.begin());
  const std::uint64_t sum = SumOf(page, offset / size + 1);
  std::memcpy(page.data() + page.size() - kSumSize, &sum, kSumSize);
  return inner->pMethods->xWrite(inner, page.data(), size, offset);
}

int FileControl(sqlite3_file* file, int request, void* argument) {
  switch (request) {
    case kGetIsSummed:
      *static_cast<bool*>(argument) = IsSummed(file);
      return SQLITE_OK;
    case kSetIsSummed:
      Summed(file).is_known = true;
      Summed(file).is_summed = true;
      return SQLITE_OK;
    case kCheck:
      return Check(Inner(file), *static_cast<PageCheck*>(argument));
    default:
      return Inner(file)->pMethods->xFileControl(Inner(file), request, argument);
  }
}

// What the layer does not change. Version 2 has no memory maps, which would show pages as they are in the file.
constexpr sqlite3_io_methods kMethods = {
    .iVersion = 2,
    .xClose = Close,
    .xRead = Read,
    .xWrite = Write,
    .xTruncate = [](sqlite3_file* file,
                    sqlite3_int64 size) { return Inner(file)->pMethods->xTruncate(Inner(file), size); },
    .xSync = [](sqlite3_file* file, int flags) { return Inner(file)->pMethods->xSync(Inner(file), flags); },
    .xFileSize = [](sqlite3_file* file,
                    sqlite3_int64* size) { return Inner(file)->pMethods->xFileSize(Inner(file), size); },
    .xLock = [](sqlite3_file* file, int lock) { return Inner(file)->pMethods->xLock(Inner(file), lock); },
    .xUnlock = [](sqlite3_file* file, int lock) { return Inner(file)->pMethods->xUnlock(Inner(file), lock); },
    .xCheckReservedLock = [](sqlite3_file* file,
                             int* is_held) { return Inner(file)->pMethods->xCheckReservedLock(Inner(file), is_held); },
    .xFileControl = FileControl,
    .xSectorSize = [](sqlite3_file* file) { return Inner(file)->pMethods->xSectorSize(Inner(file)); },
    .xDeviceCharacteristics =
        [](sqlite3_file* file) { return Inner(file)->pMethods->xDeviceCharacteristics(Inner(file)); },
    .xShmMap =
        [](sqlite3_file* file, int page, int size, int extends, void volatile** memory) {
          return Inner(file)->pMethods->xShmMap(Inner(file), page, size, extends, memory);
        },
    .xShmLock = [](sqlite3_file* file, int offset, int count,
                   int flags) { return Inner(file)->pMethods->xShmLock(Inner(file), offset, count, flags); },
    .xShmBarrier = [](sqlite3_file* file) { Inner(file)->pMethods->xShmBarrier(Inner(file)); },
    .xShmUnmap = [](sqlite3_file* file, int deletes) { return Inner(file)->pMethods->xShmUnmap(Inner(file), deletes); },
    .xFetch = nullptr,
    .xUnfetch = nullptr,
};

int Open(sqlite3_vfs* layer, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  auto* const system = static_cast<sqlite3_vfs*>(layer->pAppData);
  // Journals and temporary files as they are.
  if ((flags & SQLITE_OPEN_MAIN_DB) == 0) return system->xOpen(system, name, file, flags, out_flags);
  Summed(file) = {};
  const int code = system->xOpen(system, name, Inner(file), flags, out_flags);
  if (code == SQLITE_OK) file->pMethods = &kMethods;
  return code;
}

}  // namespace

const char* ChecksumLayer() {
  static const char* const layer = []() -> const char* {
    const sqlite3_vfs* system = sqlite3_vfs_find(nullptr);
    if (system == nullptr) return nullptr;
    static sqlite3_vfs made = *system;
    made.pNext = nullptr;
    made.zName = kLayer;
    made.szOsFile += static_cast<int>(sizeof(SummedFile));
    made.pAppData = const_cast<sqlite3_vfs*>(system);
    made.xOpen = Open;
    return sqlite3_vfs_register(&made, /*makeDflt=*/0) == SQLITE_OK ? kLayer : nullptr;
  }();
  return layer;
}

void ReserveChecksums(sqlite3* database) {
  int reserved = kSumSize;
  sqlite3_file_control(database, "main", SQLITE_FCNTL_RESERVE_BYTES, &reserved);
}

void ReserveChecksumsAs(sqlite3* other, sqlite3* database) {
  bool is_summed = false;
  if (sqlite3_file_control(other, "main", kGetIsSummed, &is_summed) != SQLITE_OK || !is_summed) return;
  ReserveChecksums(database);
  // The header is written last.
  sqlite3_file_control(database, "main", kSetIsSummed, nullptr);
}

bool CheckPages(sqlite3* database, PageCheck& check) {
  return sqlite3_file_control(database, "main", kCheck, &check) == SQLITE_OK;
}

Expected<PageCheck> CheckPages(const std::filesystem::path& index) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto connection, OpenDatabase(index, StoreMode::kRead));
  PageCheck check;
  if (!CheckPages(connection->handle(), check)) return std::unexpected(connection->ErrorFromCode(SQLITE_IOERR_READ));
  return check;
}

}  // namespace victorious::sqlite
