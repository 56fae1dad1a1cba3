#include "victorious/input/telemetry/klv_streams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "victorious/input/telemetry/klv_camera.h"
#include "victorious/input/telemetry/klv_hold.h"
#include "victorious/input/telemetry/klv_packets.h"

namespace victorious {
namespace {

// Item numbers of ST 0601 that change slowly enough for linear interpolation: the sensor's position and height.
constexpr int kLongitudeItem = 14;
constexpr std::array kInterpolated = {13, kLongitudeItem, 15, 75, 104};
constexpr int kElevationItem = 19;
constexpr int kTimeItem = 2;
constexpr int kChecksumNumber = 1;

bool IsUsable(const KlvPacket& packet) { return !packet.checksum || packet.checksum->IsValid(); }

// Camera states, packets with a pointing, packets of a known standard.
using Rank = std::tuple<int, int, int>;

std::map<int, Rank> RankStreams(std::span<const KlvPacket> packets) {
  std::map<int, Rank> ranks;
  for (const KlvPacket& packet : packets) {
    auto& [cameras, pointings, known] = ranks[packet.stream];
    cameras += CameraFromKlv(packet) ? 1 : 0;
    pointings += packet.Number(kElevationItem) ? 1 : 0;
    known += packet.standard == KlvStandard::kOther ? 0 : 1;
  }
  return ranks;
}

// Time by which packets of different streams are compared, s: that of the container, else their own.
std::optional<double> CommonTime(const KlvPacket& packet, bool by_container) {
  if (by_container) return packet.time_s;
  const auto own_us = PrecisionTime(packet);
  return own_us ? std::optional(1e-6 * static_cast<double>(*own_us)) : std::nullopt;
}

// The values of one item over time, of one stream.
struct TimedItem {
  double time_s = 0;
  KlvItem item;
};

std::optional<KlvItem> ItemAt(const std::vector<TimedItem>& items, double time_s, double max_gap_s) {
  const auto after = std::ranges::lower_bound(items, time_s, {}, &TimedItem::time_s);
  const TimedItem* next = after == items.end() ? nullptr : &*after;
  const TimedItem* last = after == items.begin() ? nullptr : &*std::prev(after);
  const auto is_near = [&](const TimedItem* item) {
    return item != nullptr && std::abs(item->time_s - time_s) <= max_gap_s;
  };
  if (!is_near(last)) last = nullptr;
  if (!is_near(next)) next = nullptr;
  if (last == nullptr && next == nullptr) return std::nullopt;
  const bool next_is_nearer = last == nullptr || (next != nullptr && next->time_s - time_s < time_s - last->time_s);
  KlvItem item = next_is_nearer ? next->item : last->item;
  if (last == nullptr || next == nullptr || std::ranges::find(kInterpolated, item.number) == kInterpolated.end()) {
    return item;
  }
  const auto from = last->item.Number();
  const auto to = next->item.Number();
  constexpr double kHalfTurn_deg = 180;
  if (!from || !to || (item.number == kLongitudeItem && std::abs(*to - *from) > kHalfTurn_deg)) return item;
  item.value = *from + (*to - *from) * (time_s - last->time_s) / (next->time_s - last->time_s);
  return item;
}

class Completion {
 public:
  // @param present       the numbers of the items that the completed stream has
  // @param by_container  whether all packets of that stream have the container's time
  Completion(std::span<const KlvPacket> packets, const std::set<int>& donors, const std::set<int>& present,
             bool by_container, double max_gap_s)
      : by_container_(by_container), max_gap_s_(max_gap_s) {
    for (const KlvPacket& packet : packets) {
      const auto time_s = CommonTime(packet, by_container);
      if (!donors.contains(packet.stream) || packet.standard != KlvStandard::kSt0601 || !IsUsable(packet) || !time_s)
        continue;
      for (const KlvItem& item : packet.items) {
        const bool is_offered = item.number > 0 && !present.contains(item.number) && item.Number().has_value();
        if (is_offered) items_[item.number][packet.stream].push_back({*time_s, item});
      }
    }
    for (auto& [number, of_streams] : items_) {
      for (auto& [stream, items] : of_streams) std::ranges::stable_sort(items, {}, &TimedItem::time_s);
    }
  }

  // Adds the items of the stream that has most of them.
  void Complete(KlvPacket& packet, std::set<int>& used) const {
    const auto time_s = CommonTime(packet, by_container_);
    if (!time_s || packet.standard != KlvStandard::kSt0601) return;
    for (const auto& [number, of_streams] : items_) {
      const auto most = std::ranges::max_element(of_streams, {}, [](const auto& entry) { return entry.second.size(); });
      const auto item = ItemAt(most->second, *time_s, max_gap_s_);
      if (!item) continue;
      packet.items.push_back(*item);
      used.insert(most->first);
    }
  }

 private:
  bool by_container_;
  double max_gap_s_;
  std::map<int, std::map<int, std::vector<TimedItem>>> items_;  // by number, then stream; in order of time
};

}  // namespace

CameraStream SelectCameraStream(std::span<const KlvPacket> sent, double max_gap_s) {
  CameraStream chosen;
  std::vector<KlvPacket> packets(sent.begin(), sent.end());
  HoldItems(packets, max_gap_s);
  const std::map<int, Rank> ranks = RankStreams(packets);
  if (ranks.empty()) return chosen;
  chosen.stream = std::ranges::max_element(ranks, {}, &std::pair<const int, Rank>::second)->first;

  std::set<int> donors;
  for (const auto& [stream, rank] : ranks) {
    const auto& [cameras, pointings, known] = rank;
    if (stream == chosen.stream || known == 0) continue;
    chosen.has_others = true;
    if (cameras == 0) donors.insert(stream);
  }
  std::set<int> present = {kChecksumNumber, kTimeItem};
  bool by_container = true;
  for (const KlvPacket& packet : packets) {
    if (packet.stream != chosen.stream) continue;
    chosen.packets.push_back(packet);
    by_container = by_container && packet.time_s.has_value();
    for (const KlvItem& item : packet.items) {
      if (item.Number()) present.insert(item.number);
    }
  }
  if (donors.empty()) return chosen;
  const Completion completion(packets, donors, present, by_container, max_gap_s);
  std::set<int> used;
  for (KlvPacket& packet : chosen.packets) completion.Complete(packet, used);
  chosen.completed_by.assign(used.begin(), used.end());
  return chosen;
}

}  // namespace victorious
