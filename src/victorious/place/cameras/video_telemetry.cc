#include "victorious/place/cameras/video_telemetry.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/median.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/place/cameras/photo_telemetry.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeadSize = 8192;  // bytes by which the file type is recognised

// Data tracks with telemetry of formats that are not read, by the four letters of their sample entry (ISO/IEC 14496-12,
// 8.5.2).
struct UnreadStream {
  std::string_view codec;
  std::string_view name;
};

constexpr auto kUnreadStreams = std::to_array<UnreadStream>({{"gpmd", "GPMF of a GoPro"},
                                                             {"djmd", "metadata of a DJI camera"},
                                                             {"camm", "camera motion metadata (CAMM)"},
                                                             {"rtmd", "real-time metadata of a Sony camera"},
                                                             {"nmea", "NMEA sentences"},
                                                             {"gps0", "GPS fixes"}});

std::string ReadHead(const std::string& path) {
  std::string head(kHeadSize, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

// Reads the data packets of a video; no records if it has none.
// @param damage  receives warnings of damage in the file; null: the reader of the frames reports them
Expected<Telemetry> ReadPackets(const std::string& source, const TelemetryOptions& options,
                                std::vector<std::string>* damage) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(source, {.data_packets = true}));
  if (reader->info().live) {
    return Fail(ErrorCode::kInvalidArgument, "a live source: its telemetry has no end; give a file");
  }
  reader->SkipToEnd();
  if (damage != nullptr) *damage = reader->warnings();
  Expected<Telemetry> telemetry = TelemetryFromPackets(reader->TakeDataPackets(), options);
  if (telemetry && telemetry->records == 0) {
    if (auto unread = DescribeUnreadTelemetry(reader->info())) telemetry->warnings.push_back(*std::move(unread));
  }
  if (telemetry) FitToImage(reader->info().width, reader->info().height, *telemetry);
  return telemetry;
}

Expected<Telemetry> ReadFromPhotos(const std::string& source, const TelemetryOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Telemetry> telemetry,
                              ReadPhotoTelemetry(source, VideoReaderOptions().folder_frame_rate, options));
  if (telemetry) return *std::move(telemetry);
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: no telemetry: no image has a position (EXIF or XMP of a JPEG)", source));
}

Expected<Telemetry> ReadFromVideo(const std::string& source, const TelemetryOptions& options) {
  if (IsOfImages(source)) return ReadFromPhotos(source, options);
  std::vector<std::string> damage;
  Expected<Telemetry> telemetry = ReadPackets(source, options, &damage);
  if (!telemetry) {
    Error error = std::move(telemetry).error();
    if (error.code == ErrorCode::kDataLoss) error.message += fmt::format("; telemetry is {}", kTelemetryFiles);
    return std::unexpected(std::move(error));
  }
  if (telemetry->records == 0) {
    const auto& warnings = telemetry->warnings;
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: no telemetry: {}", source,
                    warnings.empty() ? "no KLV and no subtitles of an aircraft are in this video" : warnings.front()));
  }
  std::ranges::move(damage, std::back_inserter(telemetry->warnings));
  return telemetry;
}

Expected<std::optional<Telemetry>> Find(const std::string& video, double folder_frame_rate,
                                        const TelemetryOptions& options,
                                        const std::function<void(const std::string&)>& warn) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  const bool of_images = IsOfImages(video);
  Expected<Telemetry> own = Telemetry{};
  if (!of_images) own = ReadPackets(video, options, nullptr);
  if (own && !own->packets.empty()) return std::optional(*std::move(own));
  if (const auto telemetry_file = FindTelemetryFile(video)) {
    Expected<Telemetry> read = ReadTelemetry(telemetry_file->string(), options);
    if (read) return std::optional(*std::move(read));
    warn(read.error().message);
  }
  if (of_images) return ReadPhotoTelemetry(video, folder_frame_rate, options);
  if (own && own->records > 0) return std::optional(*std::move(own));
  if (!own) warn(own.error().message);
  if (own) std::ranges::for_each(own->warnings, warn);
  return std::nullopt;
}

}  // namespace

bool IsTelemetryFile(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  for (const char* ending : {".klv", ".bin", ".srt", ".SRT", ".ass", ".csv"}) {
    if (path.ends_with(ending)) return true;
  }
  return LooksLikeTelemetry(ReadHead(path));
}

Expected<Telemetry> ReadTelemetry(const std::string& source, const TelemetryOptions& options) {
  if (!IsTelemetryFile(source)) return ReadFromVideo(source, options);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(source));
  auto telemetry = ParseTelemetry(bytes, options);
  if (!telemetry) return std::unexpected(std::move(telemetry).error().WithContext(source));
  return telemetry;
}

Expected<std::optional<Telemetry>> FindTelemetry(const std::string& video, const TelemetryOptions& options,
                                                 const std::function<void(const std::string&)>& warn) {
  return Find(video, VideoReaderOptions().folder_frame_rate, options, warn);
}

Expected<std::optional<Telemetry>> LoadTelemetry(const std::string& video, const VideoInfo& info,
                                                 const std::optional<std::string>& file,
                                                 const TelemetryOptions& options, std::string_view consequence,
                                                 const std::function<void(const std::string&)>& warn) {
  std::optional<Telemetry> telemetry;
  if (file) {
    VICTORIOUS_ASSIGN_OR_RETURN(telemetry, ReadTelemetry(*file, options));
  } else if (!info.live) {
    const double rate = info.frame_rate > 0 ? info.frame_rate : VideoReaderOptions().folder_frame_rate;
    VICTORIOUS_ASSIGN_OR_RETURN(telemetry, Find(video, rate, options, warn));
  }
  if (!telemetry) return telemetry;
  FitToImage(info.width, info.height, *telemetry);
  for (const std::string& warning : telemetry->warnings) warn("telemetry: " + warning);
  const auto why = DescribeMismatch(telemetry->states, info.duration_s);
  if (why && !telemetry->states.empty()) warn(fmt::format("telemetry: {}: {}", consequence, *why));
  return telemetry;
}

std::optional<std::string> DescribeUnreadTelemetry(const VideoInfo& info) {
  for (const StreamInfo& stream : info.streams) {
    const auto* const kind = std::ranges::find(kUnreadStreams, stream.codec, &UnreadStream::codec);
    if (kind == kUnreadStreams.end()) continue;
    return fmt::format(
        "stream {} is {}, which is not read: convert it to a table (time_s, latitude_deg, ...) and give "
        "that by --telemetry",
        stream.index, kind->name);
  }
  return std::nullopt;
}

std::optional<std::string> RememberedTelemetry(const std::string& file, const FileRoots& roots,
                                               const WarningSink& warn) {
  std::error_code error;
  if (file.empty()) return std::nullopt;
  if (const Status allowed = roots.Check(file); !allowed) {
    if (warn) warn("the telemetry file that was given for the video is not read: " + allowed.error().message);
    return std::nullopt;
  }
  if (fs::exists(file, error)) return file;
  if (warn) warn(fmt::format("the telemetry file {} that was given for the video is gone", file));
  return std::nullopt;
}

std::optional<std::string> DescribeMismatch(std::span<const CameraState> states, std::optional<double> duration_s) {
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  for (const CameraState& state : states) {
    if (!state.IsComplete()) continue;
    first_s = std::min(first_s, state.time_s);
    last_s = std::max(last_s, state.time_s);
  }
  if (first_s > last_s) {
    return "no state has camera position, attitude and field of view together; `victorious doctor` reports what is "
           "missing";
  }
  if (last_s >= 0 && !(duration_s && first_s > *duration_s)) return std::nullopt;
  return fmt::format("it covers {:.2f} to {:.2f} s, but the video 0 to {}: it may belong to another video", first_s,
                     last_s, duration_s ? fmt::format("{:.2f} s", *duration_s) : "its end");
}

std::optional<std::string> DescribeUnderground(std::span<const CameraState> states, const Ground& ground) {
  std::vector<double> above_m;
  for (const CameraState& state : states) {
    const auto ground_m = ground.HeightAt(state.place);
    if (state.datum == VerticalDatum::kEllipsoid && ground_m) above_m.push_back(state.place.altitude_m - *ground_m);
  }
  if (above_m.empty()) return std::nullopt;
  const double median_m = Median(std::move(above_m));
  if (median_m >= 0) return std::nullopt;
  return fmt::format(
      "the heights put the camera {:.0f} m under the ground (median): they have another vertical datum "
      "(telemetry.vertical_datum), or the ground has",
      -median_m);
}

}  // namespace victorious
