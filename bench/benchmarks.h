// The benchmarks. Each generates its input (not timed), then compares our implementation with reference
// implementations (peers).
#pragma once

#include <filesystem>
#include <vector>

#include "bench/harness.h"
#include "victorious/base/error.h"

namespace victorious::bench {

struct Settings {
  bool quick = false;           ///< small input, timed once: a smoke test
  bool large = false;           ///< input that takes long to make
  std::filesystem::path cache;  ///< folder of the models and flights that `index` makes; created if it does not exist

  [[nodiscard]] Effort effort() const { return quick ? Effort::Quick() : Effort{}; }
};

/// Feature extraction by the engine `sift` from frames of 640 x 480 and 1920 x 1080 px, on one thread, and on two
/// where two processors may be used; peers: cv::SIFT with the same settings and threads, and on one thread VLFeat.
std::vector<Result> BenchSift(const Settings& settings);

/// Matching of a frame against 4 models x 253 views of about 100 features; peer: cv::BFMatcher, view by view. Also a
/// part of that by each of our kernels.
std::vector<Result> BenchMatch(const Settings& settings);

/// The four nearest of the descriptors of four frames for those of 44 templates. Peers: cv::BFMatcher, faiss (flat,
/// inverted file, HNSW), hnswlib, and FLANN's k-d trees. The figures have the time that each index takes to build,
/// which the medians leave out, and the fraction of queries whose nearest it finds.
std::vector<Result> BenchNeighbours(const Settings& settings);

/// The four nearest descriptors of a frame, and of four frames together, for every descriptor of 25 models x 253 views,
/// on a CUDA device; the frame's travel to it, the templates' are there. Peers: the same with the results copied back,
/// and the processor, on one core. Errors: kUnsupported without a device; kInternal for other results than the
/// processor's.
[[nodiscard]] Expected<std::vector<Result>> BenchDevice(const Settings& settings);

/// The cascade on one template's matches in a scene of about 1300 keypoints; as many matches as in the thesis's
/// tables 3.2 and 3.3 for ratios 0.8 and 0.95; peer: the reference implementation.
std::vector<Result> BenchCascade(const Settings& settings);

/// MLESAC for a similarity, on the matches that the cascade keeps and on 80 matches with 60 inliers; peer:
/// cv::estimateAffinePartial2D.
std::vector<Result> BenchMlesac(const Settings& settings);

/// Feature extraction and recognition of a frame on one core: against 2 photos, and against 4 models x 253 views.
std::vector<Result> BenchFrame(const Settings& settings);

/// One frame, one core: 1 to 400 models of 253 views, and 5 models in frames of 320 x 240 to 1920 x 1440 px. Peer, up
/// to 25 models: cv::SIFT, cv::BFMatcher, the ratio test and a similarity by RANSAC, view by view.
std::vector<Result> BenchGrowth(const Settings& settings);

/// Whole frames of movies, searched and tracked as `victorious index` does it, for 4 and 25 CAD models (with the
/// project's own: 4 and 14), on one core; processor time of each stage and of the start of the video. Peer: cv::SIFT on
/// those frames. Errors: kNotFound without models, those of the index.
[[nodiscard]] Expected<std::vector<Result>> BenchIndex(const Settings& settings);

/// The search by image in one hour of video with one kept frame per second, on all cores.
std::vector<Result> BenchSearch(const Settings& settings);

/// The queue of tasks in PostgreSQL: claims and completions of 1 to 512 workers at once, each with a connection of its
/// own, on a server that syncs every commit (median_ms is the time for each task, of all workers together); and of
/// workers that hold each task for some time. Peer: two commits of one inserted row, the least that a durable claim and
/// completion can take. Error: kUnsupported without PostgreSQL or PostGIS.
[[nodiscard]] Expected<std::vector<Result>> BenchQueue(const Settings& settings);

/// Geolocation from 1000 lines of sight with 40 % outliers: RANSAC alone, and complete methods. Also the numbers of
/// 1000 random trials in which the place is within 3 sigma and 95 % of the inliers are kept.
std::vector<Result> BenchLocate(const Settings& settings);

/// Data association after one more video, in indexes of 10, 40 and 160 videos of 1000 sightings, on all cores. With
/// `settings.large`, in one of 2500 videos, each of another town: 50,000 objects, 5 million sightings. Peer: the first
/// data association of the index, which makes all fits. Errors: those of the store.
[[nodiscard]] Expected<std::vector<Result>> BenchAssociate(const Settings& settings);

/// Tracking through 15 frames of 640 x 480 px: four regions of 50 points by Lucas-Kanade, and a user box; peers of the
/// box: cv::TrackerCSRT, cv::TrackerKCF, cv::TrackerMIL.
std::vector<Result> BenchTrack(const Settings& settings);

}  // namespace victorious::bench
