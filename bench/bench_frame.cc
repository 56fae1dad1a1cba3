#include <string>
#include <utility>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious::bench {
namespace {

Result TimeFrame(std::string name, std::vector<ObjectModel> models, SearchMethod method, const cv::Mat& frame,
                 const Settings& settings) {
  const std::size_t views = CollectViews(models).size();
  const auto extractor = MakeFeatureExtractor({}).value();
  RecognizeOptions options;
  options.method = method;
  const Recognizer recognizer = Recognizer::Create(std::move(models), FeatureOptions().engine, options).value();
  const Implementation ours = {"victorious", [&] {
                                 const FeatureSet features = extractor->Extract(frame).value();
                                 return static_cast<double>(recognizer.Recognize(features).value().size());
                               }};
  Result result = Compare(std::move(name), ours, {}, settings.effort());
  result.figures = {{"frames_per_s", 1000 / result.median_ms},
                    {"keypoints", static_cast<double>(ExtractFeatures(frame).size())},
                    {"views", static_cast<double>(views)},
                    {"found", ours.run()}};
  return result;
}

}  // namespace

std::vector<Result> BenchFrame(const Settings& settings) {
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const cv::Mat frame = GreyFrame(flight);
  const int every = settings.quick ? 50 : 1;
  return {TimeFrame("frame", {PhotoModel(flight, 0), PhotoModel(flight, 1)}, SearchMethod::kGrammar, frame, settings),
          TimeFrame("frame_4x253", MakeAllRoundModels(flight, every), SearchMethod::kGrammar, frame, settings),
          TimeFrame("frame_4x253_votes", MakeAllRoundModels(flight, every), SearchMethod::kVotes, frame, settings)};
}

}  // namespace victorious::bench
