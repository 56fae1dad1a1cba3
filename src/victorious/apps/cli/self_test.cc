#include "victorious/apps/cli/self_test.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/random.h"
#include "victorious/base/sandbox.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/indexer.h"
#include "victorious/kernels/nearest.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/lab/evaluate/truth.h"
#include "victorious/lab/simulate/simulate.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 5;
constexpr double kFramesPerSecond = 3;
constexpr int kWidth = 480;             // px
constexpr int kHeight = 360;            // px
constexpr double kViewStep_deg = 15;    // a quarter of the usual views
constexpr double kMaxPlaceError_m = 1;  // horizontally, with exact telemetry

std::vector<std::uint8_t> RandomDescriptors(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint8_t> rows(count * kernels::kDescriptorBytes);
  for (std::uint8_t& byte : rows) byte = static_cast<std::uint8_t>(random.Next() >> 56U);
  return rows;
}

constexpr std::size_t kQueries = 200;
constexpr std::size_t kDescriptors = 3000;

// The fastest kernel of this processor against the reference.
Expected<std::string> CheckProcessor() {
  const kernels::PackedDescriptors set = kernels::Pack(RandomDescriptors(kDescriptors, 1));
  const kernels::PackedQueries queries = kernels::PackQueries(RandomDescriptors(kQueries, 2));
  std::vector<kernels::NearestTwo> fast(kQueries);
  std::vector<kernels::NearestTwo> reference(kQueries);
  kernels::FindNearestTwo(queries, set, fast);
  kernels::FindNearestTwoRef(queries, set, reference);
  if (fast == reference) return kernels::NearestTwoTargetName();
  return Fail(ErrorCode::kInternal, fmt::format("{} gives other distances than the reference: do not use this machine",
                                                kernels::NearestTwoTargetName()));
}

// The same of a CUDA device. The program does not need one.
Expected<std::string> CheckDevice() {
  constexpr std::size_t kNearest = 4;
  std::string why_not;
  const std::shared_ptr<kernels::NearestDevice> device = kernels::OpenNearestDevice(why_not);
  if (device == nullptr) return "none is used: " + why_not;
  const kernels::PackedDescriptors set = kernels::Pack(RandomDescriptors(kDescriptors, 1));
  const std::vector<kernels::PackedQueries> queries = {kernels::PackQueries(RandomDescriptors(kQueries, 2))};
  std::vector<kernels::Neighbour> computed(kNearest * kQueries);
  std::vector<kernels::Neighbour> expected(kNearest * kQueries);
  kernels::FindNearestK(queries.front(), set, kNearest, expected);
  const auto on_device = device->Upload(set);
  const auto asked = device->Upload(queries);
  if (on_device == nullptr || asked == nullptr || !device->FindNearestK(*asked, *on_device, kNearest, computed)) {
    return Fail(ErrorCode::kInternal, fmt::format("{}: {}", device->name(), device->last_error()));
  }
  if (computed == expected) return std::string(device->name());
  return Fail(ErrorCode::kInternal, fmt::format("{}: gives other distances than the processor", device->name()));
}

// Decoders of hostile files run without rights where the kernel offers that; it should offer seccomp at least.
Expected<std::string> CheckSandbox() {
  const SandboxSupport support = FindSandboxSupport();
  if (support.has_seccomp) return DescribeSandbox(support);
  return Fail(ErrorCode::kUnsupported, DescribeSandbox(support) +
                                           ": files that may be hostile are decoded with the "
                                           "rights of the program");
}

// The checks that build on each other: a flight, its video, a model, the search.
class Chain {
 public:
  Chain(const SampleFiles& sample, fs::path folder, const CancelToken& cancel)
      : sample_(sample), flight_(folder / "flight"), index_(folder / "index.db"), cancel_(cancel) {}

  Expected<std::string> Draw() {
    VICTORIOUS_ASSIGN_OR_RETURN(Scene scene, ReadScene(sample_.scene));
    scene.video.frames = kFrames;
    scene.video.fps = kFramesPerSecond;
    scene.video.width = kWidth;
    scene.video.height = kHeight;
    scene.video.supersampling = 1;
    scene.town.squares = {-1, 0, -1, 1};  // those that it shows
    std::erase_if(scene.objects, [&](const SceneObject& object) { return object.model != Name(); });
    // Along the beginning of the demo's path, where the object is in view.
    std::vector<Eigen::Vector2d>& aim_m = scene.camera.aim_m;
    constexpr double kPart = 0.3;
    aim_m.back() = aim_m.front() + kPart * (aim_m.back() - aim_m.front());
    VICTORIOUS_RETURN_IF_ERROR(Simulate(scene, flight_, {}, cancel_, [](const std::string&) {}));
    return fmt::format("{} frames of {} x {} px", kFrames, kWidth, kHeight);
  }

  Expected<std::string> ReadVideo() {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<VideoReader> reader, VideoReader::Open(Video(), {}));
    int frames = 0;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader->NextFrame());
      if (!frame) break;
      ++frames;
    }
    if (frames == kFrames) return fmt::format("{} frames", frames);
    return Fail(ErrorCode::kDataLoss, fmt::format("{} frames were written, {} are read", kFrames, frames));
  }

  Expected<std::string> MakeModel() {
    VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(sample_.object, {}));
    CadModelOptions options;
    options.sphere.step_deg = kViewStep_deg;
    VICTORIOUS_ASSIGN_OR_RETURN(model_,
                                MakeCadModel(Name(), loaded.mesh, sample_.object.string(), options, {}, &cancel_));
    model_->length_m = loaded.length_m;
    return fmt::format("{}: {} views, {} features", model_->name, model_->views.size(), model_->features.size());
  }

  Expected<std::string> Search() {
    VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create({std::move(*model_)}, {}));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store,
                                OpenStore(index_.string(), StoreMode::kCreate));
    const IndexJob job{.video = Video(), .telemetry = (flight_ / "telemetry.csv").string()};
    VICTORIOUS_RETURN_IF_ERROR(indexer.Index(job, cancel_, *store));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store->Objects({}));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TruthRow> truth, ReadTruth(flight_ / "truth.jsonl"));
    const auto row = std::ranges::find(truth, Name(), &TruthRow::model);
    if (row == truth.end() || !row->place) return Fail(ErrorCode::kInternal, "the flight does not show its object");
    if (objects.size() != 1 || !objects.front().place) {
      return Fail(ErrorCode::kInternal, fmt::format("{} objects are found where one stands", objects.size()));
    }
    const double error_m = TangentPlane(*row->place).EnuFromGeodetic(objects.front().place->point).head<2>().norm();
    if (error_m > kMaxPlaceError_m) {
      return Fail(ErrorCode::kInternal, fmt::format("{} is found {:.2f} m from where it stands", Name(), error_m));
    }
    return fmt::format("{} is found in {} frames, {:.2f} m from where it stands", Name(), objects.front().frames,
                       error_m);
  }

 private:
  [[nodiscard]] std::string Video() const { return (flight_ / "video.mp4").string(); }
  [[nodiscard]] std::string Name() const { return sample_.object.stem().string(); }

  SampleFiles sample_;
  fs::path flight_;
  fs::path index_;
  const CancelToken& cancel_;
  std::optional<ObjectModel> model_;
};

struct Check {
  const char* name;
  std::function<Expected<std::string>()> run;
  bool is_of_chain = false;  // not tried once another one of the chain has failed
};

}  // namespace

Expected<std::vector<SelfTestRow>> RunSelfTest(const SampleFiles& sample, const fs::path& folder,
                                               const CancelToken& cancel,
                                               const std::function<void(const SelfTestRow&)>& report) {
  Chain chain(sample, folder, cancel);
  const std::vector<Check> checks = {
      {"processor", &CheckProcessor},
      {"CUDA device", &CheckDevice},
      {"sandbox", &CheckSandbox},
      {"drawing", [&] { return chain.Draw(); }, true},
      {"video", [&] { return chain.ReadVideo(); }, true},
      {"model", [&] { return chain.MakeModel(); }, true},
      {"search", [&] { return chain.Search(); }, true},
  };
  std::vector<SelfTestRow> rows;
  std::string failed;
  for (const Check& check : checks) {
    SelfTestRow row{.name = check.name};
    if (check.is_of_chain && !failed.empty()) {
      row.text = fmt::format("not tried: {} failed", failed);
    } else {
      const auto begin = std::chrono::steady_clock::now();
      const Expected<std::string> found = check.run();
      if (!found && found.error().code == ErrorCode::kCancelled) return std::unexpected(found.error());
      row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      row.is_good = found.has_value();
      row.text = found ? *found : found.error().message;
      if (check.is_of_chain && !found) failed = check.name;
    }
    report(row);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace victorious::cli
