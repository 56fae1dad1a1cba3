#include "victorious/place/associate/neighbours.h"

#include <cmath>
#include <vector>

namespace victorious {
namespace {

constexpr double kMinute_s = 60;

std::int64_t MinuteOf(double utc_s) { return static_cast<std::int64_t>(std::floor(utc_s / kMinute_s)); }

}  // namespace

Whereabouts FindWhereabouts(std::span<const ObjectInFlight* const> flights) {
  Whereabouts where;
  if (!IsAnyMoving(flights)) where.static_point = FuseStatic(flights).point;
  for (const ObjectInFlight* flight : flights) {
    if (!flight->utc_offset_s) continue;
    const std::int64_t last = MinuteOf(flight->last_s + kMaxFlightGap_s / 2);
    for (std::int64_t minute = MinuteOf(flight->first_s - kMaxFlightGap_s / 2); minute <= last; ++minute)
      where.minutes.insert(minute);
  }
  return where;
}

void Neighbours::Add(const Whereabouts& where, std::int64_t id) {
  if (where.static_point) static_places_.Add(*where.static_point, id);
  for (const std::int64_t minute : where.minutes) (where.static_point ? standing_ : moving_)[minute].insert(id);
}

void Neighbours::Remove(const Whereabouts& where, std::int64_t id) {
  if (where.static_point) static_places_.Remove(*where.static_point, id);
  for (const std::int64_t minute : where.minutes) (where.static_point ? standing_ : moving_)[minute].erase(id);
}

std::set<std::int64_t> Neighbours::Near(const Whereabouts& where) const {
  std::set<std::int64_t> near;
  if (where.static_point) {
    const std::vector<std::int64_t> in_space = static_places_.Near(*where.static_point);
    near.insert(in_space.begin(), in_space.end());
  } else {
    AddOf(standing_, where, near);
  }
  AddOf(moving_, where, near);
  return near;
}

void Neighbours::AddOf(const IdsByMinute& ids_by_minute, const Whereabouts& where, std::set<std::int64_t>& near) {
  for (const std::int64_t minute : where.minutes) {
    if (const auto found = ids_by_minute.find(minute); found != ids_by_minute.end())
      near.insert(found->second.begin(), found->second.end());
  }
}

}  // namespace victorious
