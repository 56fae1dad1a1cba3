// What the contract of JobQueue (job_queue_test.cc) cannot say: rows that no program of this version writes.
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "testing/data.h"
#include "victorious/store/job_queue.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(SqliteJobQueue, UnknownKindIsAnErrorThatNamesIt) {
  const testing::ScratchFolder folder;
  const auto queue = OpenJobQueue(folder / "index.db").value();
  ASSERT_TRUE(queue->Submit({.kind = JobKind::kIndex, .input_json = "{}", .now_us = 1}));
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "index.db").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "UPDATE jobs SET kind = 'dance'", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const Error error = queue->Find(1).error();
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.message, HasSubstr("job 1 is of the kind \"dance\""));
  const auto known = queue->Submit({JobKind::kModel, "{}", 20});
  ASSERT_TRUE(known);
  EXPECT_EQ(queue->List(1)->size(), 1U) << "the other is not in the way";
  EXPECT_EQ((*queue->Claim("A", std::array{JobKind::kIndex, JobKind::kModel}, 10, 100))->id, known->id);
}

}  // namespace
}  // namespace victorious
