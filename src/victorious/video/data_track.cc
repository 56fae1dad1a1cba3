#include "victorious/video/data_track.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace victorious {
namespace {

DataKind DetectDataKind(const AVStream& stream, std::span<const std::byte> bytes) {
  // SMPTE 336: prefix of every universal label. It identifies KLV streams that are not registered as KLV.
  constexpr std::array kUniversalLabel = {std::byte{0x06}, std::byte{0x0E}, std::byte{0x2B}, std::byte{0x34}};
  if (stream.codecpar->codec_id == AV_CODEC_ID_SMPTE_KLV) return DataKind::kKlv;
  if (bytes.size() >= kUniversalLabel.size() &&
      std::ranges::equal(bytes.first(kUniversalLabel.size()), kUniversalLabel)) {
    return DataKind::kKlv;
  }
  return stream.codecpar->codec_type == AVMEDIA_TYPE_SUBTITLE ? DataKind::kSubtitle : DataKind::kOther;
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

void DataTrack::Add(const AVStream& stream, const AVPacket& packet) {
  const auto bytes = std::as_bytes(std::span(packet.data, static_cast<std::size_t>(packet.size)));
  DataPacket& added = packets_.emplace_back();
  added.stream = stream.index;
  added.kind = DetectDataKind(stream, bytes);
  if (packet.pts != AV_NOPTS_VALUE) added.time_s = static_cast<double>(packet.pts) * av_q2d(stream.time_base);
  added.bytes.assign(bytes.begin(), bytes.end());
}

std::vector<DataPacket> DataTrack::Take(std::optional<double> origin_s) {
  for (DataPacket& packet : packets_) {
    if (packet.time_s) packet.time_s = origin_s ? std::optional(*packet.time_s - *origin_s) : std::nullopt;
  }
  return std::exchange(packets_, {});
}

}  // namespace victorious
