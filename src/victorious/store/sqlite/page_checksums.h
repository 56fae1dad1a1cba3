// Checksums of the pages of an index file, in the last 8 bytes of each page, which SQLite reserves for this. A layer
// below SQLite (a VFS) writes them whenever it writes a page of the file. SQLite itself sees zeros there, so that a
// page of the write-ahead log that another program copies into the file has no checksum rather than a wrong one.
//
// A file that was made without them stays so: its pages have no place for them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "victorious/base/error.h"

struct sqlite3;

namespace victorious::sqlite {

/// What a check of all pages of a file has found.
struct PageCheck {
  bool is_summed = false;             ///< false: the file was made without checksums
  std::int64_t pages = 0;             ///< those of the file
  std::int64_t without_checksum = 0;  ///< written by another program, or never used
  std::vector<std::int64_t> damaged;  ///< numbers of pages, from 1
};

/// The name of the layer for sqlite3_open_v2; nullptr if SQLite has no file system.
[[nodiscard]] const char* ChecksumLayer();

/// Lets the database have checksums if it is empty: to be called before its first use. Without effect on others.
void ReserveChecksums(sqlite3* database);

/// Before an empty database is made a copy of another one, page by page: the copy has checksums if the other one has.
void ReserveChecksumsAs(sqlite3* other, sqlite3* database);

/// Reads all pages of the file of a database. Those that another process writes at this moment are read again.
/// @return  false if the file cannot be read
[[nodiscard]] bool CheckPages(sqlite3* database, PageCheck& check);
/// The same of an index. Errors: those of opening and reading it.
[[nodiscard]] Expected<PageCheck> CheckPages(const std::filesystem::path& index);

}  // namespace victorious::sqlite
