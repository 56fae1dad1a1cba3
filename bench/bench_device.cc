// The exhaustive search for the four nearest descriptors on a CUDA device: 25 models of 253 views in one frame.
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/kernels/nearest_device.h"

namespace victorious::bench {
namespace {

constexpr std::size_t kNearest = 4;  // ranked matches a keypoint, as the vote search by default

// The distances of all views to one frame, by the device and by the processor.
class DeviceSearch {
 public:
  DeviceSearch(kernels::NearestDevice& device, const FeatureSet& scene, const std::vector<ObjectModel>& models)
      : device_(device), scene_(kernels::Pack(scene.descriptors)) {
    for (const FeatureView& view : CollectViews(models)) {
      templates_.push_back(kernels::PackQueries(view.descriptors));
      descriptors_ += templates_.back().count;
    }
    queries_ = device.Upload(templates_);
    found_.resize(descriptors_ * kNearest);
  }

  [[nodiscard]] std::size_t descriptors() const { return descriptors_; }
  [[nodiscard]] std::size_t views() const { return templates_.size(); }

  // The frame's descriptors travel to the device; the templates' are there.
  // @param copies  the results travel back
  double OnDevice(bool copies) {
    const auto scene = device_.Upload(scene_);
    const bool done =
        queries_ && scene &&
        device_.FindNearestK(*queries_, *scene, kNearest, copies ? std::span(found_) : std::span<kernels::Neighbour>());
    return done ? found_.front().distance2 : -1;
  }

  double OnProcessor() {
    std::size_t first = 0;
    for (const kernels::PackedQueries& one : templates_) {
      kernels::FindNearestK(one, scene_, kNearest, std::span(found_).subspan(first * kNearest, one.count * kNearest));
      first += one.count;
    }
    return found_.front().distance2;
  }

  // True if both give the same results.
  bool Agrees() {
    if (OnDevice(true) < 0) return false;
    const std::vector<kernels::Neighbour> of_device = found_;
    OnProcessor();
    return found_ == of_device;
  }

 private:
  kernels::NearestDevice& device_;
  kernels::PackedDescriptors scene_;
  std::vector<kernels::PackedQueries> templates_;
  std::size_t descriptors_ = 0;
  std::unique_ptr<const kernels::DeviceQueries> queries_;
  std::vector<kernels::Neighbour> found_;
};

}  // namespace

Expected<std::vector<Result>> BenchDevice(const Settings& settings) {
  std::string why_not;
  const std::shared_ptr<kernels::NearestDevice> device = kernels::OpenNearestDevice(why_not);
  if (!device) return Fail(ErrorCode::kUnsupported, why_not);
  const std::size_t count = settings.quick ? 1 : 25;
  const int every = settings.quick ? 50 : 1;
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const std::vector<ObjectModel> models = MakeAllRoundModels(flight, every, count);

  std::vector<Result> results;
  for (const int frames : {1, 4}) {  // the keypoints of so many frames together
    const FeatureSet scene = ExtractFromFrames(flight, frames);
    DeviceSearch search(*device, scene, models);
    if (!search.Agrees()) {
      return Fail(ErrorCode::kInternal,
                  fmt::format("{}: other results than the processor's ({})", device->name(), device->last_error()));
    }
    Result result = Compare(
        fmt::format("device_{}x{}_{}", count, models.front().views.size(), frames == 1 ? "1_frame" : "4_frames"),
        {"device", [&] { return search.OnDevice(false); }},
        {{"device_with_results_copied", [&] { return search.OnDevice(true); }},
         {"processor", [&] { return search.OnProcessor(); }}},
        settings.effort());
    result.figures = {{"keypoints", static_cast<double>(scene.size())},
                      {"views", static_cast<double>(search.views())},
                      {"descriptors", static_cast<double>(search.descriptors())},
                      {"scenes_per_s", 1000 / result.median_ms}};
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace victorious::bench
