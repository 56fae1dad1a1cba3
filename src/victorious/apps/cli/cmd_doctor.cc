// victorious doctor [FILE]: describes this machine, or the content of a file and what is missing for which result
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/serve/access_log.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/sandbox.h"
#include "victorious/base/version.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/input/telemetry/telemetry_report.h"
#include "victorious/input/video/codecs.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/kernels/nearest.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/model_file.h"
#include "victorious/place/calibrate/field_of_view.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/place/cameras/clock_offset.h"
#include "victorious/place/cameras/photo_telemetry.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/store/open_store.h"
#include "victorious/store/sqlite/page_checksums.h"
#include "victorious/store/video_coverage.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// One report in two forms: text, and JSON for programs (--json).
struct Report {
  std::string text;
  ordered_json json;
};

std::string GpuText() {
  std::error_code error;
  const bool nvidia = fs::exists("/dev/nvidia0", error);
  const bool other = fs::exists("/dev/dri/renderD128", error);
  if (!nvidia && !other) return "none (not required)";
  return fmt::format("{} is present; this version does not use it", nvidia ? "an NVIDIA GPU" : "a GPU");
}

Report DescribeMachine() {
  const CodecReport codecs = DescribeCodecs();
  const std::string sandbox = DescribeSandbox(FindSandboxSupport());
  std::string text = fmt::format(
      "victorious {}\n"
      "  processors       {}\n"
      "  matching kernel  {}\n"
      "  feature engines  {}\n"
      "  video            {}\n"
      "  decoders         {}{}\n"
      "  video encoder    {}\n"
      "  images           OpenCV {}\n"
      "  sandbox          {}\n"
      "  GPU              {}\n",
      kVersion, std::thread::hardware_concurrency(), kernels::NearestTwoTargetName(), fmt::join(FeatureEngines(), ", "),
      codecs.libraries, fmt::join(codecs.decoders, ", "),
      codecs.missing.empty() ? "" : fmt::format("; missing: {}", fmt::join(codecs.missing, ", ")),
      codecs.h264_encoder ? "H.264 (libx264)" : "unavailable: libx264 is missing", CV_VERSION, sandbox, GpuText());
  return {std::move(text),
          {{"version", kVersion},
           {"processors", std::thread::hardware_concurrency()},
           {"matching_kernel", kernels::NearestTwoTargetName()},
           {"feature_engines", FeatureEngines()},
           {"video", codecs.libraries},
           {"decoders", codecs.decoders},
           {"missing_decoders", codecs.missing},
           {"h264_encoder", codecs.h264_encoder},
           {"opencv", CV_VERSION},
           {"sandbox", sandbox},
           {"gpu", GpuText()}}};
}

// The part of a video that was read to describe it.
struct VideoProbe {
  std::int64_t frames = 0;
  double last_time_s = 0;
  bool at_end = false;
  bool live = false;
  std::vector<DataPacket> packets;
  std::optional<std::string> unread;  // telemetry that is not read
};

Expected<VideoProbe> ProbeVideo(VideoReader& reader, const std::string& source) {
  constexpr std::int64_t kMaxFrames = 300;
  VideoProbe probe{.live = reader.info().live, .packets = {}, .unread = DescribeUnreadTelemetry(reader.info())};
  while (probe.frames < kMaxFrames) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Frame> frame, reader.NextFrame());
    if (!frame) {
      probe.at_end = true;
      break;
    }
    ++probe.frames;
    probe.last_time_s = frame->time_s;
    std::ranges::move(reader.TakeDataPackets(), std::back_inserter(probe.packets));
  }
  std::error_code error;
  const bool is_local_file = std::filesystem::is_regular_file(source, error);
  if (is_local_file) reader.SkipToEnd();  // reads later telemetry, and detects a truncated file
  std::ranges::move(reader.TakeDataPackets(), std::back_inserter(probe.packets));
  return probe;
}

std::string Indented(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += fmt::format("  {}\n", OneLine(line));
  return text;
}

// The offset of telemetry's clock, in one line; a standard error beyond any use is no number.
std::string DescribeClock(const TimeOffset& offset) {
  if (offset.status == TimeOffsetStatus::kUncertain && !(offset.sigma_s < offset.max_offset_s)) {
    return "offset of telemetry's clock: unknown: the camera's motion changes too little to tell it";
  }
  return Describe(offset);
}

// What the motion of the image says about telemetry, as `index` does: the time offset, or why there is none; that it is
// the telemetry of another flight; a wrong field of view. Empty if telemetry has no attitude or the video cannot be
// read a second time.
std::vector<std::string> CompareWithImage(const std::string& source, const VideoProbe& probe,
                                          const Telemetry& telemetry) {
  const TelemetryOptions defaults;
  if (probe.live || !std::ranges::any_of(telemetry.states, &CameraState::IsComplete)) return {};
  TimeOffsetOptions options;
  constexpr double kWatch_s = 20;
  options.max_duration_s = kWatch_s;
  const auto motions = MeasureMotions(source, options, TimedTelemetryOptions().impulse_fraction, Interrupt());
  if (!motions) return {"offset of telemetry's clock: unknown: " + motions.error().message};
  std::vector<CameraState> states = telemetry.states;
  const TimeOffset offset = EstimateTimeOffset(*motions, CameraTrajectory(states, defaults.max_gap_s), options);
  if (const auto contradiction = DescribeContradiction(offset)) return {*contradiction};
  std::vector<std::string> statements = {DescribeClock(offset)};
  for (CameraState& state : states) state.time_s += ClockCorrection(offset).value_or(0);
  const auto errors = MeasureCameraErrors(*motions, CameraTrajectory(std::move(states), defaults.max_gap_s));
  if (const auto wrong = DescribeFieldOfView(JudgeFieldOfView(FocalOf(errors)))) statements.push_back(*wrong);
  if (errors && errors->yaw && SignificantYawError(*errors->yaw)) statements.push_back(DescribeYaw(*errors->yaw));
  return statements;
}

// Describes the telemetry in the file or beside it; JSON null if there is none.
Report DescribeTelemetrySource(const std::string& source, const VideoProbe& probe) {
  const auto inside = TelemetryFromPackets(probe.packets, {});
  if (inside && inside->records > 0) {
    std::vector<std::string> statements = DescribeTelemetry(*inside);
    std::ranges::move(CompareWithImage(source, probe, *inside), std::back_inserter(statements));
    return {"telemetry in the file\n" + Indented(statements), {{"source", source}, {"says", statements}}};
  }
  const auto beside = FindTelemetryFile(source);
  const auto of_photos = !beside && IsOfImages(source) ? ReadTelemetry(source, {}) : Expected<Telemetry>(Telemetry());
  if (of_photos && of_photos->records > 0) {
    const std::vector<std::string> statements = DescribeTelemetry(*of_photos);
    return {"telemetry of the photos (EXIF, XMP)\n" + Indented(statements), {{"source", source}, {"says", statements}}};
  }
  if (!beside) {
    const std::string name = OneLine(std::filesystem::path(source).stem().string());
    return {
        fmt::format("impossible: no telemetry\n{}"
                    "  missing: KLV or an aircraft's subtitles in the file, positions in a folder's photos, {}.SRT or "
                    "{}.telemetry.csv beside it, or a table given to `index --telemetry`\n",
                    probe.unread ? "  " + *probe.unread + "\n" : "", name, name),
        nullptr};
  }
  const auto telemetry = ReadTelemetry(beside->string(), {});
  std::vector<std::string> statements =
      telemetry ? DescribeTelemetry(*telemetry) : std::vector{telemetry.error().message};
  if (telemetry) {
    std::ranges::move(CompareWithImage(source, probe, *telemetry), std::back_inserter(statements));
  }
  return {fmt::format("telemetry beside the file, {}\n", OneLine(beside->string())) + Indented(statements),
          {{"source", beside->string()}, {"says", statements}}};
}

ordered_json StreamsToJson(const VideoInfo& info) {
  ordered_json streams = ordered_json::array();
  for (const StreamInfo& stream : info.streams) {
    streams.push_back(
        {{"index", stream.index}, {"type", ToText(kStreamTypeTexts, stream.type)}, {"codec", stream.codec}});
  }
  return streams;
}

std::vector<std::string> DamageOf(const VideoReader& reader) {
  std::vector<std::string> damage = reader.warnings();
  std::erase_if(
      damage, [&](const std::string& line) { return std::ranges::find(reader.notes(), line) != reader.notes().end(); });
  return damage;
}

Expected<Report> DescribeVideo(const std::string& source) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(source, {.data_packets = true}));
  const VideoInfo info = reader->info();
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoProbe probe, ProbeVideo(*reader, source));
  std::string text = fmt::format(
      "{}\n  container  {}\n  image      {} x {} px, {}{}{}{}\n", source, info.container, info.width, info.height,
      info.codec, info.frame_rate > 0 ? fmt::format(", {:.3g} frames/s", info.frame_rate) : "",
      info.pixel_aspect != 1 ? fmt::format(", pixel aspect ratio {:.4g}:1 corrected", info.pixel_aspect) : "",
      info.rotation_deg != 0 ? fmt::format(", rotated by {} degrees to be upright", info.rotation_deg) : "");
  text += fmt::format(
      "  length     {}{}\n",
      info.duration_s ? fmt::format("{:.2f} s by the container", *info.duration_s) : "not given by the container",
      probe.at_end ? fmt::format("; {}, the last at {:.2f} s", CountText(probe.frames, "frame"), probe.last_time_s)
                   : fmt::format("; the first {} frames ({:.2f} s) were decoded for this report", probe.frames,
                                 probe.last_time_s));
  for (const StreamInfo& stream : info.streams)
    text += fmt::format("  stream {}   {} ({})\n", stream.index, ToText(kStreamTypeTexts, stream.type), stream.codec);
  const std::vector<std::string> damage = DamageOf(*reader);
  for (const std::string& line : reader->notes()) text += fmt::format("  note       {}\n", line);
  for (const std::string& line : damage) text += fmt::format("  damage     {}\n", line);
  text += "Finding objects: possible.\n";
  Report place = DescribeTelemetrySource(source, probe);
  if (Interrupt().IsCancelled()) return Fail(ErrorCode::kCancelled, fmt::format("{}: interrupted", source));
  text += "Geolocating objects: " + place.text;
  return Report{std::move(text),
                {{"file", source},
                 {"kind", "video"},
                 {"container", info.container},
                 {"width", info.width},
                 {"height", info.height},
                 {"codec", info.codec},
                 {"frame_rate", info.frame_rate},
                 {"duration_s", info.duration_s ? ordered_json(*info.duration_s) : ordered_json()},
                 {"frames_read", probe.frames},
                 {"read_to_end", probe.at_end},
                 {"last_time_s", probe.last_time_s},
                 {"streams", StreamsToJson(info)},
                 {"notes", reader->notes()},
                 {"damage", damage},
                 {"telemetry", std::move(place.json)}}};
}

Expected<Report> DescribeModel(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectModel model, ReadModelFile(path));
  return Report{fmt::format("{}\n  a model: {}, {} from {}, {} ({}), by version {}\n", path, model.name,
                            CountText(model.views.size(), "view"), ToText(model.kind),
                            CountText(model.features.size(), "feature"), model.engine, model.program_version),
                {{"file", path},
                 {"kind", "model"},
                 {"name", model.name},
                 {"views", model.views.size()},
                 {"made_from", ToText(model.kind)},
                 {"features", model.features.size()},
                 {"engine", model.engine},
                 {"program_version", model.program_version}}};
}

Expected<Report> DescribeIndex(const std::string& db) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenStore(db, StoreMode::kRead));
  const std::string path = StoreName(db);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto videos, store->Videos());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto models, store->Models());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto objects, store->Objects({}));
  std::string text = fmt::format("{}\n  an index: {}, {}, {}\n", path, CountText(videos.size(), "video"),
                                 CountText(models.size(), "model"), CountText(objects.size(), "object"));
  ordered_json listed = ordered_json::array();
  for (const VideoRecord& video : videos) {
    const std::string name = ShownName(video);
    std::string state;
    ordered_json searches = ordered_json::array();
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> parts, store->SearchParts(video.id));
    for (const ModelRecord& model : models) {
      if (model.IsBoxed()) continue;  // nothing is searched for it
      VICTORIOUS_ASSIGN_OR_RETURN(const auto search, store->FindSearch(video.id, model.id));
      const auto own = std::ranges::equal_range(parts, model.id, {}, &SearchPart::model);
      const SearchCoverage coverage = CoverageOf(video, search ? &*search : nullptr, own);
      std::string progress = !search ? "not searched" : "searched";
      if (search && coverage.left_out.empty()) progress += " to the end";
      if (search && !coverage.left_out.empty()) progress += fmt::format(", {}", CountText(coverage.frames, "frame"));
      ordered_json left_out = ordered_json::array();
      for (const LeftOutTime& one : coverage.left_out) {
        if (search) progress += fmt::format("; {}", DescribeLeftOut(one));
        left_out.push_back({{"from_s", one.from_s},
                            {"to_s", one.to_s ? ordered_json(*one.to_s) : ordered_json()},
                            {"reason", ToText(one.reason)}});
      }
      state += fmt::format("    {}: {}\n", model.name, progress);
      searches.push_back({{"model", model.name},
                          {"next_frame", search ? search->next_frame : 0},
                          {"finished", search && search->finished},
                          {"left_out", std::move(left_out)}});
    }
    text += fmt::format("  {}: {} x {} px{}\n{}", name, video.width, video.height,
                        video.frame_count ? ", " + CountText(*video.frame_count, "frame") : "", state);
    listed.push_back({{"name", name},
                      {"width", video.width},
                      {"height", video.height},
                      {"frames", video.frame_count ? ordered_json(*video.frame_count) : ordered_json()},
                      {"searches", std::move(searches)}});
  }
  return Report{std::move(text),
                {{"file", path},
                 {"kind", "index"},
                 {"models", models.size()},
                 {"objects", objects.size()},
                 {"videos", std::move(listed)}}};
}

Expected<Report> DescribeTelemetryFile(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, ReadTelemetry(path, {}));
  const std::vector<std::string> statements = DescribeTelemetry(telemetry);
  return Report{fmt::format("{}\n{}", path, Indented(statements)),
                {{"file", path}, {"kind", "telemetry"}, {"says", statements}}};
}

// Pages of which a flipped bit may remain unseen; empty if there are none. A database server has checksums of its own.
Expected<std::string> PagesWithoutChecksum(const std::string& db) {
  if (IsDatabaseUrl(db)) return std::string();
  VICTORIOUS_ASSIGN_OR_RETURN(const sqlite::PageCheck check, sqlite::CheckPages(db));
  if (!check.is_summed) return std::string("without checksums of its pages: made by an earlier version");
  if (check.without_checksum == 0) return std::string();
  return fmt::format("{} of {} without a checksum: never used, or written by another program", check.without_checksum,
                     CountText(check.pages, "page"));
}

// Reads the whole index. Damage is an error: its first fault, and how many there are.
Expected<Report> CheckIndex(const std::string& db) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenStore(db, StoreMode::kRead));
  const std::string path = StoreName(db);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::string> faults, store->FindFaults());
  if (!faults.empty()) {
    return Fail(
        ErrorCode::kDataLoss,
        fmt::format("{}: damaged: {}{}: index the videos again into a new {}", path, faults.front(),
                    faults.size() > 1 ? fmt::format(", and {} more", CountText(faults.size() - 1, "fault")) : "",
                    IsDatabaseUrl(db) ? "database" : "file"));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string without, PagesWithoutChecksum(db));
  ordered_json notes = ordered_json::array();
  if (!without.empty()) notes.push_back(without);
  return Report{fmt::format("{}\n  an index without damage{}\n", path, without.empty() ? "" : "\n  " + without),
                {{"file", path}, {"kind", "index"}, {"faults", ordered_json::array()}, {"notes", std::move(notes)}}};
}

// The first bytes of a file, by which its kind is known; fewer if it is shorter.
std::string FirstBytes(const std::string& path) {
  std::string head(16, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

// Verifies each entry of a server's log of reads.
Expected<Report> CheckAccessLog(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const AccessLogSummary summary, VerifyAccessLog(path));
  return Report{fmt::format("{}\n  a log of reads without changes: {}, the last hash {}\n{}", path,
                            CountText(summary.entries, "read"), summary.last_hash,
                            summary.is_cut_off ? "  the last line is being written, or was cut off\n" : ""),
                {{"file", path},
                 {"kind", "access_log"},
                 {"entries", summary.entries},
                 {"last_hash", summary.last_hash},
                 {"is_cut_off", summary.is_cut_off}}};
}

// Determines the kind by the file's first bytes, not by its name.
Expected<Report> Describe(const std::string& path) {
  if (IsDatabaseUrl(path)) return DescribeIndex(path);
  std::array<char, 16> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  const std::string_view bytes(head.data(), head.size());
  if (bytes.starts_with("SQLite format 3")) return DescribeIndex(path);
  if (bytes.starts_with("\x8AVMDL")) return DescribeModel(path);
  if (IsTelemetryFile(path)) return DescribeTelemetryFile(path);
  return DescribeVideo(path);
}

Status Print(const Report& report, bool as_json) {
  constexpr int kIndent = 2;
  if (!as_json) return WriteOutput("", report.text);
  return WriteOutput("", DumpJson(report.json, kIndent) + "\n");
}

}  // namespace

Action SetUpDoctor(ArgumentParser& parser) {
  struct Arguments {
    std::string file;
    bool check = false;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  parser.Add("FILE", arguments->file,
             "A video, a folder of frames, an image, telemetry, a model (.vmodel) or an index (.db, or "
             "postgresql://USER@HOST/DATABASE); without it, "
             "this machine is described");
  parser.AddFlag("--check", arguments->check, "Read all of an index, or of a server's log of reads, and report damage");
  parser.AddFlag("--json", arguments->json, "Print one JSON object");
  return [=]() -> Status {
    if (arguments->check) {
      if (arguments->file.empty()) return Fail(ErrorCode::kInvalidArgument, "--check: give the index to check");
      const bool is_log = !IsDatabaseUrl(arguments->file) && IsAccessLog(FirstBytes(arguments->file));
      VICTORIOUS_ASSIGN_OR_RETURN(const Report report,
                                  is_log ? CheckAccessLog(arguments->file) : CheckIndex(arguments->file));
      return Print(report, arguments->json);
    }
    if (arguments->file.empty()) return Print(DescribeMachine(), arguments->json);
    VICTORIOUS_ASSIGN_OR_RETURN(const Report report, Describe(arguments->file));
    return Print(report, arguments->json);
  };
}

}  // namespace victorious::cli
