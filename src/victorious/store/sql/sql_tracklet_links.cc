// The part of SqlIndexStore that keeps what people say of the identity of tracklets: bound to the tracklets' first
// sightings, resolved to the tracklets that are there at present.
#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "victorious/geometry/box.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/records.h"
#include "victorious/store/sql/sql_index_store.h"

namespace victorious::sql {
namespace {

// Where an end is bound: model, video, frame and box. Equal for ends of the same sighting.
std::string PlaceOf(const Row& row, int first) {
  return fmt::format("{}|{}|{}|{}|{}|{}|{}", row.Text(first), row.Text(first + 1), row.Integer(first + 2),
                     row.Real(first + 3), row.Real(first + 4), row.Real(first + 5), row.Real(first + 6));
}

Box BoxAt(const Row& row, int first) {
  return {row.Real(first), row.Real(first + 1), row.Real(first + 2), row.Real(first + 3)};
}

// The tracklet of each end, by link and end: that with the greatest overlap; a negative number for each place without.
using TrackletsOfEnds = std::map<std::pair<std::int64_t, bool>, std::int64_t>;

Expected<TrackletsOfEnds> ReadEnds(Database& database) {
  TrackletsOfEnds tracklets;
  std::map<std::string, std::int64_t> absent;
  VICTORIOUS_RETURN_IF_ERROR(database.Visit(
      "SELECT link_id, is_second, model_name, video_content_id, frame, box_x_px, box_y_px, box_width_px, box_height_px "
      "FROM tracklet_link_ends ORDER BY link_id, is_second",
      ValueList(), RowCount::kMany, [&](const Row& row) -> Expected<bool> {
        const std::int64_t number = -1 - std::ssize(absent);
        tracklets[{row.Integer(0), row.Integer(1) != 0}] = absent.try_emplace(PlaceOf(row, 2), number).first->second;
        return true;
      }));
  const std::string select = fmt::format(
      "SELECT r.link_id, r.is_second, t.id, r.box_x_px, r.box_y_px, r.box_width_px, r.box_height_px, s.box_x_px, "
      "s.box_y_px, s.box_width_px, s.box_height_px FROM tracklet_link_ends r "
      "{0} videos v ON v.content_id = r.video_content_id {0} models m ON m.name = r.model_name "
      "{0} sightings s ON s.video_id = v.id AND s.frame = r.frame "
      "{0} tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id WHERE {1}",
      JoinInOrder(database.dialect()), IsReviewOfSighting(database.dialect()));
  std::map<std::pair<std::int64_t, bool>, std::pair<double, std::int64_t>> best;  // overlap, then the smaller id
  VICTORIOUS_RETURN_IF_ERROR(
      database.Visit(select, ValueList(), RowCount::kMany, [&](const Row& row) -> Expected<bool> {
        const std::pair end(row.Integer(0), row.Integer(1) != 0);
        const std::pair found(IntersectionOverUnion(BoxAt(row, 3), BoxAt(row, 7)), -row.Integer(2));
        const auto [known, is_first] = best.try_emplace(end, found);
        if (!is_first) known->second = std::max(known->second, found);
        return true;
      }));
  for (const auto& [end, found] : best) tracklets[end] = -found.second;
  return tracklets;
}

// So few pairs that all others follow: the first of each group with each other one of it, and with the first of each
// other group.
std::vector<TrackletLink> LinksOf(const std::vector<std::vector<std::int64_t>>& groups) {
  std::vector<TrackletLink> links;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::int64_t first = groups[i].front();
    for (const std::int64_t other : std::span(groups[i]).subspan(1))
      links.push_back({.first = first, .second = other, .is_one = true});
    for (const std::vector<std::int64_t>& other : std::span(groups).subspan(i + 1))
      links.push_back({.first = first, .second = other.front(), .is_one = false});
  }
  return links;
}

Status AddEnd(Database& database, std::int64_t link, bool is_second, std::int64_t tracklet) {
  return WriteOne(
      database,
      fmt::format("INSERT INTO tracklet_link_ends (link_id, is_second, video_content_id, model_name, frame, "
                  "box_x_px, box_y_px, box_width_px, box_height_px) "
                  "SELECT CAST(? AS bigint), CAST(? AS bigint), v.content_id, m.name, s.frame, s.box_x_px, "
                  "s.box_y_px, s.box_width_px, s.box_height_px {} WHERE t.id = ?",
                  FromFirstSightings(database.dialect())),
      ValueList(link, std::int64_t{is_second ? 1 : 0}, tracklet), "moment", tracklet);
}

}  // namespace

Expected<std::int64_t> SqlIndexStore::PutTrackletGroups(const TrackletGroups& groups) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(std::int64_t id,
                              database_->ReadInteger("SELECT coalesce(max(id), 0) FROM tracklet_links", ValueList()));
  const std::int64_t correction = id + 1;
  for (const TrackletLink& link : LinksOf(groups.groups)) {
    ++id;
    VICTORIOUS_RETURN_IF_ERROR(database_->Write(
        "INSERT INTO tracklet_links (id, correction, is_one, author, made_utc_us) VALUES (?, ?, ?, ?, ?)",
        ValueList(id, correction, std::int64_t{link.is_one ? 1 : 0}, groups.author, groups.made_utc_us)));
    VICTORIOUS_RETURN_IF_ERROR(AddEnd(*database_, id, false, link.first));
    VICTORIOUS_RETURN_IF_ERROR(AddEnd(*database_, id, true, link.second));
  }
  VICTORIOUS_RETURN_IF_ERROR(AddAudit(*database_, AuditOfGroups(correction, groups)));
  VICTORIOUS_RETURN_IF_ERROR(change.Commit());
  return correction;
}

Status SqlIndexStore::DeleteTrackletGroups(std::int64_t correction, const std::string& author,
                                           std::int64_t made_utc_us) {
  VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_, Exclusion::kAll));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::int64_t deleted,
      database_->Write("DELETE FROM tracklet_links WHERE correction = ?", ValueList(correction)));
  if (deleted == 0) return std::unexpected(MissingRow(database_->name(), "correction", correction));
  VICTORIOUS_RETURN_IF_ERROR(
      AddAudit(*database_, AuditOfGroups(correction, {.groups = {}, .author = author, .made_utc_us = made_utc_us})));
  return change.Commit();
}

Expected<std::vector<TrackletLink>> SqlIndexStore::TrackletLinks() {
  VICTORIOUS_ASSIGN_OR_RETURN(const TrackletsOfEnds tracklets, ReadEnds(*database_));
  std::vector<TrackletLink> links;
  VICTORIOUS_RETURN_IF_ERROR(database_->Visit(
      "SELECT id, is_one FROM tracklet_links ORDER BY id", ValueList(), RowCount::kMany,
      [&](const Row& row) -> Expected<bool> {
        const auto first = tracklets.find({row.Integer(0), false});
        const auto second = tracklets.find({row.Integer(0), true});
        if (first == tracklets.end() || second == tracklets.end() || first->second == second->second) return true;
        links.push_back({.first = first->second, .second = second->second, .is_one = row.Integer(1) != 0});
        return true;
      }));
  return links;
}

Expected<std::string> SqlIndexStore::CorrectionsMark() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      auto mark,
      database_->ReadOne("SELECT coalesce(max(id), 0), count(*) FROM tracklet_links", ValueList(),
                         [](const Row& row) { return fmt::format("{} {}", row.Integer(0), row.Integer(1)); }));
  return std::move(mark).value_or(std::string());
}

}  // namespace victorious::sql
