// TriageStore in an index.
#include "victorious/store/sql/sql_triage_store.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "victorious/geometry/web_mercator.h"
#include "victorious/store/sql/conditions.h"
#include "victorious/store/sql/database.h"
#include "victorious/store/sql/place_conditions.h"
#include "victorious/store/sql/records.h"

namespace victorious::sql {
namespace {

using ReviewState = ObjectQuery::ReviewState;

constexpr int kObjectRow = kObjectColumns.Size();  // the columns after those of the table
constexpr int kReviewColumns = kObjectRow + 4;

std::string SelectListed() {
  return "SELECT " + kObjectColumns.Names("o") +
         ", o.score, o.frames, o.first_time_s, o.last_time_s, o.verdict, o.note, o.reviewer, o.reviewed_utc_us, "
         "o.is_contested "
         "FROM objects o ";
}

Expected<TriageObject> ReadListed(const Row& row, std::string_view name) {
  TriageObject listed;
  VICTORIOUS_ASSIGN_OR_RETURN(listed.object, ReadObjectRow(row, name));
  VICTORIOUS_ASSIGN_OR_RETURN(listed.review, ReadReview(row, kReviewColumns, name));
  listed.is_disputed = row.Integer(kReviewColumns + 4) != 0;
  return listed;
}

// A superset of a grid: rounding may not leave out an object at its border.
GeoBox BoundsOf(const MapGrid& grid) {
  constexpr double kMargin_rad = 1e-9;
  const auto longitude = [](double east) { return std::numbers::pi * (2 * east - 1); };
  const auto latitude = [](double south) { return std::atan(std::sinh(std::numbers::pi * (1 - 2 * south))); };
  return {latitude(grid.north + grid.side) - kMargin_rad, longitude(grid.west) - kMargin_rad,
          latitude(grid.north) + kMargin_rad, longitude(grid.west + grid.side) + kMargin_rad};
}

class SqlTriageStore final : public TriageStore {
 public:
  explicit SqlTriageStore(std::unique_ptr<Database> database)
      : database_(std::move(database)), dialect_(database_->dialect()) {}

  Status AtOneMoment(const std::function<Status()>& read) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change reading, Change::BeginReading(*database_));
    VICTORIOUS_RETURN_IF_ERROR(read());
    return reading.Commit();
  }

  Expected<std::vector<VideoRecord>> Videos() override {
    return database_->ReadAll(SelectVideos() + "ORDER BY v.id", ValueList(), ReadVideo);
  }

  Expected<std::vector<ModelRecord>> Models() override {
    return database_->ReadAll(SelectModels() + "ORDER BY id", ValueList(),
                              [&](const Row& row) { return ReadModel(row, database_->name()); });
  }

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
    VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TriageObject> objects,
                                ReadObjects(fmt::format("{}WHERE {} AND o.is_listed = 1 ORDER BY o.id LIMIT 1000",
                                                        SelectListed(), IsOneOf(dialect_, "o.id")),
                                            ValueList(ListText(dialect_, ids))));
    VICTORIOUS_RETURN_IF_ERROR(Complete(objects));
    return objects;
  }

  Expected<std::optional<ObjectSortKey>> FindKey(std::int64_t object, const ObjectSlice& slice) override {
    return database_->ReadOne(
        "SELECT score, frames, verdict IS NOT NULL AND reviewed_utc_us < ? FROM objects WHERE id = ? AND is_listed = 1",
        ValueList(slice.queue_utc_us, object), [&](const Row& row) -> Expected<ObjectSortKey> {
          return ObjectSortKey{.is_done = slice.order == ObjectOrder::kQueue && row.Integer(2) != 0,
                               .score = row.Real(0),
                               .frames = row.Integer(1),
                               .id = object};
        });
  }

  Expected<std::int64_t> CountBefore(const ObjectQuery& query, const ObjectSlice& slice,
                                     const ObjectSortKey& key) override {
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
    static_assert(ObjectCounts::kBins == 100);
    constexpr std::string_view kScorePart = "least(greatest(trunc(-o.order_score * 100), 0), 99)::bigint";
    // SQLite counts here, because a GROUP BY takes three times as long; a server would send each row.
    const std::string sql =
        dialect_ == Dialect::kSqlite
            ? "SELECT CAST(min(max(-o.order_score * 100, 0), 99) AS INTEGER), o.verdict, 1 FROM objects o " +
                  matching.text()
            : fmt::format("SELECT {0}, o.verdict, count(*) FROM objects o {1}GROUP BY {0}, o.verdict", kScorePart,
                          matching.text());
    ObjectCounts counts;
    VICTORIOUS_RETURN_IF_ERROR(
        database_->Visit(sql, ValuesOf(matching), RowCount::kFew, [&](const Row& row) -> Expected<bool> {
          const std::int64_t number = row.Integer(2);
          counts.objects += number;
          const auto bin = static_cast<std::size_t>(row.Integer(0));
          counts.scores[bin] += number;
          if (row.IsNull(1)) return true;
          const bool is_accepted = row.Text(1) == ToText(Verdict::kAccepted);
          (is_accepted ? counts.accepted : counts.rejected) += number;
          (is_accepted ? counts.accepted_scores : counts.rejected_scores)[bin] += number;
          return true;
        }));
    return counts;
  }

  Status VisitPlaces(const GeoBox& region, const ObjectQuery& query,
                     const std::function<bool(const PlacedObject&)>& visit) override {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    ValueList values;
    int parameter = matching.Bind(values);
    for (const double bound : {region.south_rad, region.north_rad, region.west_rad, region.east_rad}) {
      values.BindAt(parameter++, bound);
    }
    return database_->Visit(
        fmt::format("SELECT o.id, o.model_id, -o.order_score, o.latitude_rad, o.longitude_rad, o.verdict, {} "
                    "FROM objects o{} WHERE o.latitude_rad BETWEEN ? AND ? AND o.longitude_rad BETWEEN ? AND ? AND "
                    "o.is_listed = 1 ORDER BY o.latitude_rad, o.longitude_rad",
                    matching.Expression(), IndexedBy(dialect_, "objects_by_place")),
        values, RowCount::kMany, [&](const Row& row) -> Expected<bool> {
          PlacedObject placed{.id = row.Integer(0),
                              .model = row.Integer(1),
                              .score = row.Real(2),
                              .latitude_rad = row.Real(3),
                              .longitude_rad = row.Real(4),
                              .verdict = {},
                              .matches = row.Integer(6) != 0};
          if (!row.IsNull(5)) placed.verdict = FromText(kVerdictTexts, row.Text(5));
          return visit(placed);
        });
  }

  Expected<std::vector<PlaceCell>> SumPlaces(const MapGrid& grid, const ObjectQuery& query) override {
    return dialect_ == Dialect::kSqlite ? SumVisited(grid, query) : SumInDatabase(grid, query);
  }

  Expected<std::vector<PlacedShape>> PlaceShapes(std::span<const std::int64_t> ids) override {
    std::vector<PlacedShape> shapes;
    VICTORIOUS_RETURN_IF_ERROR(database_->Visit(
        fmt::format("{}WHERE {} AND o.latitude_rad IS NOT NULL ORDER BY o.id LIMIT 1000", SelectListed(),
                    IsOneOf(dialect_, "o.id")),
        ValueList(ListText(dialect_, ids)), RowCount::kFew, [&](const Row& row) -> Expected<bool> {
          VICTORIOUS_ASSIGN_OR_RETURN(const ObjectRecord object, ReadObjectRow(row, database_->name()));
          if (object.place) shapes.push_back({object.id, *object.place, object.heading_rad});
          return true;
        }));
    return shapes;
  }

  Expected<std::optional<GeoBox>> PlaceBounds() override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const auto bounds,
        database_->ReadOne(fmt::format("SELECT min(latitude_rad), min(longitude_rad), max(latitude_rad), "
                                       "max(longitude_rad) FROM objects{} WHERE latitude_rad IS NOT NULL AND "
                                       "is_listed = 1",
                                       IndexedBy(dialect_, "objects_by_place")),
                           ValueList(), [](const Row& row) -> Expected<std::optional<GeoBox>> {
                             if (row.IsNull(0)) return std::nullopt;
                             return GeoBox{row.Real(0), row.Real(1), row.Real(2), row.Real(3)};
                           }));
    return bounds.value_or(std::nullopt);
  }

  Expected<std::vector<std::int64_t>> VideosShowing(double latitude_rad, double longitude_rad) override {
    return database_->ReadAll(
        fmt::format("SELECT video_id FROM shown_ground{} WHERE south_rad <= ? AND north_rad >= ? AND west_rad <= ? AND "
                    "east_rad >= ? UNION SELECT id FROM videos WHERE has_shown_ground = 0 ORDER BY 1",
                    IndexedBy(dialect_, "shown_ground_by_place")),
        ValueList(latitude_rad, latitude_rad, longitude_rad, longitude_rad),
        [](const Row& row) -> Expected<std::int64_t> { return row.Integer(0); });
  }

  Expected<std::vector<double>> PlaceHeights(std::int64_t video) override {
    return database_->ReadAll(
        "SELECT altitude_m FROM objects WHERE id IN (SELECT object_id FROM tracklets WHERE video_id = ?) AND "
        "altitude_m IS NOT NULL AND is_listed = 1 ORDER BY id LIMIT 1000",
        ValueList(video), [](const Row& row) -> Expected<double> { return row.Real(0); });
  }

  Expected<std::optional<SightingRecord>> BestSighting(std::int64_t object) override {
    // PostgreSQL looks into the part of sightings that has the video.
    constexpr std::string_view kOfTracklet =
        "WHERE t.object_id = ? AND s.video_id = t.video_id AND s.frame = (SELECT b.frame FROM sightings b WHERE {}"
        "b.tracklet_id = t.id ORDER BY b.matches DESC, b.score DESC LIMIT 1) ORDER BY s.matches DESC, s.score DESC "
        "LIMIT 1";
    const std::string_view part = dialect_ == Dialect::kSqlite ? "" : "b.video_id = t.video_id AND ";
    return database_->ReadOne(SelectSightings() + fmt::format(kOfTracklet, part), ValueList(object),
                              [&](const Row& row) { return ReadSighting(row, database_->name()); });
  }

  Expected<std::vector<ObjectNumbers>> ObjectsOfVideos() override {
    // CROSS JOIN: SQLite joins in the order of the index, so that nothing is sorted.
    return ReadNumbers(
        fmt::format("SELECT t.video_id, count(DISTINCT t.object_id) FROM tracklets t{} {} JOIN objects o ON o.id = "
                    "t.object_id WHERE o.is_listed = 1 GROUP BY t.video_id ORDER BY t.video_id",
                    IndexedBy(dialect_, "tracklets_by_video"), dialect_ == Dialect::kSqlite ? "CROSS" : "INNER"));
  }

  Expected<std::vector<ObjectNumbers>> ObjectsOfModels() override {
    return ReadNumbers(
        "SELECT model_id, count(*) FROM objects WHERE is_listed = 1 GROUP BY model_id ORDER BY model_id");
  }

  Expected<std::vector<SearchRecord>> Searches() override {
    return database_->ReadAll(
        "SELECT video_id, model_id, next_frame, finished, program_version FROM searches ORDER BY video_id, model_id",
        ValueList(), [](const Row& row) -> Expected<SearchRecord> {
          return SearchRecord{.video = row.Integer(0),
                              .model = row.Integer(1),
                              .next_frame = row.Integer(2),
                              .finished = row.Integer(3) != 0,
                              .options_json = {},
                              .program_version = row.Text(4)};
        });
  }

  Expected<std::vector<SearchPart>> SearchParts() override {
    return database_->ReadAll(SelectSearchParts(dialect_) + std::string(kOrderSearchParts), ValueList(),
                              [&](const Row& row) { return ReadSearchPart(row, database_->name()); });
  }

 private:
  // SQLite may lack the functions, and visits as fast.
  Expected<std::vector<PlaceCell>> SumVisited(const MapGrid& grid, const ObjectQuery& query) {
    std::vector<PlaceCell> all(static_cast<std::size_t>(grid.cells) * static_cast<std::size_t>(grid.cells));
    VICTORIOUS_RETURN_IF_ERROR(VisitPlaces(BoundsOf(grid), query, [&](const PlacedObject& placed) {
      const double x = (MercatorEast(placed.longitude_rad) - grid.west) / grid.side;
      const double y = (MercatorSouth(placed.latitude_rad) - grid.north) / grid.side;
      if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) return true;
      const int column = static_cast<int>(x * grid.cells);
      const int row = static_cast<int>(y * grid.cells);
      PlaceCell& cell = all[static_cast<std::size_t>(row * grid.cells + column)];
      cell = {.column = column,
              .row = row,
              .count = cell.count + 1,
              .matches = cell.matches + (placed.matches ? 1 : 0),
              .sum_x = cell.sum_x + x,
              .sum_y = cell.sum_y + y,
              .best = std::max(cell.best, placed.score)};
      return true;
    }));
    std::erase_if(all, [](const PlaceCell& cell) { return cell.count == 0; });
    return all;
  }

  Expected<std::vector<PlaceCell>> SumInDatabase(const MapGrid& grid, const ObjectQuery& query) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Conditions matching, MakeConditions(query));
    ValueList values;
    int parameter = matching.Bind(values);
    const GeoBox bounds = BoundsOf(grid);
    for (const double value : {grid.west, grid.side, grid.north, grid.side, bounds.south_rad, bounds.north_rad,
                               bounds.west_rad, bounds.east_rad}) {
      values.BindAt(parameter++, value);
    }
    const std::string sql = fmt::format(
        "SELECT trunc(x * {0})::bigint, trunc(y * {0})::bigint, count(*), count(*) FILTER (WHERE matches <> 0), "
        "sum(x), sum(y), -min(order_score) FROM (SELECT ({1})::int AS matches, "
        "(o.longitude_rad / (2 * pi()) + 0.5 - ?) / ? AS x, (0.5 - asinh(tan(o.latitude_rad)) / (2 * pi()) - ?) / ? AS "
        "y, o.order_score FROM objects o WHERE o.latitude_rad BETWEEN ? AND ? AND o.longitude_rad BETWEEN ? AND ? AND "
        "o.is_listed = 1) placed WHERE x >= 0 AND x < 1 AND y >= 0 AND y < 1 GROUP BY 1, 2 ORDER BY 2, 1",
        grid.cells, matching.Expression());
    return database_->ReadAll(sql, values, [](const Row& row) -> Expected<PlaceCell> {
      return PlaceCell{.column = static_cast<int>(row.Integer(0)),
                       .row = static_cast<int>(row.Integer(1)),
                       .count = row.Integer(2),
                       .matches = row.Integer(3),
                       .sum_x = row.Real(4),
                       .sum_y = row.Real(5),
                       .best = row.Real(6)};
    });
  }

  Expected<Conditions> MakeConditions(const ObjectQuery& query) {
    Conditions conditions;
    conditions.Add("o.is_listed = 1");
    if (!query.models.empty()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, Models());
      std::vector<std::int64_t> ids;
      for (const ModelRecord& model : models) {
        if (std::ranges::find(query.models, model.name) != query.models.end()) ids.push_back(model.id);
      }
      conditions.Add(IsOneOf(dialect_, "o.model_id"), ListText(dialect_, ids));
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
    if (query.near) AddNear(dialect_, *query.near, PlacedObjects::kListed, conditions);
    if (query.area) AddInside(dialect_, *query.area, PlacedObjects::kListed, conditions);
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
      const std::string lower = Lower(dialect_, "?");
      conditions.Add(
          fmt::format(
              "(o.model_id IN (SELECT id FROM models WHERE {}) OR {} OR o.id IN (SELECT id FROM objects{} WHERE "
              "note <> '' AND {}))",
              Contains(dialect_, Lower(dialect_, "name"), lower), Contains(dialect_, "CAST(o.id AS TEXT)", "?"),
              IndexedBy(dialect_, "objects_with_note"), Contains(dialect_, Lower(dialect_, "note"), lower)),
          word, word, word);
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
    ValueList values;
    const int parameter = conditions.Bind(values);
    values.BindAt(parameter, slice.limit - std::ssize(objects));
    values.BindAt(parameter + 1, offset);
    VICTORIOUS_ASSIGN_OR_RETURN(
        std::vector<TriageObject> part,
        ReadObjects(fmt::format("{}{}ORDER BY {} LIMIT ? OFFSET ?", SelectListed(), conditions.text(), order), values));
    std::ranges::move(part, std::back_inserter(objects));
    return {};
  }

  Expected<std::int64_t> CountPart(const Conditions& matching, const ObjectSlice& slice, std::optional<bool> is_done) {
    const Conditions conditions = AddPosition(matching, slice, is_done);
    return database_->ReadInteger("SELECT count(*) FROM objects o " + conditions.text(), ValuesOf(conditions));
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

  Expected<std::vector<TriageObject>> ReadObjects(const std::string& sql, const ValueList& values) {
    return database_->ReadAll(sql, values, [&](const Row& row) { return ReadListed(row, database_->name()); });
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
    return database_->Visit(
        fmt::format("SELECT verdict, note, reviewer, decided_utc_us, object_id FROM decisions WHERE {} "
                    "ORDER BY object_id, decided_utc_us DESC, reviewer",
                    IsOneOf(dialect_, "object_id")),
        ValueList(ListText(dialect_, ids)), RowCount::kFew, [&](const Row& row) -> Expected<bool> {
          std::vector<Review>& decisions = by_id.at(row.Integer(4))->decisions;
          if (std::ssize(decisions) == TriageObject::kMaxDecisions) return true;
          VICTORIOUS_ASSIGN_OR_RETURN(Review decision, ReadReview(row, 0, database_->name()));
          decisions.push_back(std::move(decision));
          return true;
        });
  }

  Status AddMoments(const ObjectPointers& by_id, const std::vector<std::int64_t>& ids) {
    return database_->Visit(fmt::format("{}WHERE {} ORDER BY object_id, video_id, first_time_s", SelectTracklets(),
                                        IsOneOf(dialect_, "object_id")),
                            ValueList(ListText(dialect_, ids)), RowCount::kFew, [&](const Row& row) -> Expected<bool> {
                              const TrackletRecord tracklet = ReadTracklet(row);
                              by_id.at(tracklet.object)->moments.push_back(tracklet);
                              return true;
                            });
  }

  Expected<std::vector<ObjectNumbers>> ReadNumbers(const std::string& sql) {
    return database_->ReadAll(sql, ValueList(), [](const Row& row) -> Expected<ObjectNumbers> {
      return ObjectNumbers{row.Integer(0), row.Integer(1)};
    });
  }

  std::unique_ptr<Database> database_;
  Dialect dialect_;
};

}  // namespace

std::unique_ptr<TriageStore> MakeTriageStore(std::unique_ptr<Database> database) {
  return std::make_unique<SqlTriageStore>(std::move(database));
}

}  // namespace victorious::sql

namespace victorious {

bool ObjectQuery::IsEmpty() const {
  return models.empty() && !video && !min_score && model_min_scores.empty() && !from_s && !to_s && !near && !area &&
         words.empty() && review == ReviewState::kAny;
}

Expected<std::unique_ptr<TriageStore>> OpenTriageStore(const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto database, sql::OpenDatabase(name, StoreMode::kRead));
  return sql::MakeTriageStore(std::move(database));
}

}  // namespace victorious
