// Synthetic inputs of the benchmarks: generated from a seed, identical on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "testing/synthetic_flight.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious::bench {

/// A flight over a synthetic town, 640 x 480 px, with four objects on the ground.
testing::SyntheticFlight MakeSyntheticFlight();

/// One of its frames in grey, with about 1300 keypoints.
cv::Mat GreyFrame(const testing::SyntheticFlight& flight, int index = 0);

/// The features of a grey image by the default engine.
/// @param most  the number of strongest features to keep; 0: all
FeatureSet ExtractFeatures(const cv::Mat& grey, int most = 0);

/// A synthetic object, with its alpha channel as mask.
/// @param bgra  CV_8UC4
Photo MakePhoto(const cv::Mat& bgra);

/// A model with one view, the object's photo.
ObjectModel PhotoModel(const testing::SyntheticFlight& flight, int object);

/// Models of the flight's objects with views from all azimuths, up to 70 degrees off nadir: 1 + 7 x 36 = 253 views with
/// the 100 strongest features each (or all, if a view has fewer).
/// @param every  use only every n-th view
std::vector<ObjectModel> MakeAllRoundModels(const testing::SyntheticFlight& flight, int every = 1);

/// The same views of an object of its own for each seed, which is not in the flight.
ObjectModel MakeAllRoundModel(std::uint64_t seed, int every = 1);

/// So many models: those of the flight's objects, and then of others.
std::vector<ObjectModel> MakeAllRoundModels(const testing::SyntheticFlight& flight, int every, std::size_t count);

/// The views of all models, concatenated.
std::vector<FeatureView> CollectViews(const std::vector<ObjectModel>& models);

/// The same as one set.
FeatureSet Concatenate(const std::vector<FeatureView>& views);

/// The features of the first frames of a flight together: four have as many as one frame of a sharp camera.
FeatureSet ExtractFromFrames(const testing::SyntheticFlight& flight, int frames);

/// One row per keypoint as 32-bit floats (CV_32F), the fastest type for OpenCV's matcher.
cv::Mat FloatDescriptors(const FeatureView& features);

/// One template's matches in a scene: `true_matches` inliers of a similarity, with noise as of real keypoints, and
/// `false_matches` random pairs of keypoints.
struct MatchedScene {
  std::vector<Keypoint> scene;
  std::vector<Keypoint> model;
  MatchSet matches;
};
MatchedScene SimulateMatches(std::size_t true_matches, std::size_t false_matches, std::uint64_t seed);

/// The point pairs of the matches, template to scene.
std::vector<PointPair> MakePointPairs(const MatchedScene& scene, const MatchSet& matches);

}  // namespace victorious::bench
