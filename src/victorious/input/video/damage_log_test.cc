#include "victorious/input/video/damage_log.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(DamageLog, HasOneLinePerKind) {
  DamageLog log;
  log.Add("a bad packet", 1.2);
  log.Add("another object", 2);
  EXPECT_EQ(log.lines().front(), "at 1.20 s: a bad packet");
  log.Add("a bad packet", 3);
  log.Add("a bad packet", 5.1);
  log.AddLine("the end");
  ASSERT_EQ(log.lines().size(), 3U);
  EXPECT_EQ(log.lines()[0], "at 1.20 s, and 2 times more until 5.10 s: a bad packet");
  EXPECT_EQ(log.lines()[2], "the end");
}

TEST(DamageLog, NotesAreNoDamage) {
  DamageLog log;
  log.AddNote("dark");
  EXPECT_FALSE(log.has_damage());
  EXPECT_EQ(log.notes(), log.lines());
  log.Add("a bad packet", 1.2);
  EXPECT_TRUE(log.has_damage());
  EXPECT_EQ(log.notes().size(), 1U);
  EXPECT_EQ(log.lines().size(), 2U);
}

}  // namespace
}  // namespace victorious
