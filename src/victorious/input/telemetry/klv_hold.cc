#include "victorious/input/telemetry/klv_hold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "victorious/input/telemetry/eg0104.h"
#include "victorious/input/telemetry/klv_packets.h"

namespace victorious {
namespace {

// The longest interval in which ST 0902 lets a producer not repeat an item.
constexpr double kMaxHold_s = 30;

enum class CameraQuantity {
  kLatitude,
  kLongitude,
  kHeight,
  kHeading,
  kPitch,
  kRoll,
  kAzimuth,
  kElevation,
  kSensorRoll,
  kZoom
};

enum class Course {
  kSteady,  // changes little between two packets
  kCircle,  // the same, in degrees of a full circle
  kStep     // changes at once
};

struct HeldItem {
  KlvStandard standard = KlvStandard::kSt0601;
  int number = 0;              // of ST 0601
  std::string_view name = {};  // of EG 0104
  CameraQuantity quantity = CameraQuantity::kZoom;
  Course course = Course::kSteady;
};

constexpr auto kHeldItems = std::to_array<HeldItem>({
    {.number = 5, .quantity = CameraQuantity::kHeading, .course = Course::kCircle},
    {.number = 6, .quantity = CameraQuantity::kPitch},
    {.number = 7, .quantity = CameraQuantity::kRoll},
    {.number = 13, .quantity = CameraQuantity::kLatitude},
    {.number = 14, .quantity = CameraQuantity::kLongitude, .course = Course::kCircle},
    {.number = 15, .quantity = CameraQuantity::kHeight},
    {.number = 16, .quantity = CameraQuantity::kZoom, .course = Course::kStep},
    {.number = 18, .quantity = CameraQuantity::kAzimuth, .course = Course::kCircle},
    {.number = 19, .quantity = CameraQuantity::kElevation, .course = Course::kCircle},
    {.number = 20, .quantity = CameraQuantity::kSensorRoll, .course = Course::kCircle},
    {.number = 75, .quantity = CameraQuantity::kHeight},
    {.number = 90, .quantity = CameraQuantity::kPitch},
    {.number = 91, .quantity = CameraQuantity::kRoll},
    {.number = 104, .quantity = CameraQuantity::kHeight},
    {KlvStandard::kEg0104, 0, eg0104::kLatitude, CameraQuantity::kLatitude},
    {KlvStandard::kEg0104, 0, eg0104::kLongitude, CameraQuantity::kLongitude, Course::kCircle},
    {KlvStandard::kEg0104, 0, eg0104::kAltitude, CameraQuantity::kHeight},
    {KlvStandard::kEg0104, 0, eg0104::kHorizontalFieldOfView, CameraQuantity::kZoom, Course::kStep},
    {KlvStandard::kEg0104, 0, eg0104::kAngleToNorth, CameraQuantity::kAzimuth, Course::kCircle},
    {KlvStandard::kEg0104, 0, eg0104::kObliquityAngle, CameraQuantity::kElevation},
    {KlvStandard::kEg0104, 0, eg0104::kSensorRoll, CameraQuantity::kSensorRoll, Course::kCircle},
});

bool Is(const HeldItem& held, const KlvItem& item) {
  return held.number > 0 ? item.number == held.number : item.number == 0 && item.name == held.name;
}

const KlvItem* FindItem(const KlvPacket& packet, const HeldItem& held) {
  const KlvItem* found = nullptr;
  for (const KlvItem& item : packet.items) {
    if (Is(held, item) && (found == nullptr || item.Number())) found = &item;
  }
  return found;
}

constexpr double kTurn_deg = 360;

double Difference(double from, double to, Course course) {
  return course == Course::kCircle ? std::remainder(to - from, kTurn_deg) : to - from;
}

// One sending of an item; without a value where it is withdrawn or unknown.
struct Sending {
  std::size_t packet = 0;
  double time_s = 0;
  KlvItem item;
};

// A value for a packet that lacks it.
struct Offer {
  CameraQuantity quantity = CameraQuantity::kZoom;
  double sent_s = 0;
  double drift = 0;  // by how much it may have changed since
  KlvItem item;
};

void Add(const Offer& offer, KlvPacket& packet) {
  constexpr double kMetresPerDegree = 111'320;
  switch (offer.quantity) {
    case CameraQuantity::kLatitude:
    case CameraQuantity::kLongitude:
      packet.moved_m = std::hypot(packet.moved_m, kMetresPerDegree * offer.drift);
      break;
    case CameraQuantity::kHeight:
      packet.moved_m = std::hypot(packet.moved_m, offer.drift);
      break;
    case CameraQuantity::kZoom:
      break;
    default:
      packet.turned_deg = std::hypot(packet.turned_deg, offer.drift);
  }
  packet.items.push_back(offer.item);
}

// The packets of one stream that have a time and are valid.
class Stream {
 public:
  Stream(std::vector<KlvPacket>& packets, std::vector<std::size_t> indices, double max_gap_s)
      : packets_(packets), indices_(std::move(indices)), max_gap_s_(max_gap_s) {
    const auto has_container_time = [&](std::size_t i) { return packets_[i].time_s.has_value(); };
    by_container_ = std::ranges::all_of(indices_, has_container_time);
  }

  void Complete() {
    std::map<std::size_t, std::vector<Offer>> offers;  // by packet
    for (const HeldItem& held : kHeldItems) {
      const std::vector<Sending> sendings = Sendings(held);
      if (sendings.empty()) continue;
      const std::optional<double> rate = RateOf(sendings, held.course);
      auto next = sendings.begin();
      for (const std::size_t i : indices_) {
        while (next != sendings.end() && next->packet <= i) ++next;
        const auto time_s = TimeOf(packets_[i]);
        if (!time_s || packets_[i].standard != held.standard || FindItem(packets_[i], held) != nullptr) continue;
        const Sending* last = next == sendings.begin() ? nullptr : &*std::prev(next);
        auto offer = OfferAt(*time_s, last, next == sendings.end() ? nullptr : &*next, held.course, rate);
        if (!offer) continue;
        offer->quantity = held.quantity;
        offers[i].push_back(*std::move(offer));
      }
    }
    for (auto& [i, items] : offers) {
      std::erase_if(items, [&](const Offer& offer) { return Has(packets_[i], offer.quantity); });
      for (const Offer& offer : items) {
        const bool is_latest = std::ranges::none_of(
            items, [&](const Offer& other) { return other.quantity == offer.quantity && other.sent_s > offer.sent_s; });
        if (is_latest) Add(offer, packets_[i]);
      }
    }
  }

 private:
  std::optional<double> TimeOf(const KlvPacket& packet) const {
    if (by_container_) return packet.time_s;
    const auto own_us = PrecisionTime(packet);
    return own_us ? std::optional(1e-6 * static_cast<double>(*own_us)) : std::nullopt;
  }

  std::vector<Sending> Sendings(const HeldItem& held) const {
    std::vector<Sending> sendings;
    for (const std::size_t i : indices_) {
      const auto time_s = TimeOf(packets_[i]);
      const KlvItem* item = time_s && packets_[i].standard == held.standard ? FindItem(packets_[i], held) : nullptr;
      if (item != nullptr) sendings.push_back({i, *time_s, *item});
    }
    return sendings;
  }

  static bool Has(const KlvPacket& packet, CameraQuantity quantity) {
    return std::ranges::any_of(kHeldItems, [&](const HeldItem& held) {
      const KlvItem* item = held.quantity == quantity ? FindItem(packet, held) : nullptr;
      return item != nullptr && item->Number();
    });
  }

  // By how much a value changes a second, in the mean of the stream: a value that is sent on change moves in steps.
  // std::nullopt: it was sent once, or too rarely.
  static std::optional<double> RateOf(const std::vector<Sending>& sendings, Course course) {
    double change = 0;
    double seconds = 0;
    for (std::size_t i = 1; i < sendings.size(); ++i) {
      const auto from = sendings[i - 1].item.Number();
      const auto to = sendings[i].item.Number();
      const double interval_s = sendings[i].time_s - sendings[i - 1].time_s;
      if (!from || !to || !(interval_s > 0 && interval_s <= kMaxHold_s)) continue;
      change += std::abs(Difference(*from, *to, course));
      seconds += interval_s;
    }
    return seconds > 0 ? std::optional(change / seconds) : std::nullopt;
  }

  // @param last  the sending before, or null; `next` the one after
  std::optional<Offer> OfferAt(double time_s, const Sending* last, const Sending* next, Course course,
                               std::optional<double> rate) const {
    const auto from = last != nullptr ? last->item.Number() : std::nullopt;
    const auto to = next != nullptr ? next->item.Number() : std::nullopt;
    const bool is_next_near = to && next->time_s >= time_s && next->time_s - time_s <= max_gap_s_;
    const bool is_step = course == Course::kStep;
    if (last == nullptr && is_next_near) {
      return Offer{.sent_s = next->time_s,
                   .drift = is_step ? 0 : rate.value_or(0) * (next->time_s - time_s),
                   .item = next->item};
    }
    // How far a value may have moved is known from other sendings only.
    const double max_hold_s = is_step || rate ? kMaxHold_s : max_gap_s_;
    if (!from || !(time_s >= last->time_s && time_s - last->time_s <= max_hold_s)) return std::nullopt;
    Offer offer{.sent_s = last->time_s, .item = last->item};
    if (is_step) return offer;
    const double age_s = time_s - last->time_s;
    const double interval_s = next != nullptr ? next->time_s - last->time_s : 0;
    if (is_next_near && interval_s > 0 && interval_s <= max_gap_s_) {
      const double value = *from + Difference(*from, *to, course) * age_s / interval_s;
      offer.item.value = course == Course::kCircle ? std::remainder(value, kTurn_deg) : value;
    } else {
      offer.drift = rate.value_or(0) * age_s;
    }
    return offer;
  }

  std::vector<KlvPacket>& packets_;
  std::vector<std::size_t> indices_;  // of the packets of this stream, in order
  double max_gap_s_;
  bool by_container_ = true;
};

}  // namespace

void HoldItems(std::vector<KlvPacket>& packets, double max_gap_s) {
  std::map<int, std::vector<std::size_t>> streams;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const KlvPacket& packet = packets[i];
    const bool is_damaged = packet.checksum && !packet.checksum->IsValid();
    if (packet.standard != KlvStandard::kOther && !is_damaged) streams[packet.stream].push_back(i);
  }
  for (auto& [stream, indices] : streams) Stream(packets, std::move(indices), max_gap_s).Complete();
}

}  // namespace victorious
