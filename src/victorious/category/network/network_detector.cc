#include "victorious/category/network/network_detector.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/isolated_process.h"
#include "victorious/category/network/box_suppression.h"
#include "victorious/category/network/decode_outputs.h"
#include "victorious/category/network/image_placement.h"
#include "victorious/category/network/input_size.h"
#include "victorious/category/network/network_request.h"
#include "victorious/category/network/output_layout.h"

namespace victorious {
namespace {

constexpr std::chrono::seconds kPatience{120};

IsolationLimits LimitsOf(const NetworkFiles& files, bool is_import) {
  constexpr std::uint64_t kMemoryBytes = std::uint64_t{3} << 30;
  constexpr std::uint64_t kCopies = 6;  // of the weights: the message, the file, the layers
  constexpr unsigned kImportSeconds = 120;
  constexpr unsigned kIndexSeconds = 1'000'000'000;  // kPatience limits each answer
  return {.memory_bytes = kMemoryBytes + kCopies * (files.network.size() + files.weights.size()),
          .processor_s = is_import ? kImportSeconds : kIndexSeconds,
          .readable = {}};
}

constexpr AskOptions kAskOptions{.patience = kPatience, .max_answer_bytes = 8 * kMaxOutputValues, .cancel = nullptr};

Status LoadNetwork(IsolatedProcess& process, const NetworkFiles& files) {
  VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const std::string answer,
                              process.Ask(kLoadRequest + PackNetworkFiles(files), kAskOptions));
  return {};
}

Expected<std::vector<NetworkTensor>> RunNetwork(IsolatedProcess& process, const cv::Mat& input,
                                                const DetectorSettings& settings) {
  const NetworkRun run{
      .input = input, .channels = settings.channels, .mean = settings.mean, .deviation = settings.deviation};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string answer, process.Ask(kRunRequest + PackRun(run), kAskOptions));
  return UnpackTensors(answer);
}

DetectorSettings SettingsOf(DetectorLayout layout, cv::Size input, const DetectorImport& import) {
  DetectorSettings settings = DefaultSettings(layout);
  settings.width = input.width;
  settings.height = input.height;
  settings.fit = import.fit.value_or(settings.fit);
  settings.channels = import.channels.value_or(settings.channels);
  settings.resampling = import.resampling.value_or(settings.resampling);
  settings.border = import.border.value_or(settings.border);
  settings.mean = import.mean.value_or(settings.mean);
  settings.deviation = import.deviation.value_or(settings.deviation);
  settings.min_score = import.min_score.value_or(settings.min_score);
  settings.max_overlap = import.max_overlap.value_or(settings.max_overlap);
  return settings;
}

// True if the box reaches a border of the tile that is none of the image.
bool IsCut(const Box& box, const cv::Rect& tile, cv::Size image) {
  constexpr double kMargin_px = 2;
  return (tile.x > 0 && box.x < tile.x + kMargin_px) || (tile.y > 0 && box.y < tile.y + kMargin_px) ||
         (tile.br().x < image.width && box.x + box.width > tile.br().x - kMargin_px) ||
         (tile.br().y < image.height && box.y + box.height > tile.br().y - kMargin_px);
}

}  // namespace

void DetectorOptions::ListFields(FieldList& fields) {
  fields.Add("tiles", tiles,
             {.reason = "an imported detector also searches overlapping tiles of a frame, at full resolution: objects "
                        "that are too small in the whole frame once it is shrunk to the network's input"});
  fields.Add(
      "tile_px", tile_px,
      {.min = 0,
       .max = kMaxInputSide_px,
       .unit = "px",
       .reason = "side of a tile; 0: the size of the network's input. Smaller tiles enlarge small objects, larger "
                 "ones take less time"});
  fields.Add("tile_overlap", tile_overlap,
             {.min = 0,
              .max = 0.9,
              .reason = "minimum overlap of tiles, as a fraction of their side: objects up to this size are whole in "
                        "one of them"});
  fields.Add(
      "min_score", min_score,
      {.min = 0,
       .max = 1,
       .reason = "minimum score of a sighting, the network's own, not calibrated; 0: that of `category import`"});
  fields.Add("interval_s", interval_s,
             {.min = 0,
              .max = 1000,
              .unit = "s",
              .reason = "interval between frames that an imported detector searches, where `every` is 0; in between, "
                        "what it found is tracked"});
}

Expected<DetectorModel> ImportDetector(DetectorModel model, const DetectorImport& import) {
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess process, IsolatedProcess::Start(kRunNetwork, {}));
  process.Confine(LimitsOf(model.files, true));
  VICTORIOUS_RETURN_IF_ERROR(LoadNetwork(process, model.files));
  const cv::Size own = FindInputSize(model.files);
  const cv::Size input = import.input.value_or(own);
  if (input.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "its file has no size of the input: give --input WxH");
  }
  const DetectorSettings first = SettingsOf(import.layout.value_or(DetectorLayout::kYolov8), input, import);
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(first));
  Expected<std::vector<NetworkTensor>> outputs =
      RunNetwork(process, cv::Mat(input, CV_8UC3, cv::Scalar::all(first.border)), first);
  if (!outputs && !own.empty() && own != input && outputs.error().code == ErrorCode::kUnsupported) {
    return std::unexpected(std::move(outputs).error().WithContext(fmt::format(
        "with an input of {}x{}, where its file says {}x{}", input.width, input.height, own.width, own.height)));
  }
  if (!outputs) return std::unexpected(std::move(outputs).error());
  std::vector<std::vector<int>> shapes;
  for (const NetworkTensor& output : *outputs) shapes.push_back(output.shape);
  DetectorLayout layout = first.layout;
  if (!import.layout) {
    VICTORIOUS_ASSIGN_OR_RETURN(layout, RecogniseLayout(shapes, model.classes.size(), input));
  }
  model.settings = SettingsOf(layout, input, import);
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(model.settings));
  VICTORIOUS_RETURN_IF_ERROR(DecodeOutputs(*outputs, model.settings, model.classes.size()));
  return model;
}

// Processes that have loaded the network, each used by one thread at a time.
struct NetworkDetector::Processes {
  DetectorModel model;
  std::mutex mutex;
  std::optional<IsolatedProcess> origin;  // not confined; the others are copies of it
  std::vector<IsolatedProcess> idle;

  [[nodiscard]] Expected<IsolatedProcess> StartOne() {
    std::optional<IsolatedProcess> started;
    {
      const std::scoped_lock lock(mutex);
      VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess copy, origin->Copy());
      started.emplace(std::move(copy));
    }
    started->Confine(LimitsOf(model.files, false));
    VICTORIOUS_RETURN_IF_ERROR(LoadNetwork(*started, model.files));
    return *std::move(started);
  }

  [[nodiscard]] Expected<IsolatedProcess> Take() {
    {
      const std::scoped_lock lock(mutex);
      if (!idle.empty()) {
        IsolatedProcess process = std::move(idle.back());
        idle.pop_back();
        return process;
      }
    }
    return StartOne();
  }

  void Give(IsolatedProcess process) {
    if (!process.IsRunning()) return;
    const std::scoped_lock lock(mutex);
    idle.push_back(std::move(process));
  }

  [[nodiscard]] Expected<std::vector<NetworkBox>> RunOn(const cv::Mat& bgr) {
    const PlacedImage placed = PlaceImage(bgr, model.settings);
    VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess process, Take());
    Expected<std::vector<NetworkTensor>> outputs = RunNetwork(process, placed.input, model.settings);
    Give(std::move(process));
    if (!outputs) return std::unexpected(std::move(outputs).error());
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<NetworkBox> boxes,
                                DecodeOutputs(*outputs, model.settings, model.classes.size()));
    const Box frame = FrameBox(bgr.cols, bgr.rows);
    for (NetworkBox& box : boxes) box.box = Intersection(placed.ToImage(box.box), frame);
    std::erase_if(boxes, [](const NetworkBox& box) { return box.box.IsEmpty(); });
    return SuppressOverlaps(std::move(boxes), model.settings.max_overlap);
  }
};

NetworkDetector::NetworkDetector(DetectorModel model, const DetectorOptions& options)
    : processes_(std::make_unique<Processes>()), options_(options) {
  processes_->model = std::move(model);
  if (options.min_score > 0) processes_->model.settings.min_score = options.min_score;
}

NetworkDetector::NetworkDetector(NetworkDetector&&) noexcept = default;
NetworkDetector& NetworkDetector::operator=(NetworkDetector&&) noexcept = default;
NetworkDetector::~NetworkDetector() = default;

Expected<NetworkDetector> NetworkDetector::Create(DetectorModel model, const DetectorOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  const std::string source = model.source;
  NetworkDetector detector(std::move(model), options);
  Processes& processes = *detector.processes_;
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess origin, IsolatedProcess::Start(kRunNetwork, {}));
  processes.origin.emplace(std::move(origin));
  Expected<IsolatedProcess> first = processes.StartOne();  // so that a network that cannot be loaded is an error here
  if (!first) return std::unexpected(std::move(first).error().WithContext(source));
  processes.Give(*std::move(first));
  return detector;
}

const DetectorModel& NetworkDetector::model() const { return processes_->model; }

std::vector<cv::Rect> NetworkDetector::PartsOf(cv::Size image) const {
  constexpr double kSameSize = 1.3;  // tiles show little more of an image that is hardly larger
  std::vector<cv::Rect> parts = {cv::Rect({0, 0}, image)};
  const DetectorSettings& settings = model().settings;
  const cv::Size tile =
      options_.tile_px > 0 ? cv::Size(options_.tile_px, options_.tile_px) : cv::Size(settings.width, settings.height);
  if (!options_.tiles || (image.width <= kSameSize * tile.width && image.height <= kSameSize * tile.height)) {
    return parts;
  }
  const std::vector<cv::Rect> tiles = TilesOf(image, tile, options_.tile_overlap);
  parts.insert(parts.end(), tiles.begin(), tiles.end());
  return parts;
}

std::size_t NetworkDetector::RunsOf(cv::Size image) const { return PartsOf(image).size(); }

Expected<std::vector<NetworkBox>> NetworkDetector::Detect(const cv::Mat& bgr) const {
  if (bgr.empty()) return std::vector<NetworkBox>();
  const std::vector<cv::Rect> parts = PartsOf(bgr.size());
  std::vector<Expected<std::vector<NetworkBox>>> found(parts.size());
  oneapi::tbb::parallel_for(std::size_t{0}, parts.size(),
                            [&](std::size_t p) { found[p] = processes_->RunOn(bgr(parts[p])); });
  std::vector<TiledBox> boxes;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (!found[p]) return std::unexpected(std::move(found[p]).error().WithContext(model().source));
    for (NetworkBox& one : *found[p]) {
      one.box.x += parts[p].x;
      one.box.y += parts[p].y;
      const bool is_cut = IsCut(one.box, parts[p], bgr.size());
      boxes.push_back({.found = one, .is_cut = is_cut});
    }
  }
  return MergeTiles(std::move(boxes), model().settings.max_overlap);
}

}  // namespace victorious
