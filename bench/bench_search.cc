#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <thread>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "testing/data.h"
#include "victorious/show/search_image.h"
#include "victorious/store/index_store.h"

namespace victorious::bench {
namespace {

constexpr int kKeypoints = 1300;  // per frame

// An index of one video with `frames` kept frames, one per second: the flight's frames repeated.
std::unique_ptr<IndexStore> MakeIndex(const std::filesystem::path& path, const testing::SyntheticFlight& flight,
                                      int frames) {
  constexpr int kDrawnFrames = 30;
  FeatureOptions options;
  options.max_features = kKeypoints;
  std::vector<FeatureSet> drawn;
  for (int i = 0; i < std::min(kDrawnFrames, frames); ++i) {
    const int index = i * flight.options().frames / kDrawnFrames;
    drawn.push_back(ExtractFeatures(GreyFrame(flight, index), kKeypoints));
  }
  std::unique_ptr<IndexStore> store = OpenSqliteStore(path, StoreMode::kCreate).value();
  const VideoRecord video =
      store->PutVideo({.content_id = "drawn", .name = "drawn.mp4", .width = 640, .height = 480}).value();
  store->SetVideoFeatures(video.id, OptionsToJsonText(options)).value();
  IndexBatch batch;
  for (int i = 0; i < frames; ++i) {
    batch.kept_frames.push_back(
        {video.id, i, static_cast<double>(i), drawn[static_cast<std::size_t>(i) % drawn.size()]});
    if (batch.kept_frames.size() == 100 || i + 1 == frames) {
      store->Commit(batch).value();
      batch.kept_frames.clear();
    }
  }
  return store;
}

}  // namespace

std::vector<Result> BenchSearch(const Settings& settings) {
  const int frames = settings.quick ? 5 : 3600;
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const testing::ScratchFolder folder;
  const std::unique_ptr<IndexStore> store = MakeIndex(folder / "index.db", flight, frames);
  const Photo example = MakePhoto(flight.ObjectPhoto(0));
  const auto search = [&] {
    const std::vector<VideoSegment> moments = SearchByImage(example, {}, {}, *store).value().segments;
    int found = 0;
    for (const VideoSegment& moment : moments) found += moment.frames;
    return static_cast<double>(found);
  };
  Result result = Compare("search", {"victorious", search}, {}, settings.effort());
  result.figures = {{"kept_frames", static_cast<double>(frames)},
                    {"keypoints", static_cast<double>(kKeypoints)},
                    {"frames_found", search()},
                    {"cores", static_cast<double>(std::thread::hardware_concurrency())}};
  return {result};
}

}  // namespace victorious::bench
