// What the benchmarks run on: drawn by seed, the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "testing/synthetic_flight.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/model/photo_model.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious::bench {

/// A flight over a drawn town, 640 x 480 px, with four things on the ground.
testing::SyntheticFlight DrawnFlight();

/// One of its frames, grey, with some 1300 keypoints.
cv::Mat GreyFrame(const testing::SyntheticFlight& flight, int index = 0);

/// The features of a grey picture by the default engine.
/// @param most  the strongest so many; 0: all
FeatureSet FeaturesOf(const cv::Mat& grey, int most = 0);

/// A drawn thing, cut out by its alpha channel.
/// @param bgra  CV_8UC4
Photo PhotoOf(const cv::Mat& bgra);

/// The thing's photo as a model of one view.
ObjectModel PhotoModel(const testing::SyntheticFlight& flight, int thing);

/// Each of the flight's things as a camera sees it from all around, down to 70 degrees off nadir: 1 + 7 x 36 = 253
/// views of the 100 strongest features each (or fewer, where a view has fewer).
/// @param every  only each so-many-th view
std::vector<ObjectModel> AllRoundModels(const testing::SyntheticFlight& flight, int every = 1);

/// The views of all models, one after the other.
std::vector<FeatureView> ViewsOf(const std::vector<ObjectModel>& models);

/// One template's matches in a scene: `true_matches` as a similarity puts them, with the noise of real keypoints; the
/// rest between any two keypoints.
struct MatchedScene {
  std::vector<Keypoint> scene;
  std::vector<Keypoint> model;
  MatchSet matches;
};
MatchedScene DrawnMatches(std::size_t true_matches, std::size_t false_matches, std::uint64_t seed);

/// The matches' places, template to scene.
std::vector<PointPair> PairsOf(const MatchedScene& scene, const MatchSet& matches);

}  // namespace victorious::bench
