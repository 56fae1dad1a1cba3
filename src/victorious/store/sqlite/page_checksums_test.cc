// The checksums of an index file's pages.
#include "victorious/store/sqlite/page_checksums.h"

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "testing/data.h"
#include "testing/sighting_batch.h"
#include "victorious/base/file.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sqlite/backup.h"
#include "victorious/store/sqlite/connection.h"
#include "victorious/store/sqlite/migrations.h"

namespace victorious::sqlite {
namespace {

using ::testing::IsEmpty;

constexpr std::size_t kPageSize = 4096;

class PageChecksumsTest : public ::testing::Test {
 protected:
  void SetUp() override { Fill(OpenSqliteStore(index_, StoreMode::kCreate).value().get(), 0, 40); }

  static void Fill(IndexStore* store, int from, int to) {
    const VideoRecord video = store->PutVideo({.content_id = "c", .name = "a.mp4"}).value();
    const ModelRecord model = store->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos}).value();
    for (int i = from; i < to; ++i) {
      ASSERT_TRUE(store->Commit(testing::SightingBatch(video.id, model.id, i * testing::kSightingsInBatch)));
    }
  }

  static PageCheck CheckOf(const std::filesystem::path& path) { return CheckPages(path).value(); }

  // The faults that a check finds; the reason if the file is refused.
  static std::vector<std::string> FaultsOf(const std::filesystem::path& path) {
    const auto store = OpenSqliteStore(path, StoreMode::kRead);
    if (!store) return {store.error().message};
    const auto faults = (*store)->FindFaults();
    if (!faults) return {faults.error().message};
    return *faults;
  }

  testing::ScratchFolder folder_;
  std::filesystem::path index_ = folder_ / "index.db";
};

TEST_F(PageChecksumsTest, EveryFlippedBitIsFound) {
  const std::string sound = ReadFile(index_).value();
  ASSERT_GT(sound.size(), 20 * kPageSize);
  // The pages of the tables and of their indexes, by SQLite's own account.
  std::vector<std::size_t> pages;
  {
    sqlite3* reader = nullptr;
    ASSERT_EQ(sqlite3_open_v2(index_.c_str(), &reader, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
    sqlite3_stmt* select = nullptr;
    const int prepared = sqlite3_prepare_v2(
        reader, "SELECT pageno FROM dbstat WHERE name IN ('objects', 'sightings', 'tracklets')", -1, &select, nullptr);
    while (prepared == SQLITE_OK && sqlite3_step(select) == SQLITE_ROW) {
      pages.push_back(static_cast<std::size_t>(sqlite3_column_int64(select, 0)));
    }
    sqlite3_finalize(select);
    sqlite3_close(reader);
  }
  if (pages.empty()) {  // a SQLite without dbstat
    for (std::size_t page = 2; page <= sound.size() / kPageSize; ++page) pages.push_back(page);
  }
  std::mt19937 random(50);
  for (int i = 0; i < 200; ++i) {
    std::string damaged = sound;
    const std::size_t at = (pages[random() % pages.size()] - 1) * kPageSize + random() % kPageSize;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    const auto path = folder_ / "damaged.db";
    ASSERT_TRUE(WriteFileAtomically(path, std::as_bytes(std::span(damaged))));
    EXPECT_FALSE(FaultsOf(path).empty()) << "byte " << at;
  }
}

TEST_F(PageChecksumsTest, AFlipInTheNumberOfReservedBytesIsFound) {
  std::string bytes = ReadFile(index_).value();
  for (int bit = 0; bit < 8; ++bit) {
    std::string damaged = bytes;
    damaged[20] = static_cast<char>(damaged[20] ^ (1 << bit));
    ASSERT_TRUE(WriteFileAtomically(folder_ / "damaged.db", std::as_bytes(std::span(damaged))));
    EXPECT_FALSE(FaultsOf(folder_ / "damaged.db").empty()) << "bit " << bit;
  }
}

TEST_F(PageChecksumsTest, ChangesAndReviewsKeepThem) {
  {
    const auto store = OpenSqliteStore(index_, StoreMode::kCreate).value();
    ASSERT_TRUE(
        store->PutReview(1, {.verdict = Verdict::kAccepted, .note = "seen", .updated_utc_us = 10, .reviewer = "ann"}));
    ASSERT_TRUE(store->DeleteSearch(1, 1));
    Fill(store.get(), 0, 10);
    EXPECT_THAT(store->FindFaults().value(), IsEmpty()) << "with a log beside the file";
  }
  EXPECT_THAT(FaultsOf(index_), IsEmpty());
  const PageCheck check = CheckOf(index_);
  EXPECT_TRUE(check.is_summed);
  EXPECT_GT(check.pages, 20);
}

TEST_F(PageChecksumsTest, EachPageOfANewFileAndOfItsCopyHasOne) {
  EXPECT_EQ(CheckOf(index_).without_checksum, 0);
  // More than SQLite holds in memory: pages of the copy are written before its header.
  Fill(OpenSqliteStore(index_, StoreMode::kCreate).value().get(), 40, 1500);
  ASSERT_TRUE(BackUp(index_, folder_ / "copy.db"));
  const PageCheck check = CheckOf(folder_ / "copy.db");
  EXPECT_TRUE(check.is_summed);
  EXPECT_GT(check.pages, 1000);
  EXPECT_EQ(check.without_checksum, 0);
  EXPECT_THAT(check.damaged, IsEmpty());
}

TEST_F(PageChecksumsTest, AFileWithoutThemStaysWithout) {
  const auto old = folder_ / "old.db";
  {
    sqlite3* plain = nullptr;  // SQLite's own layer, as in earlier versions
    ASSERT_EQ(sqlite3_open(old.c_str(), &plain), SQLITE_OK);
    for (const Migration& migration : Migrations()) {
      const std::string sql(migration.sql);
      ASSERT_EQ(sqlite3_exec(plain, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(plain);
    }
    const std::string version = "PRAGMA application_id = " + std::to_string(kApplicationId) +
                                "; PRAGMA user_version = " + std::to_string(Migrations().back().version);
    ASSERT_EQ(sqlite3_exec(plain, version.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(plain);
  }
  ASSERT_FALSE(CheckOf(old).is_summed);
  Fill(OpenSqliteStore(old, StoreMode::kCreate).value().get(), 0, 60);
  EXPECT_FALSE(CheckOf(old).is_summed);
  EXPECT_THAT(FaultsOf(old), IsEmpty());
  ASSERT_TRUE(BackUp(old, folder_ / "copy.db"));
  EXPECT_FALSE(CheckOf(folder_ / "copy.db").is_summed);
  EXPECT_EQ(OpenSqliteStore(old, StoreMode::kRead).value()->Sightings({})->size(), 60U * testing::kSightingsInBatch);
}

TEST_F(PageChecksumsTest, AnotherProgramThatReadsALogLeavesNoFault) {
  const auto copy = folder_ / "killed.db";
  {
    const auto store = OpenSqliteStore(index_, StoreMode::kCreate).value();
    Fill(store.get(), 40, 60);
    std::filesystem::copy_file(index_, copy);  // as a writer that is killed leaves it
    std::filesystem::copy_file(index_.string() + "-wal", copy.string() + "-wal");
  }
  sqlite3* plain = nullptr;
  ASSERT_EQ(sqlite3_open(copy.c_str(), &plain), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(plain, "PRAGMA wal_checkpoint(TRUNCATE)", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(plain);
  EXPECT_THAT(FaultsOf(copy), IsEmpty());
  EXPECT_GT(CheckOf(copy).without_checksum, 0);
  EXPECT_EQ(OpenSqliteStore(copy, StoreMode::kRead).value()->Sightings({})->size(), 60U * testing::kSightingsInBatch);
}

}  // namespace
}  // namespace victorious::sqlite
