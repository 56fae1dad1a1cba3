// TriageStore in the SQLite file of an index.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/store/sql/conditions.h"
#include "victorious/store/sql/records.h"
#include "victorious/store/sqlite/open_database.h"
#include "victorious/store/triage_store.h"

namespace victorious::sqlite {
namespace {

using sql::Conditions;
using sql::kObjectColumns;
using sql::ReadModel;
using sql::ReadObjectRow;
using sql::ReadReview;
using sql::ReadSighting;
using sql::ReadTracklet;
using sql::SelectModels;
using sql::SelectSightings;
using sql::SelectTracklets;

using ReviewState = ObjectQuery::ReviewState;

constexpr int kObjectRow = kObjectColumns.Size();  // the columns after those of the table
constexpr int kReviewColumns = kObjectRow + 4;

// Whether a place lies in a polygon, by the number of its edges that lie east of the place. Longitudes are compared
// relative to the first corner's, because an area may cross the antimeridian.
bool IsInside(const GeoPolygon& area, double latitude_rad, double longitude_rad) {
  const double origin = area.corners.front().longitude_rad;
  const auto east_of_origin = [&](double longitude) {
    return std::remainder(longitude - origin, 2 * std::numbers::pi);
  };
  const double x = east_of_origin(longitude_rad);
  bool is_inside = false;
  const GeodeticPoint* before = &area.corners.back();
  for (const GeodeticPoint& corner : area.corners) {
    const double y1 = before->latitude_rad;
    const double y2 = corner.latitude_rad;
    if ((y1 > latitude_rad) != (y2 > latitude_rad)) {
      const double x1 = east_of_origin(before->longitude_rad);
      const double x2 = east_of_origin(corner.longitude_rad);
      if (x < x1 + (latitude_rad - y1) / (y2 - y1) * (x2 - x1)) is_inside = !is_inside;
    }
    before = &corner;
  }
  return is_inside;
}

std::string SelectListed() {
  return "SELECT " + kObjectColumns.Names("o") +
         ", o.score, o.frames, o.first_time_s, o.last_time_s, o.verdict, o.note, o.reviewer, o.reviewed_utc_us, "
         "o.is_contested "
         "FROM objects o ";
}

std::string IdList(const std::vector<std::int64_t>& ids) { return fmt::format("[{}]", fmt::join(ids, ",")); }

Expected<TriageObject> ReadListed(const Statement& row, std::string_view name) {
  TriageObject listed;
  VICTORIOUS_ASSIGN_OR_RETURN(listed.object, ReadObjectRow(row, name));
  VICTORIOUS_ASSIGN_OR_RETURN(listed.review, ReadReview(row, kReviewColumns, name));
  listed.is_disputed = row.Integer(kReviewColumns + 4) != 0;
  return listed;
}

// A superset of a circle, in latitude and longitude.
GeoBox BoundsOf(const GeoCircle& circle) {
  constexpr double kPolarRadius_m = 6'335'000;  // the smallest radius of curvature of the ellipsoid
  const double angle = std::min(1.01 * circle.radius_m / kPolarRadius_m, std::numbers::pi);
  const double latitude = circle.centre.latitude_rad;
  const double cosine = std::cos(std::min(std::abs(latitude) + angle, std::numbers::pi / 2));
  const double width = cosine > 1e-3 ? std::min(angle / cosine, std::numbers::pi) : std::numbers::pi;
  return {latitude - angle, circle.centre.longitude_rad - width, latitude + angle, circle.centre.longitude_rad + width};
}

class SqliteTriageStore final : public TriageStore {
 public:
  explicit SqliteTriageStore(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

  Expected<std::vector<TriageObject>> Objects(const ObjectQuery& query, const ObjectSlice& slice) override {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    std::vector<TriageObject> objects;
    if (slice.order != ObjectOrder::kQueue) {
      VICTORIOUS_RETURN_IF_ERROR(ReadPart(matching, slice, std::nullopt, slice.offset, objects));
    } else {
      VICTORIOUS_RETURN_IF_ERROR(ReadQueue(matching, slice, objects));
    }
    VICTORIOUS_RETURN_IF_ERROR(Complete(objects));
    return objects;
  }

  Expected<std::vector<TriageObject>> ObjectsById(std::span<const std::int64_t> ids) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare(SelectListed() + "WHERE o.id IN (SELECT value FROM json_each(?)) AND "
                                                                "o.is_listed = 1 ORDER BY o.id LIMIT 1000"));
    select.Bind(IdList({ids.begin(), ids.end()}));
    std::vector<TriageObject> objects;
    VICTORIOUS_RETURN_IF_ERROR(ReadObjects(select, objects));
    VICTORIOUS_RETURN_IF_ERROR(Complete(objects));
    return objects;
  }

  Expected<std::optional<ObjectKey>> FindKey(std::int64_t object, const ObjectSlice& slice) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare("SELECT score, frames, verdict IS NOT NULL AND reviewed_utc_us < ? "
                                               "FROM objects WHERE id = ? AND is_listed = 1"));
    select.Bind(slice.queue_utc_us, object);
    VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Step());
    if (!found) return std::nullopt;
    return ObjectKey{.is_done = slice.order == ObjectOrder::kQueue && select.Integer(2) != 0,
                     .score = select.Real(0),
                     .frames = select.Integer(1),
                     .id = object};
  }

  Expected<std::int64_t> CountBefore(const ObjectQuery& query, const ObjectSlice& slice,
                                     const ObjectKey& key) override {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    std::int64_t count = 0;
    ObjectSlice before{.order = slice.order, .queue_utc_us = slice.queue_utc_us, .before = key};
    if (slice.order == ObjectOrder::kQueue && key.is_done) {
      VICTORIOUS_ASSIGN_OR_RETURN(count, CountPart(matching, {.queue_utc_us = slice.queue_utc_us}, false));
    }
    const auto part = slice.order == ObjectOrder::kQueue ? std::optional(key.is_done) : std::nullopt;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t rest, CountPart(matching, before, part));
    return count + rest;
  }

  Expected<std::int64_t> CountObjects(const ObjectQuery& query) override {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    return CountPart(matching, {}, std::nullopt);
  }

  Expected<ObjectCounts> Count(const ObjectQuery& query) override {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    // Counted here: a GROUP BY takes three times as long.
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare("SELECT o.order_score, o.verdict FROM objects o " + matching.text()));
    matching.Bind(select);
    ObjectCounts counts;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return counts;
      const double part = std::clamp(-select.Real(0) * ObjectCounts::kBins, 0.0, ObjectCounts::kBins - 1.0);
      ++counts.objects;
      ++counts.scores[static_cast<std::size_t>(part)];
      if (select.IsNull(1)) continue;
      ++(select.Text(1) == ToText(Verdict::kAccepted) ? counts.accepted : counts.rejected);
    }
  }

  Status VisitPlaces(const GeoBox& region, const ObjectQuery& query,
                     const std::function<bool(const PlacedObject&)>& visit) override {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare(fmt::format(
                              "SELECT o.id, o.model_id, -o.order_score, o.latitude_rad, o.longitude_rad, o.verdict, {} "
                              "FROM objects o INDEXED BY objects_by_place WHERE o.latitude_rad BETWEEN ? AND ? AND "
                              "o.longitude_rad BETWEEN ? AND ? AND o.is_listed = 1",
                              matching.Expression())));
    int parameter = matching.Bind(select);
    for (const double bound : {region.south_rad, region.north_rad, region.west_rad, region.east_rad}) {
      select.BindAt(parameter++, bound);
    }
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return {};
      PlacedObject placed{.id = select.Integer(0),
                          .model = select.Integer(1),
                          .score = select.Real(2),
                          .latitude_rad = select.Real(3),
                          .longitude_rad = select.Real(4),
                          .verdict = {},
                          .matches = select.Integer(6) != 0};
      if (!select.IsNull(5)) placed.verdict = FromText(kVerdictTexts, select.Text(5));
      if (!visit(placed)) return {};
    }
  }

  Expected<std::vector<PlacedShape>> PlaceShapes(std::span<const std::int64_t> ids) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare(SelectListed() + "WHERE o.id IN (SELECT value FROM json_each(?)) AND "
                                                                "o.latitude_rad IS NOT NULL ORDER BY o.id LIMIT 1000"));
    select.Bind(IdList({ids.begin(), ids.end()}));
    std::vector<PlacedShape> shapes;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return shapes;
      VICTORIOUS_ASSIGN_OR_RETURN(const ObjectRecord object, ReadObjectRow(select, connection_->name()));
      if (object.place) shapes.push_back({object.id, *object.place, object.heading_rad});
    }
  }

  Expected<std::optional<GeoBox>> PlaceBounds() override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT min(latitude_rad), min(longitude_rad), max(latitude_rad), max(longitude_rad) "
                             "FROM objects INDEXED BY objects_by_place WHERE latitude_rad IS NOT NULL AND "
                             "is_listed = 1"));
    VICTORIOUS_RETURN_IF_ERROR(select.Step());
    if (select.IsNull(0)) return std::nullopt;
    return GeoBox{select.Real(0), select.Real(1), select.Real(2), select.Real(3)};
  }

  Expected<std::vector<double>> PlaceHeights(std::int64_t video) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare("SELECT altitude_m FROM objects WHERE id IN (SELECT object_id FROM "
                                               "tracklets WHERE video_id = ?) AND altitude_m IS NOT NULL AND "
                                               "is_listed = 1 ORDER BY id LIMIT 1000"));
    select.Bind(video);
    std::vector<double> heights_m;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return heights_m;
      heights_m.push_back(select.Real(0));
    }
  }

  Expected<std::optional<SightingRecord>> BestSighting(std::int64_t object) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare(SelectSightings() +
                             "WHERE t.object_id = ? AND s.video_id = t.video_id AND s.frame = (SELECT frame FROM "
                             "sightings WHERE tracklet_id = t.id ORDER BY matches DESC, score DESC LIMIT 1) "
                             "ORDER BY s.matches DESC, s.score DESC LIMIT 1"));
    VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Bind(object).Step());
    if (!found) return std::nullopt;
    VICTORIOUS_ASSIGN_OR_RETURN(SightingRecord sighting, ReadSighting(select, connection_->name()));
    return sighting;
  }

  Expected<std::vector<ObjectNumbers>> ObjectsOfVideos() override {
    return ReadNumbers(
        // CROSS JOIN: in the order of the index, so that nothing is sorted.
        "SELECT t.video_id, count(DISTINCT t.object_id) FROM tracklets t INDEXED BY tracklets_by_video "
        "CROSS JOIN objects o ON o.id = t.object_id WHERE o.is_listed = 1 GROUP BY t.video_id");
  }

  Expected<std::vector<ObjectNumbers>> ObjectsOfModels() override {
    return ReadNumbers("SELECT model_id, count(*) FROM objects WHERE is_listed = 1 GROUP BY model_id");
  }

  Expected<std::vector<SearchRecord>> Searches() override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                                connection_->Prepare("SELECT video_id, model_id, next_frame, finished, program_version "
                                                     "FROM searches ORDER BY video_id, model_id"));
    std::vector<SearchRecord> searches;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return searches;
      searches.push_back({.video = select.Integer(0),
                          .model = select.Integer(1),
                          .next_frame = select.Integer(2),
                          .finished = select.Integer(3) != 0,
                          .options_json = {},
                          .program_version = select.Text(4)});
    }
  }

 private:
  Expected<std::vector<std::int64_t>> ReadIds(std::string_view sql, const std::string& text) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql));
    select.Bind(text);
    std::vector<std::int64_t> ids;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return ids;
      ids.push_back(select.Integer(0));
    }
  }

  // The listed objects between two latitudes whose place passes a test, which SQL cannot make: it has no geodesy.
  Expected<std::vector<std::int64_t>> ReadPlaced(double south_rad, double north_rad,
                                                 const std::function<bool(double, double)>& is_wanted) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT id, latitude_rad, longitude_rad FROM objects INDEXED BY objects_by_place "
                             "WHERE latitude_rad BETWEEN ? AND ? AND is_listed = 1"));
    select.Bind(south_rad, north_rad);
    std::vector<std::int64_t> ids;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return ids;
      if (is_wanted(select.Real(1), select.Real(2))) ids.push_back(select.Integer(0));
    }
  }

  Expected<std::vector<std::int64_t>> ReadNear(const GeoCircle& circle) {
    const TangentPlane plane(circle.centre);
    const GeoBox bounds = BoundsOf(circle);
    return ReadPlaced(bounds.south_rad, bounds.north_rad, [&](double latitude_rad, double longitude_rad) {
      // A circle may cross the antimeridian.
      const double east = std::remainder(longitude_rad - circle.centre.longitude_rad, 2 * std::numbers::pi);
      if (std::abs(east) > bounds.east_rad - circle.centre.longitude_rad) return false;
      return plane.EnuFromGeodetic({latitude_rad, longitude_rad, circle.centre.altitude_m}).norm() <= circle.radius_m;
    });
  }

  Expected<std::vector<std::int64_t>> ReadInside(const GeoPolygon& area) {
    const auto [south, north] = std::ranges::minmax(area.corners, {}, &GeodeticPoint::latitude_rad);
    return ReadPlaced(south.latitude_rad, north.latitude_rad, [&](double latitude_rad, double longitude_rad) {
      return IsInside(area, latitude_rad, longitude_rad);
    });
  }

  Expected<Conditions> MakeConditions(const ObjectQuery& query) {
    constexpr std::string_view kInList = "o.id IN (SELECT value FROM json_each(?))";
    Conditions conditions;
    conditions.Add("o.is_listed = 1");
    if (!query.models.empty()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, Models());
      std::vector<std::int64_t> ids;
      for (const ModelRecord& model : models) {
        if (std::ranges::find(query.models, model.name) != query.models.end()) ids.push_back(model.id);
      }
      conditions.Add("o.model_id IN (SELECT value FROM json_each(?))", IdList(ids));
    }
    if (query.min_score) conditions.Add("o.order_score <= ?", -*query.min_score);
    VICTORIOUS_RETURN_IF_ERROR(AddModelMinScores(query, conditions));
    if (query.video || query.from_s || query.to_s) {
      Conditions seen;
      if (query.video) seen.Add("video_id = ?", *query.video);
      if (query.from_s) seen.Add("last_time_s >= ?", *query.from_s);
      if (query.to_s) seen.Add("first_time_s <= ?", *query.to_s);
      conditions.AddQuery("o.id IN (SELECT object_id FROM tracklets {})", seen);
    }
    if (query.near) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> ids, ReadNear(*query.near));
      conditions.Add(kInList, IdList(ids));
    }
    if (query.area) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> ids, ReadInside(*query.area));
      conditions.Add(kInList, IdList(ids));
    }
    switch (query.review) {
      case ReviewState::kAny:
        break;
      case ReviewState::kNone:
        conditions.Add("o.verdict IS NULL");
        break;
      case ReviewState::kAccepted:
      case ReviewState::kRejected:
        conditions.Add(
            "o.verdict = ?",
            std::string(ToText(query.review == ReviewState::kAccepted ? Verdict::kAccepted : Verdict::kRejected)));
        break;
      case ReviewState::kOwn:
        conditions.Add("o.id IN (SELECT object_id FROM decisions WHERE reviewer = ? AND verdict IS NOT NULL)",
                       query.reviewer);
        break;
      case ReviewState::kNotOwn:
        conditions.Add("o.id NOT IN (SELECT object_id FROM decisions WHERE reviewer = ? AND verdict IS NOT NULL)",
                       query.reviewer);
        break;
      case ReviewState::kDisputed:
        conditions.Add("o.id IN (SELECT id FROM objects WHERE is_contested = 1)");
        break;
    }
    for (const std::string& word : query.words) {
      VICTORIOUS_ASSIGN_OR_RETURN(const auto models,
                                  ReadIds("SELECT id FROM models WHERE instr(lower(name), lower(?)) > 0", word));
      VICTORIOUS_ASSIGN_OR_RETURN(const auto noted, ReadIds("SELECT id FROM objects INDEXED BY objects_with_note "
                                                            "WHERE note <> '' AND instr(lower(note), lower(?)) > 0",
                                                            word));
      conditions.Add(
          "(o.model_id IN (SELECT value FROM json_each(?)) OR instr(CAST(o.id AS TEXT), ?) > 0 OR "
          "o.id IN (SELECT value FROM json_each(?)))",
          IdList(models), word, IdList(noted));
    }
    return conditions;
  }

  Status AddModelMinScores(const ObjectQuery& query, Conditions& conditions) {
    if (query.model_min_scores.empty()) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, Models());
    for (const ModelMinScore& one : query.model_min_scores) {
      const auto model = std::ranges::find(models, one.model, &ModelRecord::name);
      if (model == models.end()) continue;
      conditions.Add("(o.model_id <> ? OR o.verdict IS NOT NULL OR o.order_score <= ?)", model->id, -one.min_score);
    }
    return {};
  }

  Expected<std::vector<ModelRecord>> Models() {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(SelectModels()));
    std::vector<ModelRecord> models;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return models;
      VICTORIOUS_ASSIGN_OR_RETURN(ModelRecord model, ReadModel(select, connection_->name()));
      models.push_back(std::move(model));
    }
  }

  // Adds what limits a query to a part of the queue, and to one side of a key.
  static Conditions AddPosition(Conditions conditions, const ObjectSlice& slice, std::optional<bool> is_done) {
    if (is_done) {
      conditions.Add(*is_done ? "(o.verdict IS NOT NULL AND o.reviewed_utc_us < ?)"
                              : "(o.verdict IS NULL OR o.reviewed_utc_us >= ?)",
                     slice.queue_utc_us);
    }
    const auto& key = slice.after ? slice.after : slice.before;
    if (!key) return conditions;
    // In the part before that of the key everything precedes it, in the part after it nothing does.
    if (is_done && *is_done != key->is_done) return conditions;
    const std::string_view side = slice.after ? ">" : "<";
    if (slice.order == ObjectOrder::kNewest) {
      conditions.Add(slice.after ? "o.id < ?" : "o.id > ?", key->id);
    } else {
      conditions.Add(fmt::format("(o.order_score, o.order_frames, o.id) {} (?, ?, ?)", side), -key->score, -key->frames,
                     key->id);
    }
    return conditions;
  }

  Status ReadPart(const Conditions& matching, const ObjectSlice& slice, std::optional<bool> is_done,
                  std::int64_t offset, std::vector<TriageObject>& objects) {
    const Conditions conditions = AddPosition(matching, slice, is_done);
    const bool is_newest = slice.order == ObjectOrder::kNewest;
    const bool is_descending = slice.before.has_value() != is_newest;
    const std::string_view direction = is_descending ? "DESC" : "ASC";
    const std::string order = is_newest ? fmt::format("o.id {}", direction)
                                        : fmt::format("o.order_score {0}, o.order_frames {0}, o.id {0}", direction);
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                                connection_->Prepare(fmt::format("{}{}ORDER BY {} LIMIT ? OFFSET ?", SelectListed(),
                                                                 conditions.text(), order)));
    const int parameter = conditions.Bind(select);
    select.BindAt(parameter, slice.limit - std::ssize(objects));
    select.BindAt(parameter + 1, offset);
    return ReadObjects(select, objects);
  }

  Expected<std::int64_t> CountPart(const Conditions& matching, const ObjectSlice& slice, std::optional<bool> is_done) {
    const Conditions conditions = AddPosition(matching, slice, is_done);
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                                connection_->Prepare("SELECT count(*) FROM objects o " + conditions.text()));
    conditions.Bind(select);
    VICTORIOUS_RETURN_IF_ERROR(select.Step());
    return select.Integer(0);
  }

  // The two parts of the queue one after the other, from a key or an offset on.
  Status ReadQueue(const Conditions& matching, const ObjectSlice& slice, std::vector<TriageObject>& objects) {
    const auto& key = slice.after ? slice.after : slice.before;
    std::int64_t offset = slice.offset;
    for (const bool is_done : slice.before ? std::array{true, false} : std::array{false, true}) {
      if (key && (slice.after ? key->is_done && !is_done : !key->is_done && is_done)) continue;
      VICTORIOUS_RETURN_IF_ERROR(ReadPart(matching, slice, is_done, offset, objects));
      if (std::ssize(objects) >= slice.limit) break;
      if (offset > 0 && objects.empty()) {
        VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t left_out, CountPart(matching, slice, is_done));
        offset = std::max<std::int64_t>(0, offset - left_out);
      } else {
        offset = 0;
      }
    }
    return {};
  }

  Status ReadObjects(Statement& select, std::vector<TriageObject>& objects) {
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return {};
      VICTORIOUS_ASSIGN_OR_RETURN(TriageObject listed, ReadListed(select, connection_->name()));
      objects.push_back(std::move(listed));
    }
  }

  using ObjectPointers = std::map<std::int64_t, TriageObject*>;  // by id

  // Adds what stands in other tables.
  Status Complete(std::vector<TriageObject>& objects) {
    ObjectPointers by_id;
    std::vector<std::int64_t> ids;
    for (TriageObject& one : objects) {
      by_id[one.object.id] = &one;
      ids.push_back(one.object.id);
    }
    VICTORIOUS_RETURN_IF_ERROR(AddMoments(by_id, ids));
    return AddDecisions(by_id, ids);
  }

  Status AddDecisions(const ObjectPointers& by_id, const std::vector<std::int64_t>& ids) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT verdict, note, reviewer, decided_utc_us, object_id FROM decisions WHERE object_id "
                             "IN (SELECT value FROM json_each(?)) ORDER BY object_id, decided_utc_us DESC, reviewer"));
    select.Bind(IdList(ids));
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return {};
      std::vector<Review>& decisions = by_id.at(select.Integer(4))->decisions;
      if (std::ssize(decisions) == TriageObject::kMaxDecisions) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(Review decision, ReadReview(select, 0, connection_->name()));
      decisions.push_back(std::move(decision));
    }
  }

  Status AddMoments(const ObjectPointers& by_id, const std::vector<std::int64_t>& ids) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare(SelectTracklets() + "WHERE object_id IN (SELECT value FROM json_each(?)) "
                                                 "ORDER BY object_id, video_id, first_time_s"));
    select.Bind(IdList(ids));
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return {};
      const TrackletRecord tracklet = ReadTracklet(select);
      by_id.at(tracklet.object)->moments.push_back(tracklet);
    }
  }

  Expected<std::vector<ObjectNumbers>> ReadNumbers(std::string_view sql) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare(sql));
    std::vector<ObjectNumbers> numbers;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return numbers;
      numbers.push_back({select.Integer(0), select.Integer(1)});
    }
  }

  std::unique_ptr<Connection> connection_;
};

}  // namespace
}  // namespace victorious::sqlite

namespace victorious {

bool ObjectQuery::IsEmpty() const {
  return models.empty() && !video && !min_score && model_min_scores.empty() && !from_s && !to_s && !near && !area &&
         words.empty() && review == ReviewState::kAny;
}

Expected<std::unique_ptr<TriageStore>> OpenSqliteTriageStore(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, sqlite::OpenDatabase(path, StoreMode::kRead));
  return std::make_unique<sqlite::SqliteTriageStore>(std::move(connection));
}

}  // namespace victorious
