#include "victorious/jobs/index/index_options.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

VideoInfo VideoOf(double frame_rate) {
  VideoInfo info;
  info.frame_rate = frame_rate;
  return info;
}

TEST(MakeSearchIntervals, FollowTheFrameRate) {
  const IndexOptions options;
  EXPECT_EQ(MakeSearchIntervals(options, VideoOf(30)), (SearchIntervals{.models = 9, .categories = 1, .tracked = 3}));
  EXPECT_EQ(MakeSearchIntervals(options, VideoOf(10)), (SearchIntervals{.models = 3, .categories = 1}));
  EXPECT_EQ(MakeSearchIntervals(options, VideoOf(1)), (SearchIntervals{.models = 1, .categories = 1}));
  EXPECT_EQ(MakeSearchIntervals(options, VideoOf(1e12)),
            (SearchIntervals{.models = 1'000'000, .categories = 1, .tracked = 1000}));
}

TEST(MakeSearchIntervals, AreTheGivenOnes) {
  IndexOptions options;
  options.every = 5;
  EXPECT_EQ(MakeSearchIntervals(options, VideoOf(30)), (SearchIntervals{.models = 5, .categories = 5, .tracked = 3}));
}

TEST(MakeSearchIntervals, AreOneWhereNothingIsTracked) {
  const SearchIntervals all{.models = 1, .categories = 1};
  const IndexOptions options;
  EXPECT_EQ(MakeSearchIntervals(options, VideoOf(0)), all) << "unknown";
  VideoInfo folder = VideoOf(10);
  folder.of_images = true;
  EXPECT_EQ(MakeSearchIntervals(options, folder), all);
  IndexOptions untracked;
  untracked.follow.enabled = false;
  EXPECT_EQ(MakeSearchIntervals(untracked, VideoOf(30)), all);
}

}  // namespace
}  // namespace victorious
