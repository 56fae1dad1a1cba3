#include "victorious/input/video/stream_recorder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file_lock.h"
#include "victorious/base/folder.h"
#include "victorious/base/utc.h"
#include "victorious/input/video/demuxer.h"
#include "victorious/input/video/ffmpeg_handles.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/packet_file.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".ts";
constexpr std::string_view kPartEnding = ".part";
constexpr double kMaxKeyFrameWait_s = 12;  // after it, a file ends and begins at any frame
constexpr double kMaxJump_s = 10;          // of time stamps within a file
constexpr auto kReopenPause = std::chrono::milliseconds(500);
constexpr auto kPollPause = std::chrono::milliseconds(100);
// The positions of the colons in the text of a time: not every file system has them in names.
constexpr std::array<std::size_t, 2> kColons = {13, 16};

std::string NameOf(std::int64_t start_utc_us) {
  std::string name = FormatUtc(start_utc_us);
  for (const std::size_t colon : kColons) name[colon] = '-';
  return name.append(kEnding);
}

std::int64_t SizeOf(const fs::path& path) {
  std::error_code gone;
  const auto bytes = fs::file_size(path, gone);
  return gone ? 0 : static_cast<std::int64_t>(bytes);
}

// Gives the files their names that a killed recorder left.
Status CompleteParts(const fs::path& folder) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> paths, ListFolder(folder));
  for (const fs::path& part : paths) {
    if (part.extension() != kPartEnding || !RecordingStart(part.stem())) continue;
    std::error_code error;
    if (SizeOf(part) == 0) {
      fs::remove(part, error);
    } else {
      fs::rename(part, folder / part.stem(), error);
    }
    if (error) return std::unexpected(ErrorFromErrno(error.value(), part.string()));
  }
  return {};
}

// Removes the oldest files until one more of the newest one's size fits.
Status MakeRoomForRecording(const RecordOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<RecordedFile> files, ListRecordings(options.folder));
  if (files.empty()) return {};
  std::int64_t bytes = files.back().bytes;
  for (const RecordedFile& file : files) bytes += file.bytes;
  for (const RecordedFile& file : files) {
    if (bytes <= options.max_bytes) break;
    std::error_code error;
    fs::remove(file.path, error);
    if (error) return std::unexpected(ErrorFromErrno(error.value(), file.path.string()));
    bytes -= file.bytes;
  }
  return {};
}

bool IsCopyableToTransportStream(const AVStream& stream) {
  constexpr std::array kCodecs = {AV_CODEC_ID_MPEG1VIDEO, AV_CODEC_ID_MPEG2VIDEO, AV_CODEC_ID_MPEG4, AV_CODEC_ID_H264,
                                  AV_CODEC_ID_HEVC};
  return std::ranges::find(kCodecs, stream.codecpar->codec_id) != kCodecs.end();
}

// One connection to the source, from its first packet until it breaks.
class RecordedConnection {
 public:
  RecordedConnection(Demuxer& demuxer, const RecordOptions& options,
                     const std::function<void(const RecordedFile&)>& on_file)
      : demuxer_(demuxer), options_(options), on_file_(on_file) {
    demuxer_.KeepStreams([&](const AVStream& stream) {
      return stream.index == demuxer_.video().index || stream.codecpar->codec_type == AVMEDIA_TYPE_DATA;
    });
  }

  /// Copies packets until the source ends, or sends nothing.
  Status Record() {
    const PacketHandle packet(av_packet_alloc());
    constexpr int kMaxErrors = 100;  // in a row
    for (int errors = 0; errors < kMaxErrors;) {
      const int result = demuxer_.Read(packet.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_INVALIDDATA) {
        ++errors;
        std::this_thread::sleep_for(kPollPause / 10);
        continue;
      }
      if (result < 0) break;
      errors = 0;
      Status added = Add(*packet);
      av_packet_unref(packet.get());
      VICTORIOUS_RETURN_IF_ERROR(added);
    }
    return Finish();
  }

 private:
  [[nodiscard]] static double StampOf(const AVPacket& packet, const AVStream& stream) {
    const std::int64_t stamp = packet.pts != AV_NOPTS_VALUE ? packet.pts : packet.dts;
    return static_cast<double>(stamp) * av_q2d(stream.time_base);
  }

  Status Add(AVPacket& packet) {
    const AVStream& stream = demuxer_.stream(packet.stream_index);
    const bool is_video = stream.index == demuxer_.video().index;
    if (packet.pts == AV_NOPTS_VALUE && packet.dts == AV_NOPTS_VALUE) {
      if (is_video || !last_s_) return {};  // the frames before the first time stamp
      packet.pts = static_cast<std::int64_t>(*last_s_ / av_q2d(stream.time_base));  // telemetry without its own
    }
    if (packet.dts == AV_NOPTS_VALUE) packet.dts = packet.pts;
    if (is_video) {
      VICTORIOUS_RETURN_IF_ERROR(Step(packet, StampOf(packet, stream)));
    } else {
      last_data_.insert_or_assign(stream.index, PacketHandle(av_packet_clone(&packet)));
    }
    return file_ ? Write(packet, stream) : Status();
  }

  // Ends and begins files.
  Status Step(const AVPacket& packet, double stamp_s) {
    const bool has_jumped = last_s_ && std::abs(stamp_s - *last_s_) > kMaxJump_s;
    if (has_jumped) {
      VICTORIOUS_RETURN_IF_ERROR(Finish());
      delay_ = std::make_unique<LiveDelay>();
      waits_since_s_.reset();
    }
    last_s_ = stamp_s;
    delay_->EnterRead(stamp_s, 0);
    const bool is_key = (packet.flags & AV_PKT_FLAG_KEY) != 0;
    if (!waits_since_s_) waits_since_s_ = stamp_s;
    const double due_s = file_ ? first_s_ + options_.segment_s : *waits_since_s_;
    if (is_key ? stamp_s < due_s && file_ : stamp_s < due_s + kMaxKeyFrameWait_s) return KeepName(stamp_s);
    VICTORIOUS_RETURN_IF_ERROR(Finish());
    return Begin(stamp_s);
  }

  Status Begin(double stamp_s) {
    std::vector<const AVStream*> sources;
    streams_.assign(demuxer_.container().nb_streams, -1);
    for (unsigned i = 0; i < demuxer_.container().nb_streams; ++i) {
      const AVStream& stream = demuxer_.stream(static_cast<int>(i));
      if (stream.discard == AVDISCARD_ALL) continue;
      streams_[i] = static_cast<int>(sources.size());
      sources.push_back(&stream);
    }
    last_dts_.assign(sources.size(), AV_NOPTS_VALUE);
    first_s_ = named_s_ = stamp_s;
    previous_utc_us_ = start_utc_us_;
    start_utc_us_ = StartUtc();
    const fs::path path = options_.folder / NameOf(start_utc_us_);
    file_ = std::make_unique<PacketFile>(path, path.string().append(kPartEnding));
    VICTORIOUS_RETURN_IF_ERROR(file_->Open("mpegts", sources, PacketFlush::kAtOnce));
    // The telemetry before the first frame, so that the frame has one.
    for (const auto& [stream, packet] : last_data_) {
      const PacketHandle copy(av_packet_clone(packet.get()));
      if (copy) VICTORIOUS_RETURN_IF_ERROR(Write(*copy, demuxer_.stream(stream)));
    }
    return {};
  }

  // After that of the file before, also where a source sends at once what it has filmed before.
  [[nodiscard]] std::int64_t StartUtc() const { return std::max(delay_->ArrivalUtc(first_s_), previous_utc_us_ + 1); }

  // The first packets may have waited while the source was opened: later ones tell their time better.
  Status KeepName(double stamp_s) {
    constexpr double kInterval_s = 1;
    if (!file_ || stamp_s < named_s_ + kInterval_s) return {};
    named_s_ = stamp_s;
    return CorrectName();
  }

  Status CorrectName() {
    constexpr std::int64_t kSameTime_us = 1000;
    const std::int64_t start_utc_us = StartUtc();
    if (std::abs(start_utc_us - start_utc_us_) < kSameTime_us) return {};
    start_utc_us_ = start_utc_us;
    const fs::path path = options_.folder / NameOf(start_utc_us_);
    return file_->Rename(path, path.string().append(kPartEnding));
  }

  Status Write(AVPacket& packet, const AVStream& stream) {
    const auto index = static_cast<std::size_t>(stream.index);
    if (index >= streams_.size() || streams_[index] < 0) return {};  // it has come since the file began
    const int target = streams_[index];
    std::int64_t& last_dts = last_dts_[static_cast<std::size_t>(target)];
    if (last_dts != AV_NOPTS_VALUE && packet.dts <= last_dts) return {};  // damaged
    last_dts = packet.dts;
    if (packet.pts != AV_NOPTS_VALUE && packet.pts < packet.dts) packet.pts = packet.dts;
    return file_->Write(packet, target, stream.time_base);
  }

  Status Finish() {
    if (!file_) return {};
    VICTORIOUS_RETURN_IF_ERROR(CorrectName());
    VICTORIOUS_RETURN_IF_ERROR(file_->Finish());
    const RecordedFile done{.path = file_->path(), .start_utc_us = start_utc_us_, .bytes = SizeOf(file_->path())};
    file_.reset();
    on_file_(done);
    return MakeRoomForRecording(options_);
  }

  Demuxer& demuxer_;
  const RecordOptions& options_;
  const std::function<void(const RecordedFile&)>& on_file_;
  std::unique_ptr<LiveDelay> delay_ = std::make_unique<LiveDelay>();
  std::unique_ptr<PacketFile> file_;
  std::vector<int> streams_;               // of the file, by those of the source; -1: none
  std::vector<std::int64_t> last_dts_;     // by stream of the file
  std::map<int, PacketHandle> last_data_;  // by stream of the source
  std::optional<double> last_s_;           // time stamp of the last video packet
  std::optional<double> waits_since_s_;    // the first one of the connection
  double first_s_ = 0;                     // that of the first frame of the file
  double named_s_ = 0;                     // at which the name was compared last
  std::int64_t start_utc_us_ = 0;          // of the file
  std::int64_t previous_utc_us_ = 0;       // of the file before
};

Status CheckSourceAddress(const std::string& url) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<bool> is_live, IsLiveAddress(url));
  if (is_live.value_or(true)) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: not the address of a live source: give rtsp://…, udp://…, srt://…, …", url));
}

Status CheckRecordable(const Demuxer& demuxer, const std::string& url) {
  if (!demuxer.IsLive()) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: not a live source: a file needs no recorder", url));
  }
  if (IsCopyableToTransportStream(demuxer.video())) return {};
  return Fail(ErrorCode::kUnsupported,
              fmt::format("{}: its video ({}) cannot be recorded as it is: let the camera send H.264 or H.265", url,
                          avcodec_get_name(demuxer.video().codecpar->codec_id)));
}

void PauseBeforeReopening(const CancelToken& cancel) {
  const auto end = std::chrono::steady_clock::now() + kReopenPause;
  while (!cancel.IsCancelled() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(kPollPause);
}

}  // namespace

std::optional<std::int64_t> RecordingStart(const fs::path& file) {
  if (file.extension() != kEnding) return std::nullopt;
  std::string text = file.stem().string();
  for (const std::size_t colon : kColons) {
    if (colon < text.size()) text[colon] = ':';
  }
  const std::optional<std::int64_t> start_utc_us = ParseUtc(text);
  return start_utc_us && NameOf(*start_utc_us) == file.filename() ? start_utc_us : std::nullopt;
}

Expected<std::vector<RecordedFile>> ListRecordings(const fs::path& folder) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> paths, ListFolder(folder));
  std::vector<RecordedFile> files;
  for (const fs::path& path : paths) {
    if (const auto start = RecordingStart(path)) {
      files.push_back({.path = path, .start_utc_us = *start, .bytes = SizeOf(path)});
    }
  }
  return files;
}

Status RecordStream(const std::string& url, const RecordOptions& options, const CancelToken& cancel,
                    const std::function<void(const RecordedFile&)>& on_file, const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(CheckSourceAddress(url));
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), options.folder.string()));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<FileLock> lock, FileLock::Try(options.folder / "lock"));
  if (!lock) {
    return Fail(ErrorCode::kConflict,
                fmt::format("{}: another process records into it: give each source a folder of its own",
                            options.folder.string()));
  }
  VICTORIOUS_RETURN_IF_ERROR(CompleteParts(options.folder));
  VICTORIOUS_RETURN_IF_ERROR(MakeRoomForRecording(options));
  bool was_read = false;
  bool is_away = false;
  while (!cancel.IsCancelled()) {
    const auto demuxer =
        Demuxer::Open({.name = url, .remote = true, .timeout_s = options.timeout_s, .cancel = &cancel});
    if (cancel.IsCancelled()) break;
    if (demuxer) {
      VICTORIOUS_RETURN_IF_ERROR(CheckRecordable(**demuxer, url));
      was_read = true;
      is_away = false;
      VICTORIOUS_RETURN_IF_ERROR(RecordedConnection(**demuxer, options, on_file).Record());
    } else if (!was_read) {
      return std::unexpected(demuxer.error());
    } else if (!std::exchange(is_away, true)) {
      warn(demuxer.error().message + "; it is tried again until it is");
    }
    PauseBeforeReopening(cancel);
  }
  return {};
}

}  // namespace victorious
