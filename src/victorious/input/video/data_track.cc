#include "victorious/input/video/data_track.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace victorious {
namespace {

// SMPTE 336: prefix of every universal label.
constexpr std::array kUniversalLabel = {std::byte{0x06}, std::byte{0x0E}, std::byte{0x2B}, std::byte{0x34}};

// The header of an MPEG-TS metadata cell before the unit (ISO/IEC 13818-1, 2.12.4).
constexpr std::size_t kCellHeader = 5;

bool HasLabelAt(std::span<const std::byte> bytes, std::size_t offset) {
  return bytes.size() >= offset + kUniversalLabel.size() &&
         std::ranges::equal(bytes.subspan(offset, kUniversalLabel.size()), kUniversalLabel);
}

}  // namespace

bool IsDataStream(const AVStream& stream) {
  switch (stream.codecpar->codec_type) {
    case AVMEDIA_TYPE_VIDEO:
    case AVMEDIA_TYPE_AUDIO:
    case AVMEDIA_TYPE_ATTACHMENT:
      return false;
    default:
      return true;
  }
}

// A stream that the container does not name KLV is KLV from its first label on: a unit may go on in further packets.
DataKind DataTrack::DetectKind(const AVStream& stream, std::span<const std::byte> bytes) {
  const bool is_klv =
      stream.codecpar->codec_id == AV_CODEC_ID_SMPTE_KLV || HasLabelAt(bytes, 0) || HasLabelAt(bytes, kCellHeader);
  if (is_klv) klv_streams_.insert(stream.index);
  if (klv_streams_.contains(stream.index)) return DataKind::kKlv;
  return stream.codecpar->codec_type == AVMEDIA_TYPE_SUBTITLE ? DataKind::kSubtitle : DataKind::kOther;
}

void DataTrack::Add(const AVStream& stream, const AVPacket& packet, std::size_t joints) {
  const auto bytes = std::as_bytes(std::span(packet.data, static_cast<std::size_t>(packet.size)));
  DataPacket& added = packets_.emplace_back();
  added.stream = stream.index;
  added.kind = DetectKind(stream, bytes);
  if (packet.pts != AV_NOPTS_VALUE) added.time_s = static_cast<double>(packet.pts) * av_q2d(stream.time_base);
  added.bytes.assign(bytes.begin(), bytes.end());
  origins_.push_back({.position = packet.pos, .joints = joints});
}

std::vector<DataPacket> DataTrack::Take(std::optional<double> origin_s, const TimeBaseJoints& joints) {
  for (std::size_t i = 0; i < packets_.size(); ++i) {
    std::optional<double>& time_s = packets_[i].time_s;
    if (!time_s) continue;
    if (origin_s) {
      *time_s += joints.OffsetOf(*time_s, origins_[i].position, origins_[i].joints) - *origin_s;
    } else {
      time_s.reset();
    }
  }
  origins_.clear();
  return std::exchange(packets_, {});
}

}  // namespace victorious
