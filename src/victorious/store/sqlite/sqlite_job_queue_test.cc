// What the contract of JobQueue (job_queue_test.cc) cannot say: rows that no program of this version writes.
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
  const auto queue = OpenSqliteJobQueue(folder / "index.db").value();
  ASSERT_TRUE(queue->Submit({.kind = JobKind::kIndex, .input_json = "{}", .now_us = 1}));
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "index.db").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "UPDATE jobs SET kind = 'dance'", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  for (const Error& error : {queue->List(1).error(), queue->Claim("A", 10, 100).error()}) {
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message, HasSubstr("job 1 is of the kind \"dance\""));
  }
}

}  // namespace
}  // namespace victorious
