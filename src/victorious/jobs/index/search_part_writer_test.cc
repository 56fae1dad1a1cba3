#include "victorious/jobs/index/search_part_writer.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class SearchPartWriterTest : public ::testing::Test {
 protected:
  // What was written since the last call.
  std::vector<std::string> Written() {
    IndexBatch batch;
    writer_.MoveTo(batch);
    std::vector<std::string> texts;
    for (const SearchPart& part : batch.parts) {
      EXPECT_EQ(part.video, 7);
      texts.push_back(fmt::format("{} {} [{}, {}) {:g} to {:g}", part.model, ToText(part.kind), part.from_frame,
                                  part.to_frame, part.from_s, part.to_s));
    }
    return texts;
  }

  // Enters frames [from, to), ten a second.
  void Enter(std::int64_t from, std::int64_t to, double shift_s = 0, std::optional<DamagedTime> damaged = {}) {
    for (std::int64_t frame = from; frame < to; ++frame) {
      writer_.Enter(frame, shift_s + 0.1 * static_cast<double>(frame), false, std::exchange(damaged, std::nullopt));
    }
  }

  std::vector<SearchRecord> searches_ = {
      {.video = 7, .model = 1, .next_frame = 0, .finished = false, .options_json = {}, .program_version = {}}};
  SearchPartWriter writer_{searches_, 1};
};

TEST_F(SearchPartWriterTest, APartGrows) {
  Enter(0, 20);
  EXPECT_THAT(Written(), ElementsAre("1 searched [0, 20) 0 to 1.9"));
  EXPECT_THAT(Written(), IsEmpty()) << "nothing has changed";
  Enter(20, 30);
  writer_.ExtendTo(29, 2.9);
  EXPECT_THAT(Written(), ElementsAre("1 searched [0, 30) 0 to 2.9"));
}

TEST_F(SearchPartWriterTest, DamageLiesBetweenTwoParts) {
  Enter(0, 20);
  Enter(20, 30, 3, DamagedTime{1.9, 5});
  writer_.EnterDamage({5.9, 8});
  EXPECT_THAT(Written(), ElementsAre("1 searched [0, 20) 0 to 1.9", "1 damaged [20, 20) 1.9 to 5",
                                     "1 searched [20, 30) 5 to 5.9", "1 damaged [30, 30) 5.9 to 8"));
}

TEST_F(SearchPartWriterTest, FramesThatAreMissingEndAPart) {
  Enter(0, 20);
  Enter(80, 90);
  EXPECT_THAT(Written(), ElementsAre("1 searched [0, 20) 0 to 1.9", "1 searched [80, 90) 8 to 8.9"));
}

TEST_F(SearchPartWriterTest, IsThinnedUntilNoSearchWasLeftOutForSomeTime) {
  Enter(0, 20);
  writer_.Enter(20, 2, true, {});
  Enter(21, 100);
  writer_.Enter(100, 10, true, {});
  Enter(101, 210);
  EXPECT_THAT(Written(), ElementsAre("1 searched [0, 20) 0 to 1.9", "1 thinned [20, 200) 2 to 19.9",
                                     "1 searched [200, 210) 20 to 20.9"));
}

TEST_F(SearchPartWriterTest, ResumesTheStoredPart) {
  searches_.front().next_frame = 20;
  SearchPart stored{.video = 7, .model = 1, .kind = {}, .from_frame = 0, .to_frame = 20, .from_s = 0, .to_s = 1.9};
  writer_.Resume({&stored, 1});
  EXPECT_THAT(Written(), IsEmpty());
  Enter(20, 25);
  EXPECT_THAT(Written(), ElementsAre("1 searched [0, 25) 0 to 2.4"));
}

TEST_F(SearchPartWriterTest, DoesNotResumeAnotherPart) {
  searches_.front().next_frame = 20;
  SearchPart stored{.video = 7, .model = 1, .kind = {}, .from_frame = 0, .to_frame = 10, .from_s = 0, .to_s = 0.9};
  writer_.Resume({&stored, 1});
  Enter(20, 25);
  EXPECT_THAT(Written(), ElementsAre("1 searched [20, 25) 2 to 2.4"));
}

}  // namespace
}  // namespace victorious
