// A copy of an index that is being written.
#include "victorious/store/sqlite/backup.h"

#include <atomic>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "testing/data.h"
#include "testing/sighting_batch.h"
#include "victorious/base/file.h"
#include "victorious/store/index_store.h"

namespace victorious::sqlite {
namespace {

using ::testing::HasSubstr;

TEST(BackupTest, ACopyOfAnIndexThatIsWrittenHasWholeBatches) {
  const testing::ScratchFolder folder;
  const auto index = folder / "index.db";
  const auto writer = OpenSqliteStore(index, StoreMode::kCreate).value();
  const VideoRecord video = writer->PutVideo({.content_id = "c", .name = "a.mp4"}).value();
  const ModelRecord model = writer->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos}).value();
  std::atomic<bool> is_over = false;
  std::atomic<int> batches = 0;
  std::thread writing([&] {
    std::int64_t frame = 0;
    while (!is_over) {
      ASSERT_TRUE(writer->Commit(testing::SightingBatch(video.id, model.id, frame)));
      frame += testing::kSightingsInBatch;
      ++batches;
    }
  });
  for (int i = 0; i < 5; ++i) {
    const int before = batches;
    while (batches < before + 3) std::this_thread::yield();
    const auto copy = folder / ("copy" + std::to_string(i) + ".db");
    const int committed = batches;
    const Status done = BackUp(index, copy);
    EXPECT_TRUE(done) << done.error().message;
    const auto store = OpenSqliteStore(copy, StoreMode::kRead);
    if (!store) {
      ADD_FAILURE() << store.error().message;
      break;
    }
    const auto search = (*store)->FindSearch(video.id, model.id).value();
    EXPECT_GE(search->next_frame, committed * testing::kSightingsInBatch) << "what was committed before is there";
    EXPECT_EQ((*store)->Sightings({})->size(), static_cast<std::size_t>(search->next_frame));
    EXPECT_TRUE((*store)->FindFaults()->empty());
    struct stat info{};
    ASSERT_EQ(::stat(copy.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0600U);
  }
  is_over = true;
  writing.join();
}

TEST(BackupTest, ReplacesNothingAndCopiesNoDamage) {
  const testing::ScratchFolder folder;
  const auto index = folder / "index.db";
  {
    const auto store = OpenSqliteStore(index, StoreMode::kCreate).value();
    const VideoRecord video = store->PutVideo({.content_id = "c", .name = "a.mp4"}).value();
    const ModelRecord model = store->PutModel({.name = "m", .content_id = "1", .kind = ModelKind::kPhotos}).value();
    ASSERT_TRUE(store->Commit(testing::SightingBatch(video.id, model.id, 0)));
  }
  EXPECT_EQ(BackUp(index, index).error().code, ErrorCode::kAlreadyExists);
  EXPECT_EQ(BackUp(folder / "none.db", folder / "copy.db").error().code, ErrorCode::kNotFound);
  // The root page of a table or an index in the middle of the file.
  std::string bytes = ReadFile(index).value();
  const std::size_t middle = bytes.size() / 4096 / 2 * 4096;
  for (std::size_t i = 0; i < 4096; ++i) bytes[middle + i] = '\xA5';
  ASSERT_TRUE(WriteFileAtomically(index, std::as_bytes(std::span(bytes))));
  const Status damaged = BackUp(index, folder / "copy.db");
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, ErrorCode::kDataLoss);
  EXPECT_THAT(damaged.error().message, HasSubstr("index.db"));
  EXPECT_FALSE(std::filesystem::exists(folder / "copy.db"));
  EXPECT_FALSE(std::filesystem::exists(folder / "copy.db.part"));
}

}  // namespace
}  // namespace victorious::sqlite
