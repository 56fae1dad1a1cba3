#include "victorious/apps/serve/object_routes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/index_lookup.h"
#include "victorious/apps/serve/object_key.h"
#include "victorious/apps/serve/object_package.h"
#include "victorious/apps/serve/object_tiles.h"
#include "victorious/apps/serve/request_slot.h"
#include "victorious/base/json.h"
#include "victorious/store/threshold_store.h"

namespace victorious {
namespace {

constexpr std::array<std::pair<std::string_view, ObjectOrder>, 3> kOrders = {
    {{"rank", ObjectOrder::kRank}, {"queue", ObjectOrder::kQueue}, {"newest", ObjectOrder::kNewest}}};

constexpr std::array<std::pair<std::string_view, ObjectQuery::ReviewState>, 6> kReviewStates = {
    {{"none", ObjectQuery::ReviewState::kNone},
     {"accepted", ObjectQuery::ReviewState::kAccepted},
     {"rejected", ObjectQuery::ReviewState::kRejected},
     {"own", ObjectQuery::ReviewState::kOwn},
     {"not_own", ObjectQuery::ReviewState::kNotOwn},
     {"disputed", ObjectQuery::ReviewState::kDisputed}}};

// The value of one of the texts of a table. Error: kInvalidArgument that lists them.
template <typename Value, std::size_t count>
ApiExpected<std::optional<Value>> ReadChoice(QueryReader& query, std::string_view name,
                                             const std::array<std::pair<std::string_view, Value>, count>& table) {
  const auto text = query.Text(name);
  if (!text) return std::nullopt;
  std::string choices;
  for (const auto& [choice, value] : table) {
    if (*text == choice) return value;
    choices += fmt::format("{}{}", choices.empty() ? "" : ", ", choice);
  }
  return FailField(std::string(name), fmt::format("{} \"{}\": must be one of {}", name, *text, choices));
}

// The parts of a text between separators, without empty ones.
std::vector<std::string> Split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(separator));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    if (!part.empty()) parts.emplace_back(part);
  }
  return parts;
}

std::string CursorOf(const ObjectSortKey& key) {
  return fmt::format("{}_{:.17g}_{}_{}", key.is_done ? 1 : 0, key.score, key.frames, key.id);
}

std::optional<ObjectSortKey> ParseCursor(std::string_view text) {
  ObjectSortKey key;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  const auto parse = [&](auto& value, bool is_last) {
    const auto [next, error] = std::from_chars(at, end, value);
    const bool is_valid = error == std::errc() && (is_last ? next == end : next != end && *next == '_');
    at = is_valid && !is_last ? next + 1 : next;
    return is_valid;
  };
  int is_done = 0;
  const bool is_valid =
      parse(is_done, false) && parse(key.score, false) && parse(key.frames, false) && parse(key.id, true);
  key.is_done = is_done == 1;
  return is_valid ? std::optional(key) : std::nullopt;
}

// Which part of the list is wanted.
struct ListRequest {
  ObjectSlice slice;
  std::optional<std::string> cursor;
  std::optional<std::int64_t> after;
  std::optional<std::int64_t> before;
  std::optional<std::int64_t> around;
  std::optional<std::int64_t> offset;
};

ApiExpected<ListRequest> ReadListRequest(QueryReader& query) {
  constexpr std::int64_t kDefaultLimit = 200;
  ListRequest wanted;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto order, ReadChoice(query, "sort", kOrders));
  wanted.slice.order = order.value_or(ObjectOrder::kRank);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto since, query.Integer("since", 0, INT64_MAX));
  wanted.slice.queue_utc_us = since.value_or(INT64_MAX);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto limit, query.Integer("limit", 1, 1000));
  wanted.slice.limit = limit.value_or(kDefaultLimit);
  wanted.cursor = query.Text("cursor");
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.after, query.Integer("after", 0, INT64_MAX));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.before, query.Integer("before", 0, INT64_MAX));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.around, query.Integer("around", 0, INT64_MAX));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.offset, query.Integer("offset", 0, INT64_MAX));
  const std::array is_given = {wanted.cursor.has_value(), wanted.after.has_value(), wanted.before.has_value(),
                               wanted.around.has_value(), wanted.offset.has_value()};
  if (std::ranges::count(is_given, true) > 1) {
    return FailField("cursor", "cursor, after, before, around and offset: give one of them");
  }
  return wanted;
}

Json RowsToJson(const std::vector<TriageObject>& objects, const IndexLists& lists) {
  Json rows = Json::array();
  for (const TriageObject& one : objects) rows.push_back(ObjectToJson(one, lists));
  return rows;
}

// The body of a review. Error: the field that is wrong.
ApiExpected<ReviewChange> ParseReview(std::string_view body) {
  constexpr std::size_t kMaxNoteBytes = 4000;
  constexpr std::size_t kMaxNameBytes = 100;
  const auto json = ParseJson(body);
  if (!json) return std::unexpected(ApiError(json.error()));
  if (!json->is_object()) return FailField("", "the body must be {\"verdict\": …, \"note\": …}");
  const auto read_text = [](const Json& value, const std::string& key, std::size_t limit) -> ApiExpected<std::string> {
    if (!value.is_string()) return FailField(key, fmt::format("The {} must be a text", key));
    std::string text = value.get<std::string>();
    if (text.size() <= limit) return text;
    return FailField(key, fmt::format("The {} has {} bytes; at most {} are kept", key, text.size(), limit));
  };
  ReviewChange review;
  for (const auto& [key, value] : json->items()) {
    if (key == "verdict") {
      review.verdict = std::optional<Verdict>();
      if (value.is_null()) continue;
      if (value.is_string()) review.verdict = FromText(kVerdictTexts, value.get<std::string>());
      if (!*review.verdict) return FailField("verdict", "The verdict must be \"accepted\", \"rejected\" or null");
    } else if (key == "note") {
      VICTORIOUS_ASSIGN_OR_RETURN(review.note, read_text(value, key, kMaxNoteBytes));
    } else if (key == "reviewer") {
      VICTORIOUS_ASSIGN_OR_RETURN(review.reviewer, read_text(value, key, kMaxNameBytes));
    } else {
      return FailField(key, "Only verdict, note and reviewer can be set");
    }
  }
  return review;
}

// The body of a regrouping.
struct RegroupRequest {
  TrackletGroups groups;
  std::optional<std::int64_t> undo;  // the correction that is taken back
};

// Error: the field that is wrong.
ApiExpected<RegroupRequest> ParseRegroupRequest(std::string_view body) {
  constexpr std::size_t kMaxGroups = 20;
  constexpr std::size_t kMaxMoments = 1000;
  const auto json = ParseJson(body);
  if (!json) return std::unexpected(ApiError(json.error()));
  const auto wrong = [&] {
    return FailField("groups", fmt::format("The body must be {{\"groups\": [[id of a moment, …], …]}}, with or without "
                                           "\"undo\": number; at most {} groups and {} moments",
                                           kMaxGroups, kMaxMoments));
  };
  if (!json->is_object()) return wrong();
  RegroupRequest read;
  std::size_t moments = 0;
  for (const auto& [key, value] : json->items()) {
    if (key == "undo" && value.is_number_integer()) {
      read.undo = value.template get<std::int64_t>();
      continue;
    }
    if (key != "groups" || !value.is_array() || value.size() > kMaxGroups) return wrong();
    for (const auto& group : value) {
      if (!group.is_array()) return wrong();
      moments += group.size();
      if (moments > kMaxMoments) return wrong();
      std::vector<std::int64_t>& ids = read.groups.groups.emplace_back();
      for (const auto& id : group) {
        if (!id.is_number_integer()) return wrong();
        ids.push_back(id.template get<std::int64_t>());
      }
    }
  }
  return read;
}

// The thresholds in force.
ApiExpected<std::vector<ModelMinScore>> MinScores(IndexView& index) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ModelThreshold> thresholds, reader->thresholds->Thresholds());
  std::vector<ModelMinScore> scores;
  for (ModelThreshold& one : thresholds) scores.push_back({std::move(one.model), one.min_score});
  return scores;
}

// The filters of the list, of its counts and of tiles.
ApiExpected<ObjectQuery> ReadObjectQuery(IndexView& index, QueryReader& query, const Caller& caller) {
  constexpr std::size_t kMaxWords = 16;
  ObjectQuery wanted;
  if (const auto models = query.Text("model")) wanted.models = Split(*models, ',');
  if (const auto words = query.Text("q")) wanted.words = Split(*words, ' ');
  if (wanted.words.size() > kMaxWords) return FailField("q", fmt::format("q: at most {} words", kMaxWords));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto review, ReadChoice(query, "review", kReviewStates));
  wanted.review = review.value_or(ObjectQuery::ReviewState::kAny);
  // With accounts, one's own decisions are those of the account.
  const auto reviewer = query.Text("reviewer");
  wanted.reviewer = caller.is_open ? reviewer.value_or("") : caller.name();
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.video, query.Integer("video", 0, INT64_MAX));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.min_score, query.Number("min_score", 0, 1));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.from_s, query.Number("from", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.to_s, query.Number("to", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.near, query.Circle("near"));
  VICTORIOUS_ASSIGN_OR_RETURN(wanted.area, query.Area("area"));
  constexpr std::array<std::pair<std::string_view, ThresholdUse>, 2> kThresholds = {
      {{ToText(kThresholdUseTexts, ThresholdUse::kApplied), ThresholdUse::kApplied},
       {ToText(kThresholdUseTexts, ThresholdUse::kIgnored), ThresholdUse::kIgnored}}};
  VICTORIOUS_ASSIGN_OR_RETURN(const auto thresholds, ReadChoice(query, "thresholds", kThresholds));
  if (thresholds == ThresholdUse::kApplied) {
    VICTORIOUS_ASSIGN_OR_RETURN(wanted.model_min_scores, MinScores(index));
  }
  return wanted;
}

// The key of an object (object_key.h); null without a sighting.
ApiExpected<Json> KeyOf(const TriageObject& object, const IndexLists& lists, const IndexReader& reader) {
  const ModelRecord* model = lists.Model(object.object.model);
  Json key;
  VICTORIOUS_RETURN_IF_ERROR(
      reader.sightings->VisitSightings({.object = object.object.id}, [&](SightingRecord&& first) {
        const VideoRecord* video = lists.Video(first.video);
        if (video != nullptr && model != nullptr) key = FormatObjectKey(*video, first, model->name);
        return false;
      }));
  return key;
}

// The objects that a key names: at most one. Error: kInvalidArgument for a text that is no key.
ApiExpected<std::vector<TriageObject>> ObjectsOfKey(std::string_view key, const IndexLists& lists,
                                                    const IndexReader& reader) {
  constexpr double kRounding_s = 1e-6;
  const std::optional<KeyedSighting> keyed = ParseObjectKey(key);
  if (!keyed) return FailField("key", "The key must be that of an object of another answer");
  const auto video = std::ranges::find_if(lists.videos, [&](const VideoRecord& one) { return keyed->IsIn(one); });
  std::vector<std::int64_t> ids;
  if (video != lists.videos.end()) {
    const double time_s = 1e-6 * static_cast<double>(keyed->time_us);
    const SightingFilter at{
        .model_name = keyed->model, .from_s = time_s - kRounding_s, .to_s = time_s + kRounding_s, .video = video->id};
    VICTORIOUS_RETURN_IF_ERROR(reader.sightings->VisitSightings(at, [&](SightingRecord&& sighting) {
      if (keyed->IsAt(sighting)) ids = {sighting.object};
      return ids.empty();
    }));
  }
  return reader.objects->ObjectsById(ids);
}

}  // namespace

ApiExpected<HttpResponse> ObjectRoutes::List(const ApiCall& call) {
  QueryReader& query = call.query;
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectQuery filter, ReadObjectQuery(index_, query, call.caller));
  VICTORIOUS_ASSIGN_OR_RETURN(ListRequest wanted, ReadListRequest(query));
  const auto ids_text = query.Text("ids");
  const auto key_text = query.Text("key");
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  TriageStore& store = *reader->objects;
  const auto whole = [&](const std::vector<TriageObject>& objects) {
    return JsonResponse(
        {{"objects", RowsToJson(objects, *lists)}, {"next_cursor", nullptr}, {"offset", nullptr}, {"total", nullptr}});
  };
  if (key_text) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TriageObject> objects, ObjectsOfKey(*key_text, *lists, *reader));
    return whole(objects);
  }
  if (ids_text) {
    constexpr std::size_t kMaxIds = 1000;
    std::vector<std::int64_t> ids;
    for (const std::string& text : Split(*ids_text, ',')) {
      const auto id = ParseId(text, "object");
      if (!id || ids.size() == kMaxIds) return FailField("ids", "ids: must be at most 1000 ids with commas between");
      ids.push_back(*id);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TriageObject> objects, store.ObjectsById(ids));
    return whole(objects);
  }
  ObjectSlice& slice = wanted.slice;
  if (wanted.cursor) {
    slice.after = ParseCursor(*wanted.cursor);
    if (!slice.after) return FailField("cursor", "cursor: must be the next_cursor of another answer");
  }
  const auto given = wanted.after ? wanted.after : wanted.before ? wanted.before : wanted.around;
  if (given) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ObjectSortKey> key, store.FindKey(*given, slice));
    if (!key) return NotFound(fmt::format("object {} is not in the index (a search may have joined it)", *given));
    if (wanted.after) slice.after = key;
    if (wanted.before) slice.before = key;
    if (wanted.around) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t position, store.CountBefore(filter, slice, *key));
      wanted.offset = position - position % slice.limit;
    }
  }
  const bool has_position = !slice.after && !slice.before;
  if (has_position) slice.offset = wanted.offset.value_or(0);
  // One more than is given out: whether there is another page.
  ++slice.limit;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TriageObject> objects, store.Objects(filter, slice));
  Json next;
  if (std::ssize(objects) == slice.limit) {
    objects.pop_back();
    if (!slice.before) {
      VICTORIOUS_ASSIGN_OR_RETURN(const auto key, store.FindKey(objects.back().object.id, slice));
      if (key) next = CursorOf(*key);
    }
  }
  Json total;
  if (has_position) {
    VICTORIOUS_ASSIGN_OR_RETURN(total, store.CountObjects(filter));
  }
  return JsonResponse({{"objects", RowsToJson(objects, *lists)},
                       {"next_cursor", std::move(next)},
                       {"offset", has_position ? Json(slice.offset) : Json()},
                       {"total", std::move(total)}});
}

ApiExpected<HttpResponse> ObjectRoutes::Counts(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectQuery filter, ReadObjectQuery(index_, call.query, call.caller));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectCounts counts, reader->objects->Count(filter));
  return JsonResponse(CountsToJson(counts));
}

ApiExpected<HttpResponse> ObjectRoutes::Package(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectQuery filter, ReadObjectQuery(index_, call.query, call.caller));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  const VideoNames names = call.caller.May(Role::kAdmin) ? VideoNames::kWhole : VideoNames::kWithoutFolders;
  const RequestSlot slot(packages_);
  if (!slot.is_taken()) {
    return std::unexpected(
        ApiError(Error{ErrorCode::kUnavailable, "another GeoPackage is being made: ask again in some seconds"}));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(FileSlice file, MakeObjectPackage(*reader->objects, filter, names, call.cancel));
  return HttpResponse{
      .content_type = "application/geopackage+sqlite3",
      .headers = {{"Cache-Control", "no-store"}, {"Content-Disposition", "attachment; filename=\"objects.gpkg\""}},
      .file = std::move(file)};
}

ApiExpected<HttpResponse> ObjectRoutes::Tile(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectQuery filter, ReadObjectQuery(index_, call.query, call.caller));
  // Part of the key of the browser's cache: tiles change with the index and its reviews.
  [[maybe_unused]] const auto version = call.query.Text("v");
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t zoom, ParseId(call.parameters[0], "zoom"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t x, ParseId(call.parameters[1], "column"));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t y, ParseId(call.parameters[2], "row"));
  if (zoom > kMaxTileZoom || x >> zoom != 0 || y >> zoom != 0) {
    return NotFound(fmt::format("there is no tile {}/{}/{}: zoom is 0 to {}", zoom, x, y, kMaxTileZoom));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(
      std::string tile, MakeObjectTile(*reader->objects, {.zoom = static_cast<int>(zoom), .x = x, .y = y}, filter));
  return TaggedResponse(call.request, "application/vnd.mapbox-vector-tile", std::move(tile), 0);
}

ApiExpected<HttpResponse> ObjectRoutes::Get(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject object, FindObject(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  TriageStore& store = *reader->objects;
  const std::int64_t id = object.object.id;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SightingRecord> best, store.BestSighting(id));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<ObjectSortKey> key, store.FindKey(id, {}));
  Json json = ObjectToJson(object, *lists);
  json["best"] = best ? SightingToJson(*best) : Json();
  json["evidence"] = ObjectEvidenceToJson(object.object.evidence_json);
  VICTORIOUS_ASSIGN_OR_RETURN(json["key"], KeyOf(object, *lists, *reader));
  json["rank"] = nullptr;
  if (key) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t better, store.CountBefore({}, {}, *key));
    json["rank"] = better + 1;
  }
  return JsonResponse(json);
}

ApiExpected<HttpResponse> ObjectRoutes::Sightings(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject object, FindObject(index_, call.parameters[0]));
  return SightingsResponse(index_, {.object = object.object.id}, call.query);
}

ApiExpected<HttpResponse> ObjectRoutes::Thumbnail(const ApiCall& call) {
  constexpr std::int64_t kDefaultWidth = 240;
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject found, FindObject(index_, call.parameters[0]));
  const std::int64_t object = found.object.id;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto width, call.query.Integer("width", 32, 640));
  // Part of the key of the browser's cache: the best sighting changes with the moments of the object.
  [[maybe_unused]] const auto version = call.query.Text("v");
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  std::optional<SightingRecord> best;
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
    VICTORIOUS_ASSIGN_OR_RETURN(best, reader->objects->BestSighting(object));
  }
  const VideoRecord* video = best ? lists->Video(best->video) : nullptr;
  if (video == nullptr) return NotFound(fmt::format("object {} has no sighting", object));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto bytes,
      videos_.Crop(*video, best->time_s, best->box, static_cast<int>(width.value_or(kDefaultWidth)), call.cancel));
  return TaggedResponse(call.request, "image/jpeg", *bytes, 60);
}

ApiExpected<HttpResponse> ObjectRoutes::Decisions(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject found, FindObject(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Review> decisions, reader->sightings->Decisions(found.object.id));
  return JsonResponse({{"object_id", found.object.id}, {"decisions", DecisionsToJson(decisions)}});
}

ApiExpected<HttpResponse> ObjectRoutes::PutReview(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject found, FindObject(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(ReviewChange review, ParseReview(call.request.body));
  // With accounts, nobody decides in the name of another.
  if (!call.caller.is_open) review.reviewer = call.caller.name();
  VICTORIOUS_RETURN_IF_ERROR(index_.ChangeReview(found.object.id, review));
  // What it makes of the team's review, and of those of others.
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject reviewed, FindObject(index_, call.parameters[0]));
  return JsonResponse({{"object_id", reviewed.object.id},
                       {"review", ReviewToJson(reviewed.review)},
                       {"decisions", DecisionsToJson(reviewed.decisions)},
                       {"is_disputed", reviewed.is_disputed}});
}

ApiExpected<HttpResponse> ObjectRoutes::Regroup(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(RegroupRequest wanted, ParseRegroupRequest(call.request.body));
  wanted.groups.author = call.caller.name();
  const RequestSlot slot(regroupings_);
  if (!slot.is_taken()) {
    return std::unexpected(ApiError(
        Error{ErrorCode::kUnavailable, "objects are being joined or split for another: ask again in some seconds"}));
  }
  if (wanted.undo) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> objects,
                                index_.UndoRegroup(*wanted.undo, std::move(wanted.groups), call.cancel));
    return JsonResponse({{"object_ids", objects}, {"correction", nullptr}});
  }
  auto regrouped = index_.Regroup(std::move(wanted.groups), call.cancel);
  if (!regrouped) {
    const bool is_of_groups = regrouped.error().code == ErrorCode::kInvalidArgument;
    return std::unexpected(ApiError(std::move(regrouped.error()), is_of_groups ? "groups" : ""));
  }
  return JsonResponse({{"object_ids", regrouped->objects}, {"correction", regrouped->correction}});
}

}  // namespace victorious
