#include "victorious/base/warning_list.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(WarningList, CountsWarningsBeyondTheLimit) {
  WarningList list;
  EXPECT_TRUE(list.empty());
  for (std::size_t i = 0; i < WarningList::kMaxLines; ++i) list.Add("bad row " + std::to_string(i));
  EXPECT_EQ(list.Lines().size(), WarningList::kMaxLines);
  list.Add("bad row");
  list.Add("bad row");
  ASSERT_EQ(list.Lines().size(), WarningList::kMaxLines + 1);
  EXPECT_EQ(list.Lines()[0], "bad row 0");
  EXPECT_EQ(list.Lines().back(), "and 2 more warnings of this kind");
}

TEST(WarningList, AppendAddsTheCounts) {
  WarningList all;
  WarningList part;
  for (std::size_t i = 0; i < WarningList::kMaxLines + 3; ++i) part.Add("damage");
  all.Add("first");
  all.Append("stream 2: ", part);
  const std::vector<std::string> lines = all.Lines();
  ASSERT_EQ(lines.size(), WarningList::kMaxLines + 1);
  EXPECT_EQ(lines[1], "stream 2: damage");
  EXPECT_EQ(lines.back(), "and 4 more warnings of this kind");
}

TEST(WarningList, AddOnceKeepsOneOfEqualLinesAndCountsBeyondTheLimit) {
  WarningList list;
  list.AddOnce("bad packet");
  list.AddOnce("bad packet");
  EXPECT_EQ(list.Lines(), std::vector<std::string>{"bad packet"});
  for (std::size_t i = 0; i < WarningList::kMaxLines + 2; ++i) list.AddOnce("packet " + std::to_string(i));
  list.AddOnce("bad packet");
  ASSERT_EQ(list.Lines().size(), WarningList::kMaxLines + 1);
  EXPECT_EQ(list.Lines().back(), "and 3 more warnings of this kind");
}

}  // namespace
}  // namespace victorious
