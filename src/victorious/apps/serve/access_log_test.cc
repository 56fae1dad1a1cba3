// The log of who read what: its chain shows every change.
#include "victorious/apps/serve/access_log.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

class AccessLogTest : public ::testing::Test {
 protected:
  void Append(int from, int to) {
    const auto log = AccessLog::Open(path_);
    ASSERT_TRUE(log) << log.error().message;
    for (int i = from; i < to; ++i) {
      ASSERT_TRUE((*log)->Append({.time_utc_us = i,
                                  .actor = "ann \"}\n",
                                  .client = "192.0.2.1",
                                  .target = "/api/v1/objects/" + std::to_string(i),
                                  .status = 200}));
    }
  }
  void Replace(const std::string& text) { ASSERT_TRUE(WriteFileAtomically(path_, text)); }

  testing::ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "access.jsonl";
};

TEST_F(AccessLogTest, GoesOnWhereItEnded) {
  Append(0, 3);
  const std::string half = VerifyAccessLog(path_)->last_hash;
  Append(3, 5);
  const auto whole = VerifyAccessLog(path_);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->entries, 5);
  EXPECT_NE(whole->last_hash, half);
  EXPECT_THAT(ReadFile(path_).value(), HasSubstr(half)) << "a hash that was kept elsewhere is found in the file";
}

TEST_F(AccessLogTest, EveryChangeOfAByteIsFound) {
  Append(0, 2);
  const std::string text = ReadFile(path_).value();
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {  // the last newline: the line is cut off
    std::string changed = text;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    Replace(changed);
    EXPECT_FALSE(VerifyAccessLog(path_)) << "byte " << i;
  }
}

TEST_F(AccessLogTest, LinesThatAreRemovedMovedOrDoubledAreFound) {
  Append(0, 3);
  std::vector<std::string> lines;
  std::ifstream file(path_);
  for (std::string line; std::getline(file, line);) lines.push_back(line + "\n");
  ASSERT_EQ(lines.size(), 4U);
  for (const auto& order : std::vector<std::vector<int>>{{0, 2, 3}, {1, 2, 3}, {0, 2, 1, 3}, {0, 1, 1, 2, 3}}) {
    std::string text;
    for (const int line : order) text += lines[line];
    Replace(text);
    const auto changed = VerifyAccessLog(path_);
    ASSERT_FALSE(changed);
    EXPECT_EQ(changed.error().code, ErrorCode::kDataLoss);
    EXPECT_FALSE(AccessLog::Open(path_)) << "nothing is added to it";
  }
}

TEST_F(AccessLogTest, AServerThatWasKilledLeavesWholeLines) {
  Append(0, 2);
  std::string text = ReadFile(path_).value();
  text.resize(text.size() - 7);
  Replace(text);
  EXPECT_TRUE(VerifyAccessLog(path_)->is_cut_off);
  Append(2, 3);
  const auto after = VerifyAccessLog(path_);
  ASSERT_TRUE(after) << after.error().message;
  EXPECT_EQ(after->entries, 2);
  EXPECT_FALSE(after->is_cut_off);
}

TEST_F(AccessLogTest, HasOneWriter) {
  const auto first = AccessLog::Open(path_);
  ASSERT_TRUE(first);
  const auto second = AccessLog::Open(path_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kConflict);
}

}  // namespace
}  // namespace victorious
