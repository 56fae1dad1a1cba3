// The benchmarks, by name. Each makes its own input, untimed, then compares ours with its peers.
#pragma once

#include <vector>

#include "bench/harness.h"

namespace victorious::bench {

struct Settings {
  bool quick = false;  ///< small input, timed once: only to see that everything runs

  [[nodiscard]] Effort effort() const { return quick ? Effort::Quick() : Effort{}; }
};

/// The features of a frame of 640 x 480 px; peer: cv::SIFT called directly.
std::vector<Result> BenchSift(const Settings& settings);

/// A frame against 4 models x 253 views of some 100 features; peer: cv::BFMatcher, view by view. And a part of that by
/// each of our kernels.
std::vector<Result> BenchMatch(const Settings& settings);

/// One template's matches in a scene of some 1300 keypoints, as many as the thesis's tables 3.2 and 3.3 tell of ratio
/// 0.8 and 0.95; peer: the definition.
std::vector<Result> BenchCascade(const Settings& settings);

/// The similarity from what the cascade leaves, and from 80 matches of which 60 are true; peer:
/// cv::estimateAffinePartial2D.
std::vector<Result> BenchMlesac(const Settings& settings);

/// A whole frame, features and recognition, on one core: against 2 photos, and against 4 models x 253 views.
std::vector<Result> BenchFrame(const Settings& settings);

/// The search by picture through an hour of video, one frame a second kept, on all cores.
std::vector<Result> BenchSearch(const Settings& settings);

/// The place of 1000 lines of sight of which 40 % are wrong: RANSAC alone, and whole methods; and in how many of 1000
/// draws the place is right and the true lines are kept.
std::vector<Result> BenchLocate(const Settings& settings);

/// 15 frames of 640 x 480 px: four regions of 50 points followed by Lucas-Kanade; and a drawn box; peers:
/// cv::TrackerCSRT, cv::TrackerKCF, cv::TrackerMIL.
std::vector<Result> BenchTrack(const Settings& settings);

}  // namespace victorious::bench
