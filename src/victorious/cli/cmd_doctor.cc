// victorious doctor [FILE]: what this machine offers, or what a file holds and what is missing for which result
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core.hpp>

#include "victorious/base/version.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/kernels/nearest.h"
#include "victorious/pipeline/video_telemetry.h"
#include "victorious/store/index_store.h"
#include "victorious/store/model_file.h"
#include "victorious/video/codecs.h"
#include "victorious/video/video_reader.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;

std::string GpuText() {
  std::error_code error;
  const bool nvidia = fs::exists("/dev/nvidia0", error);
  const bool other = fs::exists("/dev/dri/renderD128", error);
  if (!nvidia && !other) return "none here (and none is needed)";
  return fmt::format("{} is there; this version does not use it", nvidia ? "an NVIDIA one" : "one");
}

std::string Machine() {
  const CodecReport codecs = DescribeCodecs();
  return fmt::format(
      "victorious {}\n"
      "  processors       {}\n"
      "  matching kernel  {}\n"
      "  feature engines  {}\n"
      "  video            {}\n"
      "  decoders         {}{}\n"
      "  drawn videos     {}\n"
      "  pictures         OpenCV {}\n"
      "  GPU              {}\n",
      kVersion, std::thread::hardware_concurrency(), kernels::NearestTwoTarget(), fmt::join(FeatureEngines(), ", "),
      codecs.libraries, fmt::join(codecs.decoders, ", "),
      codecs.missing.empty() ? "" : fmt::format("; missing: {}", fmt::join(codecs.missing, ", ")),
      codecs.h264_encoder ? "H.264 (libx264)" : "cannot be encoded here: libx264 is missing", CV_VERSION, GpuText());
}

// What was read of a video to describe it.
struct Probe {
  std::int64_t frames = 0;
  double last_time_s = 0;
  bool at_end = false;
  std::vector<DataPacket> packets;
};

Expected<Probe> ReadBeginning(VideoReader& reader) {
  constexpr std::int64_t kMostFrames = 300;
  Probe probe;
  while (probe.frames < kMostFrames) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader.NextFrame());
    if (!frame) {
      probe.at_end = true;
      break;
    }
    ++probe.frames;
    probe.last_time_s = frame->time_s;
    std::ranges::move(reader.TakeDataPackets(), std::back_inserter(probe.packets));
  }
  std::ranges::move(reader.TakeDataPackets(), std::back_inserter(probe.packets));
  return probe;
}

std::string Indented(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += fmt::format("  {}\n", OneLine(line));
  return text;
}

// What is known of the camera, from the file itself or from what lies beside it.
std::string PlaceText(const std::string& source, const Probe& probe) {
  const auto inside = TelemetryFromPackets(probe.packets, {});
  if (inside && inside->records > 0) return "telemetry in the file\n" + Indented(DescribeTelemetry(*inside));
  const auto beside = TelemetryBeside(source);
  if (!beside) {
    return "impossible: no telemetry\n"
           "  missing: KLV or a DJI aircraft's subtitles in the file, or a .SRT or .telemetry.csv beside it\n";
  }
  const auto telemetry = ReadTelemetry(beside->string(), {});
  const std::string place = fmt::format("telemetry beside it, {}\n", OneLine(beside->string()));
  return place + Indented(telemetry ? DescribeTelemetry(*telemetry) : std::vector{telemetry.error().message});
}

Expected<std::string> DescribeVideo(const std::string& source) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(source, {.data_packets = true}));
  const VideoInfo info = reader->info();
  VICTORIOUS_ASSIGN_OR_RETURN(const Probe probe, ReadBeginning(*reader));
  std::string text =
      fmt::format("{}\n  container  {}\n  picture    {} x {} px, {}{}{}{}\n", source, info.container, info.width,
                  info.height, info.codec, info.frame_rate > 0 ? fmt::format(", {:.3g} frames/s", info.frame_rate) : "",
                  info.pixel_aspect != 1 ? fmt::format(", pixels of {:.4g}:1 made square", info.pixel_aspect) : "",
                  info.rotation_deg != 0 ? fmt::format(", turned {} degrees to stand upright", info.rotation_deg) : "");
  text += fmt::format(
      "  length     {}{}\n",
      info.duration_s ? fmt::format("{:.2f} s by the container", *info.duration_s) : "not told by the container",
      probe.at_end
          ? fmt::format("; {} frames, the last at {:.2f} s", probe.frames, probe.last_time_s)
          : fmt::format("; the first {} frames ({:.2f} s) were read for this report", probe.frames, probe.last_time_s));
  for (const StreamInfo& stream : info.streams)
    text += fmt::format("  stream {}   {} ({})\n", stream.index, stream.type, stream.codec);
  for (const std::string& warning : reader->warnings()) text += fmt::format("  damage     {}\n", warning);
  text += "Finding objects: everything needed is there.\n";
  text += "Placing them on the map: " + PlaceText(source, probe);
  return text;
}

Expected<std::string> DescribeModel(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectModel model, ReadModelFile(path));
  return fmt::format("{}\n  a model: {}, {} views from {}, {} features ({}), by version {}\n", path, model.name,
                     model.views.size(), model.kind, model.features.size(), model.engine, model.program_version);
}

Expected<std::string> DescribeIndex(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenSqliteStore(path, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto videos, store->Videos());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto models, store->Models());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto objects, store->Objects({}));
  std::string text = fmt::format("{}\n  an index: {} videos, {} models, {} objects\n", path, videos.size(),
                                 models.size(), objects.size());
  for (const VideoRecord& video : videos) {
    std::string state;
    for (const ModelRecord& model : models) {
      VICTORIOUS_ASSIGN_OR_RETURN(const auto search, store->FindSearch(video.id, model.id));
      const std::string progress = !search            ? "not searched"
                                   : search->finished ? "searched to the end"
                                                      : fmt::format("searched up to frame {}", search->next_frame);
      state += fmt::format("    {}: {}\n", model.name, progress);
    }
    text += fmt::format("  {}: {} x {} px{}\n{}", video.name, video.width, video.height,
                        video.frame_count ? fmt::format(", {} frames", *video.frame_count) : "", state);
  }
  return text;
}

Expected<std::string> DescribeTelemetryFile(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, ReadTelemetry(path, {}));
  return fmt::format("{}\n{}", path, Indented(DescribeTelemetry(telemetry)));
}

// By the file's first bytes, whatever it is called.
Expected<std::string> Describe(const std::string& path) {
  std::array<char, 16> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  const std::string_view bytes(head.data(), head.size());
  if (bytes.starts_with("SQLite format 3")) return DescribeIndex(path);
  if (bytes.starts_with("\x8AVMDL")) return DescribeModel(path);
  if (IsTelemetryFile(path)) return DescribeTelemetryFile(path);
  return DescribeVideo(path);
}

}  // namespace

Action SetUpDoctor(CLI::App& app) {
  const auto file = std::make_shared<std::string>();
  app.add_option("FILE", *file,
                 "A video, a folder of frames, a picture, telemetry, a model (.vmodel) or an index (.db); without it, "
                 "this machine");
  return [=]() -> Status {
    if (file->empty()) return WriteOutput("", Machine());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, Describe(*file));
    return WriteOutput("", text);
  };
}

}  // namespace victorious::cli
