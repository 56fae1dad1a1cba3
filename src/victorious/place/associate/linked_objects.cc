#include "victorious/place/associate/linked_objects.h"

#include <algorithm>
#include <map>
#include <optional>

#include "victorious/place/associate/fits.h"

namespace victorious {
namespace {

// UTC of the last sighting, s; std::nullopt if a video has none.
std::optional<double> LastUtc_s(const ObjectHypothesis& hypothesis) {
  double last_s = 0;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    if (!tracklet->start_utc_us || tracklet->is_of_photos) return std::nullopt;
    last_s = std::max(last_s, 1e-6 * static_cast<double>(*tracklet->start_utc_us) + tracklet->record.last_time_s);
  }
  return last_s;
}

// std::nullopt: their videos have no common time.
std::optional<bool> IsSeenLater(const ObjectHypothesis& one, const ObjectHypothesis& other) {
  const std::set<std::int64_t> videos = VideosOf(one);
  if (videos.size() == 1 && videos == VideosOf(other) && !one.tracklets.front()->is_of_photos)
    return LastTime(one) > LastTime(other);
  const std::optional<double> of_one_s = LastUtc_s(one);
  const std::optional<double> of_other_s = LastUtc_s(other);
  return of_one_s && of_other_s ? std::optional(*of_one_s > *of_other_s) : std::nullopt;
}

bool DoAgree(const Geolocation& one, const Geolocation& other, const ObjectOptions& options) {
  const Eigen::Vector3d apart = TangentPlane(one.point).EnuFromGeodetic(other.point);
  return Mahalanobis(apart, one.covariance_enu_m2 + other.covariance_enu_m2 + MergeSlackCovariance()) <=
         options.merge_gate_sigma;
}

}  // namespace

std::set<std::int64_t> VideosOf(const ObjectHypothesis& hypothesis) {
  std::set<std::int64_t> videos;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) videos.insert(tracklet->record.video);
  return videos;
}

double DistanceApart_m(const ObjectRecord& object, const ObjectRecord& other, const ObjectOptions& options) {
  if (!object.place || !other.place || DoAgree(*object.place, *other.place, options)) return 0;
  return TangentPlane(object.place->point).EnuFromGeodetic(other.place->point).norm();
}

bool IsPreferred(const ObjectRecord& object, const ObjectHypothesis& hypothesis, const ObjectRecord& other,
                 const ObjectHypothesis& of_other, const ObjectOptions& options) {
  if (object.rejected.empty() != other.rejected.empty()) return object.rejected.empty();
  if (!object.place || !other.place) return object.place && !other.place;
  const std::optional<bool> is_later = IsSeenLater(hypothesis, of_other);
  if (is_later && !DoAgree(*object.place, *other.place, options)) return *is_later;
  return object.place->ce90_m < other.place->ce90_m;
}

void SeparateFromGroups(const std::vector<const ObservedTracklet*>& of_one_model, Fits& fits,
                        LinkConstraints& constraints) {
  if (!constraints.HasGroups()) return;
  std::map<std::int64_t, std::vector<const ObservedTracklet*>> groups;
  for (const ObservedTracklet* tracklet : of_one_model)
    groups[constraints.GroupOf(tracklet->record.id)].push_back(tracklet);
  for (const auto& [group, members] : groups) {
    if (members.size() < 2) continue;
    for (const ObservedTracklet* other : of_one_model) {
      const std::int64_t id = other->record.id;
      const auto shares_frame = [&](const ObservedTracklet* member) { return HasCommonFrame(*member, *other, fits); };
      if (constraints.GroupOf(id) != group && std::ranges::any_of(members, shares_frame))
        constraints.AddCannotLink(group, id);
    }
  }
}

void JoinLinked(const LinkConstraints& constraints, std::vector<ObjectHypothesis>& hypotheses, Fits& fits,
                const std::function<void(std::size_t into, std::size_t from)>& join) {
  if (!constraints.HasGroups()) return;
  std::map<std::int64_t, std::size_t> of_groups;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    std::size_t at = i;
    std::set<std::int64_t> groups;
    for (const ObservedTracklet* tracklet : hypotheses[i].tracklets)
      groups.insert(constraints.GroupOf(tracklet->record.id));
    for (const std::int64_t group : groups) {
      const std::size_t known = of_groups.try_emplace(group, at).first->second;
      if (known == at) continue;
      const std::size_t into = std::min(known, at);
      const std::size_t from = std::max(known, at);
      if (constraints.CannotLink(hypotheses[into].tracklets, hypotheses[from].tracklets)) continue;
      if (HasCommonFrame(hypotheses[into], hypotheses[from], fits)) continue;
      join(into, from);
      for (auto& [unused, position] : of_groups) {
        if (position == from) position = into;
      }
      at = into;
    }
  }
}

}  // namespace victorious
