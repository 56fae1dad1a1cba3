#include "victorious/apps/serve/api.h"

#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/data.h"
#include "testing/vector_tile_reader.h"
#include "testing/video_tools.h"
#include "victorious/apps/serve/api_json.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/place/associate/object_score.h"

namespace victorious {
namespace {

using nlohmann::json;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kPort = 8080;
constexpr int kFrames = 30;

// An index of one video whose frames show their numbers, with three objects: scores 0.9, 0.8, 0.7; the first has a
// place.
class ApiTest : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::WriteTestVideo(
        folder_ / "flight.mp4",
        {.size = {320, 240}, .time_base_hz = 10, .pts = testing::SteadyTimes(kFrames, 1), .max_b_frames = 2});
    const auto store = OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    const VideoRecord video = *(*store)->PutVideo(
        {.content_id = "c1", .name = (folder_ / "flight.mp4").string(), .width = 320, .height = 240});
    ASSERT_TRUE((*store)->SetVideoLength(video.id, kFrames, 0.1 * (kFrames - 1)));
    const ModelRecord model = *(*store)->PutModel({.name = "jeep", .content_id = "m1", .kind = ModelKind::kCad});
    for (int i = 0; i < 3; ++i) {
      IndexBatch batch;
      const double score = 0.9 - 0.1 * i;
      batch.tracklets.push_back({std::nullopt,
                                 {.video = video.id,
                                  .model = model.id,
                                  .score = score,
                                  .frames = 5,
                                  .first_time_s = 1.0 * i,
                                  .last_time_s = 1.0 * i + 0.4}});
      for (int frame = 10 * i; frame < 10 * i + 5; ++frame) {
        batch.sightings.push_back({0,
                                   {.frame = frame,
                                    .time_s = 0.1 * frame,
                                    .box = {40, 30, 100, 60},
                                    .score = score,
                                    .matches = frame == 10 * i + 3 ? 20 : 10}});
      }
      const auto ids = (*store)->Commit(batch);
      ASSERT_TRUE(ids) << ids.error().message;
      ids_.push_back(ids->front());
    }
    Geolocation place{.point = {RadiansFromDegrees(52), RadiansFromDegrees(13), 40}, .time_s = 0.4};
    place.covariance_enu_m2 = Eigen::Vector3d(1, 4, 1).asDiagonal();
    place.ce90_m = 3;
    const std::vector<ObjectRecord> located = {
        {.id = ids_[0], .model = model.id, .tracklets = {ids_[0]}, .place = place}};
    ASSERT_TRUE((*store)->PutObjects(located));
    Open();
  }

  auto TryToOpen(std::optional<std::string> telemetry) {
    return Api::Open({.index = folder_ / "index.db", .models = {}, .telemetry = std::move(telemetry), .web = {}},
                     cancel_);
  }

  void Open(std::optional<std::string> telemetry = {}) {
    auto api = TryToOpen(std::move(telemetry));
    ASSERT_TRUE(api) << api.error().message;
    api_ = *std::move(api);
  }

  HttpResponse Send(HttpRequest request) {
    if (request.host.empty()) request.host = "127.0.0.1:8080";
    return api_->Handle(request, kPort);
  }

  json Get(const std::string& target, int status = 200) {
    const HttpResponse response = Send({.target = target});
    EXPECT_EQ(response.status, status) << target << response.body;
    return json::parse(response.body, nullptr, false);
  }

  HttpResponse Review(std::int64_t object, const std::string& body) {
    return Send({.method = HttpMethod::kPut,
                 .target = "/api/v1/objects/" + std::to_string(object) + "/review",
                 .content_type = "application/json",
                 .body = body});
  }

  std::vector<std::int64_t> Listed(const std::string& query) {
    std::vector<std::int64_t> ids;
    const json answer = Get("/api/v1/objects?" + query);
    for (const json& one : answer["objects"]) ids.push_back(one["id"]);
    return ids;
  }

  testing::ScratchFolder folder_;
  CancelToken cancel_;
  std::vector<std::int64_t> ids_;
  std::unique_ptr<Api> api_;
};

// What was decided suggests a threshold; in force, it leaves out what nobody has decided.
TEST_F(ApiTest, ThresholdsAreLearntAndAppliedOnRequest) {
  const auto put = [&](const std::string& model, const std::string& body) {
    return Send({.method = HttpMethod::kPut,
                 .target = "/api/v1/models/" + model + "/threshold",
                 .content_type = "application/json",
                 .body = body});
  };
  EXPECT_THAT(Get("/api/v1/thresholds")["models"], SizeIs(0));
  ASSERT_EQ(Review(ids_[0], R"({"verdict": "accepted"})").status, 200);
  const json decided = Get("/api/v1/thresholds");
  ASSERT_THAT(decided["models"], SizeIs(1));
  EXPECT_EQ(decided["models"][0]["model"], "jeep");
  EXPECT_EQ(decided["models"][0]["accepted"], 1);
  EXPECT_TRUE(decided["models"][0]["learnt"].is_null()) << "one decision teaches nothing";
  const std::string model = std::to_string(decided["models"][0]["model_id"].get<int>());

  const HttpResponse answer = put(model, R"({"min_score": 0.75, "reviewer": "ann"})");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const json in_force = json::parse(answer.body)["models"][0]["in_force"];
  EXPECT_EQ(in_force["min_score"], 0.75);
  EXPECT_EQ(in_force["set_by"], "ann");
  EXPECT_EQ(in_force["undecided_below"], 1);
  EXPECT_THAT(Listed(""), SizeIs(3));
  EXPECT_THAT(Listed("thresholds=ignored"), SizeIs(3));
  EXPECT_THAT(Listed("thresholds=applied"), ElementsAre(ids_[0], ids_[1]));
  EXPECT_EQ(Get("/api/v1/objects/counts?thresholds=applied")["objects"], 2);
  EXPECT_EQ(Get("/api/v1/objects?thresholds=yes", 400)["field"], "thresholds");
  ASSERT_EQ(put(model, R"({"min_score": 0.99})").status, 200);
  EXPECT_THAT(Listed("thresholds=applied"), ElementsAre(ids_[0])) << "what was decided stays";
  ASSERT_EQ(put(model, R"({"min_score": null})").status, 200);
  EXPECT_THAT(Listed("thresholds=applied"), SizeIs(3));

  // What another process decides shows soon.
  const auto other = *OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
  ASSERT_TRUE(other->PutReview(ids_[2], {.verdict = Verdict::kRejected, .updated_utc_us = 9, .reviewer = "bob"}));
  while (Get("/api/v1/thresholds")["models"][0]["rejected"] == 0) std::this_thread::yield();
  // Those who ask at once get the same answer.
  std::vector<std::string> answers(8);
  std::vector<std::thread> threads;
  for (std::string& one : answers) {
    threads.emplace_back([&] { one = Send({.target = "/api/v1/thresholds"}).body; });
  }
  for (std::thread& one : threads) one.join();
  EXPECT_THAT(answers, Each(answers.front()));

  for (const char* body : {"", "{}", "[]", R"({"min_score": 1.5})", R"({"min_score": "x"})",
                           R"({"min_score": 0, "a": 1})", R"({"min_score": 0, "reviewer": 3})"}) {
    EXPECT_EQ(put(model, body).status, 400) << body;
  }
  EXPECT_EQ(put("987654", R"({"min_score": 0.5})").status, 404);
}

TEST_F(ApiTest, ListsObjectsByRankAndFilters) {
  EXPECT_THAT(Listed(""), ElementsAre(ids_[0], ids_[1], ids_[2]));
  EXPECT_THAT(Listed("min_score=0.75"), ElementsAre(ids_[0], ids_[1]));
  EXPECT_THAT(Listed("from=1.2&to=1.9"), ElementsAre(ids_[1]));
  EXPECT_THAT(Listed("near=52,13,50"), ElementsAre(ids_[0]));
  EXPECT_THAT(Listed("near=53,13,50"), SizeIs(0));
  EXPECT_THAT(Listed("model=tank"), SizeIs(0));
  EXPECT_THAT(Listed("video=99"), SizeIs(0));
  EXPECT_EQ(Get("/api/v1/objects?model=jeep&limt=3", 400)["field"], "limt");
  EXPECT_EQ(Get("/api/v1/objects?limit=0", 400)["field"], "limit");
  EXPECT_EQ(Get("/api/v1/objects?cursor=x", 400)["field"], "cursor");
}

TEST_F(ApiTest, CursorWalksTheListOnce) {
  std::vector<std::int64_t> seen;
  std::string query = "limit=2";
  for (int page = 0; page < 5; ++page) {
    const json answer = Get("/api/v1/objects?" + query);
    for (const json& one : answer["objects"]) seen.push_back(one["id"]);
    if (answer["next_cursor"].is_null()) break;
    query = "limit=2&cursor=" + answer["next_cursor"].get<std::string>();
  }
  EXPECT_THAT(seen, ElementsAre(ids_[0], ids_[1], ids_[2]));
}

TEST_F(ApiTest, ListIsReadFromAnyPlace) {
  const std::string second = std::to_string(ids_[1]);
  EXPECT_THAT(Listed("after=" + second), ElementsAre(ids_[2]));
  EXPECT_THAT(Listed("before=" + second), ElementsAre(ids_[0]));
  EXPECT_THAT(Listed("offset=1&limit=1"), ElementsAre(ids_[1]));
  EXPECT_THAT(Listed("sort=newest"), ElementsAre(ids_[2], ids_[1], ids_[0]));
  EXPECT_THAT(Listed("ids=" + second + ",987654," + std::to_string(ids_[0])), ElementsAre(ids_[0], ids_[1]));
  const json page = Get("/api/v1/objects?limit=2&around=" + std::to_string(ids_[2]));
  EXPECT_EQ(page["offset"], 2);
  EXPECT_EQ(page["total"], 3);
  EXPECT_EQ(page["objects"][0]["id"], ids_[2]);
  EXPECT_TRUE(page["next_cursor"].is_null());
  EXPECT_EQ(Get("/api/v1/objects?offset=2&min_score=0.75")["total"], 2);
  EXPECT_EQ(Get("/api/v1/objects?around=987654", 404)["code"], "not_found");
  EXPECT_EQ(Get("/api/v1/objects?after=1&offset=2", 400)["field"], "cursor");
  EXPECT_EQ(Get("/api/v1/objects?sort=best", 400)["field"], "sort");
  EXPECT_EQ(Get("/api/v1/objects?ids=1,x", 400)["field"], "ids");
}

TEST_F(ApiTest, QueueStaysWhileItIsWorkedOff) {
  const std::string since = std::to_string(Get("/api/v1/project")["now_utc_us"].get<std::int64_t>());
  ASSERT_EQ(Review(ids_[0], R"({"verdict": "accepted"})").status, 200);
  EXPECT_THAT(Listed("sort=queue&since=" + since), ElementsAre(ids_[0], ids_[1], ids_[2]));
  EXPECT_THAT(Listed("sort=queue"), ElementsAre(ids_[1], ids_[2], ids_[0]));
  std::vector<std::int64_t> seen;
  std::string query = "sort=queue&limit=1";
  for (int page = 0; page < 5; ++page) {
    const json answer = Get("/api/v1/objects?" + query);
    for (const json& one : answer["objects"]) seen.push_back(one["id"]);
    if (answer["next_cursor"].is_null()) break;
    query = "sort=queue&limit=1&cursor=" + answer["next_cursor"].get<std::string>();
  }
  EXPECT_THAT(seen, ElementsAre(ids_[1], ids_[2], ids_[0]));
}

TEST_F(ApiTest, CountsFollowFiltersAndReviews) {
  ASSERT_EQ(Review(ids_[2], R"({"verdict": "rejected"})").status, 200);
  const json all = Get("/api/v1/objects/counts");
  EXPECT_EQ(all["objects"], 3);
  EXPECT_EQ(all["rejected"], 1);
  EXPECT_EQ(all["unreviewed"], 2);
  EXPECT_EQ(all["scores"][90], 1);
  EXPECT_EQ(std::tuple(all["scores"][70], all["rejected_scores"][70], all["accepted_scores"][70]), std::tuple(1, 1, 0));
  EXPECT_EQ(Get("/api/v1/objects/counts?min_score=0.75")["objects"], 2);
  EXPECT_EQ(Get("/api/v1/objects/counts?q=jee")["objects"], 3);
  EXPECT_EQ(Get("/api/v1/objects/counts?q=jee+tank")["objects"], 0);
  EXPECT_EQ(Get("/api/v1/objects/counts?limit=3", 400)["field"], "limit");
}

// show/export/ tests the rows; a GeoPackage has texts as they are.
TEST_F(ApiTest, GeoPackageHasWhatWasDecided) {
  ASSERT_EQ(Review(ids_[0], R"({"verdict": "rejected", "note": "nothing there", "reviewer": "ann"})").status, 200);
  std::filesystem::path path;
  {
    const HttpResponse response = Send({.target = "/api/v1/objects/geopackage"});
    ASSERT_EQ(response.status, 200) << response.body;
    EXPECT_EQ(response.content_type, "application/geopackage+sqlite3");
    ASSERT_TRUE(response.file);
    path = response.file->path;
    const std::string bytes = *ReadFile(path);
    EXPECT_EQ(std::ssize(bytes), response.file->length);
    EXPECT_THAT(bytes, HasSubstr("nothing there"));
    EXPECT_THAT(bytes, HasSubstr("rejected by ann"));
    EXPECT_THAT(bytes, HasSubstr("flight.mp4"));
  }
  EXPECT_FALSE(std::filesystem::exists(path.parent_path())) << "it goes once it is sent";
  EXPECT_EQ(Get("/api/v1/objects/geopackage?sort=rank", 400)["field"], "sort");
  const HttpResponse none = Send({.target = "/api/v1/objects/geopackage?review=accepted"});
  ASSERT_TRUE(none.file) << none.body;
  const std::string bytes = *ReadFile(none.file->path);
  for (const char* column : {"verdict", "reviewer", "note", "is_disputed", "decisions"}) {
    EXPECT_THAT(bytes, HasSubstr(column)) << "also if no object matches";
  }
  EXPECT_THAT(bytes, Not(HasSubstr("flight.mp4")));
}

TEST_F(ApiTest, GeoPackageThatNobodyWaitsForIsNotMade) {
  HttpResponse slow = api_->Begin({.target = "/api/v1/objects/geopackage", .host = "127.0.0.1:8080"}, kPort);
  ASSERT_TRUE(slow.slow);
  CancelToken left;
  left.Cancel();
  const HttpResponse response = slow.slow->make(left);
  EXPECT_EQ(response.status, 503);
  EXPECT_FALSE(response.file);
}

TEST_F(ApiTest, TilesHoldThePlaces) {
  const HttpResponse tile = Send({.target = "/api/v1/tiles/0/0/0"});
  EXPECT_EQ(tile.status, 200);
  EXPECT_EQ(tile.content_type, "application/vnd.mapbox-vector-tile");
  const auto layers = testing::ReadTile(tile.body);
  ASSERT_THAT(layers, SizeIs(1));
  EXPECT_EQ(layers[0].features[0].id, static_cast<std::uint64_t>(ids_[0]));
  EXPECT_EQ(Send({.target = "/api/v1/tiles/0/0/0", .if_none_match = tile.headers.front().second}).status, 304);
  EXPECT_EQ(Send({.target = "/api/v1/tiles/1/0/1?v=3"}).body, "");
  for (const char* target : {"1/2/0", "1/0/2", "19/0/0", "0/0/x", "99/0/0"}) {
    EXPECT_EQ(Send({.target = std::string("/api/v1/tiles/") + target}).status, 404) << target;
  }
}

TEST_F(ApiTest, ObjectHasItsPlaceAndBestSighting) {
  const json object = Get("/api/v1/objects/" + std::to_string(ids_[0]));
  EXPECT_NEAR(object["place"]["latitude_deg"].get<double>(), 52, 1e-9);
  EXPECT_NEAR(object["place"]["ellipse"]["semi_major_m"].get<double>(), 4.292, 1e-3);
  EXPECT_EQ(object["best"]["frame"], 3) << "the sighting with most matches";
  EXPECT_TRUE(object.contains("evidence"));
  EXPECT_EQ(object["moments"][0]["frames"], 5);
  EXPECT_EQ(object["rank"], 1);
  EXPECT_EQ(Get("/api/v1/objects/" + std::to_string(ids_[2]))["rank"], 3);
  EXPECT_TRUE(Get("/api/v1/objects/" + std::to_string(ids_[1]))["place"].is_null());
  EXPECT_EQ(Get("/api/v1/objects/99999", 404)["code"], "not_found");
  EXPECT_EQ(Get("/api/v1/objects/none", 404)["code"], "not_found");
}

TEST(ObjectEvidenceJson, IsThatOfTheStoreOrNull) {
  const Json whole = ObjectEvidenceToJson(ToJsonText({.recognitions = 3, .frames = 5}));
  EXPECT_EQ(whole["recognitions"], 3);
  EXPECT_FALSE(whole.contains("strength")) << "the schema has no more than the page shows";
  for (const char* text : {"", "{}", R"({"recognitions":3,"frames":5})", "[1]", "damaged"}) {
    EXPECT_TRUE(ObjectEvidenceToJson(text).is_null()) << text;
  }
}

TEST_F(ApiTest, SightingsAreThoseOfTheTimes) {
  const json all = Get("/api/v1/videos/1/sightings");
  EXPECT_THAT(all["sightings"], SizeIs(15));
  EXPECT_EQ(all["truncated"], false);
  const json some = Get("/api/v1/videos/1/sightings?from=1&to=1.15");
  ASSERT_THAT(some["sightings"], SizeIs(2));
  EXPECT_EQ(some["sightings"][0]["frame"], 10);
  EXPECT_EQ(some["sightings"][0]["object_id"], ids_[1]);
  const json first = Get("/api/v1/videos/1/sightings?limit=4");
  EXPECT_THAT(first["sightings"], SizeIs(4));
  EXPECT_EQ(first["truncated"], true);
  EXPECT_THAT(Get("/api/v1/objects/" + std::to_string(ids_[2]) + "/sightings")["sightings"], SizeIs(5));
}

TEST_F(ApiTest, FramesHaveTheirTimesAndPixels) {
  const json times_s = Get("/api/v1/videos/1/times")["times_s"];
  ASSERT_THAT(times_s, SizeIs(kFrames));
  EXPECT_EQ(times_s[7], 0.7);
  for (const int frame : {0, 7, 12, 29}) {
    const HttpResponse response = Send({.target = "/api/v1/videos/1/frames/" + std::to_string(frame)});
    ASSERT_EQ(response.status, 200) << response.body;
    const auto image = DecodeImage(std::as_bytes(std::span(response.body)), "frame");
    ASSERT_TRUE(image);
    EXPECT_EQ(testing::DecodeImageNumber(image->bgr), frame);
  }
  EXPECT_EQ(Get("/api/v1/videos/1/frames/30", 404)["code"], "not_found");
}

TEST_F(ApiTest, ThumbnailShowsTheBestSighting) {
  const std::string target = "/api/v1/objects/" + std::to_string(ids_[0]) + "/thumbnail?width=160";
  const HttpResponse response = Send({.target = target});
  ASSERT_EQ(response.status, 200) << response.body;
  EXPECT_EQ(response.content_type, "image/jpeg");
  const auto image = DecodeImage(std::as_bytes(std::span(response.body)), "thumbnail");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->bgr.size(), cv::Size(160, 120));
  EXPECT_EQ(Send({.target = target, .if_none_match = response.headers.front().second}).status, 304);
}

TEST_F(ApiTest, ReviewIsKept) {
  const HttpResponse put = Review(ids_[1], R"({"verdict": "accepted", "note": "by the barn", "reviewer": "ann"})");
  ASSERT_EQ(put.status, 200) << put.body;
  EXPECT_EQ(json::parse(put.body)["review"]["verdict"], "accepted");
  EXPECT_EQ(json::parse(put.body)["review"]["reviewer"], "ann");
  EXPECT_THAT(Listed("review=accepted"), ElementsAre(ids_[1]));
  EXPECT_THAT(Listed("review=none"), ElementsAre(ids_[0], ids_[2]));
  EXPECT_EQ(Get("/api/v1/project")["accepted"], 1);
  Open();
  EXPECT_EQ(Get("/api/v1/objects/" + std::to_string(ids_[1]))["review"]["note"], "by the barn");
  EXPECT_EQ(Review(ids_[1], R"({"verdict": null, "note": ""})").status, 200);
  EXPECT_FALSE(Get("/api/v1/objects/" + std::to_string(ids_[1]))["review"].is_null()) << "ann's stays";
  EXPECT_EQ(Review(ids_[1], R"({"verdict": null, "note": "", "reviewer": "ann"})").status, 200);
  EXPECT_TRUE(Get("/api/v1/objects/" + std::to_string(ids_[1]))["review"].is_null());
}

TEST_F(ApiTest, MemberOfAReviewThatIsLeftOutStays) {
  ASSERT_EQ(Review(ids_[0], R"({"verdict": "accepted", "note": "by the barn", "reviewer": "ann"})").status, 200);
  const json rejected = json::parse(Review(ids_[0], R"({"verdict": "rejected", "reviewer": "ann"})").body)["review"];
  EXPECT_EQ(rejected["verdict"], "rejected");
  EXPECT_EQ(rejected["note"], "by the barn");
  const json noted = json::parse(Review(ids_[0], R"({"note": "in the barn", "reviewer": "ann"})").body)["review"];
  EXPECT_EQ(noted["verdict"], "rejected");
  EXPECT_EQ(noted["note"], "in the barn");
  // The note of ann is not that of bob.
  const json other = json::parse(Review(ids_[0], R"({"verdict": "accepted", "reviewer": "bob"})").body)["review"];
  EXPECT_EQ(other["note"], "");
}

TEST_F(ApiTest, DecisionsArePersons) {
  EXPECT_EQ(Review(ids_[0], R"({"verdict": "accepted", "reviewer": "ann"})").status, 200);
  EXPECT_EQ(Review(ids_[1], R"({"verdict": "accepted", "reviewer": "ann"})").status, 200);
  const json put = json::parse(Review(ids_[1], R"({"verdict": "rejected", "note": "no", "reviewer": "bob"})").body);
  EXPECT_EQ(put["review"]["reviewer"], "bob");
  EXPECT_EQ(put["is_disputed"], true);
  EXPECT_EQ(put["decisions"].size(), 2U);
  EXPECT_THAT(Listed("review=own&reviewer=ann"), ElementsAre(ids_[0], ids_[1]));
  EXPECT_THAT(Listed("review=own&reviewer=bob"), ElementsAre(ids_[1]));
  EXPECT_THAT(Listed("review=not_own&reviewer=bob"), ElementsAre(ids_[0], ids_[2]));
  EXPECT_THAT(Listed("review=disputed"), ElementsAre(ids_[1]));
  const json list = Get("/api/v1/objects/" + std::to_string(ids_[1]) + "/decisions");
  EXPECT_EQ(list["object_id"], ids_[1]);
  ASSERT_EQ(list["decisions"].size(), 2U);
  EXPECT_EQ(list["decisions"][0]["note"], "no");
  EXPECT_EQ(list["decisions"][1]["reviewer"], "ann");
}

TEST_F(ApiTest, MalformedReviewsAreRefused) {
  const struct {
    std::string body, field;
  } cases[] = {{"", ""},
               {"[]", ""},
               {R"({"verdict": "maybe"})", "verdict"},
               {R"({"verdict": 3})", "verdict"},
               {R"({"note": 3})", "note"},
               {R"({"note": ")" + std::string(4001, 'x') + R"("})", "note"},
               {R"({"reviewer": ")" + std::string(101, 'x') + R"("})", "reviewer"},
               {R"({"score": 1})", "score"},
               {"{\"note\": \"\xff\"}", ""}};
  for (const auto& one : cases) {
    const HttpResponse response = Review(ids_[0], one.body);
    EXPECT_EQ(response.status, 400) << one.body;
    const json error = json::parse(response.body);
    EXPECT_EQ(error["field"], one.field.empty() ? json() : json(one.field)) << one.body;
    EXPECT_THAT(error["message"].get<std::string>(), ::testing::Not(HasSubstr("\n")));
  }
  EXPECT_EQ(Review(12345, R"({"verdict": null})").status, 404);
  EXPECT_TRUE(Get("/api/v1/objects/" + std::to_string(ids_[0]))["review"].is_null());
}

TEST_F(ApiTest, OtherSitesAreRefused) {
  EXPECT_EQ(Send({.target = "/api/v1/project", .host = "evil.example:8080"}).status, 421);
  EXPECT_EQ(Send({.target = "/", .host = "127.0.0.1:8081"}).status, 421) << "DNS rebinding to another port";
  EXPECT_EQ(Send({.target = "/api/v1/project", .host = "LOCALHOST:8080"}).status, 200);
  EXPECT_EQ(Send({.target = "/api/v1/project", .host = "[::1]:8080"}).status, 200);
  EXPECT_EQ(Send({.target = "/api/v1/project", .origin = "http://evil.example"}).status, 403);
  EXPECT_EQ(Send({.target = "/api/v1/project", .origin = "null"}).status, 403);
  EXPECT_EQ(Send({.target = "/api/v1/project", .origin = "http://127.0.0.1:8080"}).status, 200);
  EXPECT_EQ(Send({.target = "/api/v1/project", .fetch_site = "cross-site"}).status, 403);
  EXPECT_EQ(Send({.target = "/%61pi/v1/project", .fetch_site = "cross-site"}).status, 403) << "the same address";
  EXPECT_EQ(Send({.target = "/", .fetch_site = "cross-site"}).status, 200) << "a link to the page";
  HttpRequest form{.method = HttpMethod::kPut, .target = "/api/v1/objects/1/review", .content_type = "text/plain"};
  EXPECT_EQ(Send(form).status, 415);
}

TEST_F(ApiTest, OtherAddressesAndMethodsAreRefused) {
  for (const char* target : {"/api", "/api/v1", "/api/v2/project", "/api/v1/none", "/api/v1/videos/1/none",
                             "/api/v1/objects/1/none", "/none.js", "/api/v1/videos/9"}) {
    EXPECT_EQ(Send({.target = target}).status, 404) << target;
  }
  EXPECT_EQ(Send({.target = "/api/v1/../v1/project"}).status, 400);
  EXPECT_EQ(Send({.method = HttpMethod::kOther, .target = "/api/v1/project"}).status, 405);
  HttpRequest put{.method = HttpMethod::kPut, .target = "/api/v1/project", .content_type = "application/json"};
  EXPECT_EQ(Send(put).status, 405);
  EXPECT_EQ(Get("/api/v1/project?x=1", 400)["field"], "x");
}

TEST_F(ApiTest, VideoIsSentInParts) {
  const HttpResponse part = Send({.target = "/api/v1/videos/1/file", .range = "bytes=4-7"});
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.content_type, "video/mp4");
  EXPECT_EQ(part.file->length, 4);
  std::filesystem::remove(folder_ / "flight.mp4");
  EXPECT_THAT(Get("/api/v1/videos/1/file", 404)["message"].get<std::string>(), HasSubstr("move it back"));
  EXPECT_THAT(Get("/api/v1/videos/1")["missing"].get<std::string>(), HasSubstr("flight.mp4"));
}

// Whoever writes the index names a file of another folder, of the server itself, or a link.
TEST_F(ApiTest, FilesThatTheIndexNamesAreOnlyVideosOfKnownFolders) {
  const testing::ScratchFolder other;
  const std::string secret = "-----BEGIN PRIVATE KEY-----\n";
  testing::WriteBytes(other / "server.key", secret);
  testing::WriteBytes(folder_ / "own.key", secret);
  testing::WriteBytes(folder_ / "plain.txt", secret);
  std::filesystem::copy(folder_ / "flight.mp4", other / "flight.mp4");
  std::filesystem::create_directories(folder_ / ".hidden");
  std::filesystem::copy(folder_ / "flight.mp4", folder_ / ".hidden/flight.mp4");
  std::filesystem::create_symlink(other / "flight.mp4", folder_ / "link.mp4");
  const auto name_video = [&](const std::filesystem::path& name) {
    const auto store = OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    ASSERT_TRUE((*store)->PutVideo({.content_id = "c1", .name = name, .width = 320, .height = 240}));
    auto api =
        Api::Open({.index = folder_ / "index.db", .models = {}, .web = {}, .secrets = {folder_ / "own.key"}}, cancel_);
    ASSERT_TRUE(api) << api.error().message;
    api_ = *std::move(api);
  };
  const std::string id = std::to_string(ids_[0]);
  for (const auto& name : {other / "server.key", other / "flight.mp4", other / "absent", folder_ / "own.key",
                           folder_ / "index.db", folder_ / ".hidden/flight.mp4", folder_ / "link.mp4"}) {
    name_video(name);
    for (const std::string& route : {std::string("videos/1/file"), std::string("videos/1/times"),
                                     std::string("videos/1/frames/0"), "objects/" + id + "/thumbnail"}) {
      const json refusal = Get("/api/v1/" + route, 403);
      EXPECT_THAT(refusal["message"].get<std::string>(), HasSubstr("--videos")) << name << route;
    }
    EXPECT_THAT(Get("/api/v1/videos/1")["missing"].get<std::string>(), HasSubstr("--videos")) << name;
    EXPECT_TRUE(Get("/api/v1/videos/1/camera")["source"].is_null()) << name;
  }
  name_video(folder_ / "plain.txt");
  EXPECT_THAT(Get("/api/v1/videos/1/file", 415)["message"].get<std::string>(), HasSubstr("neither a video"));
  name_video(folder_ / "flight.mp4");
  EXPECT_EQ(Send({.target = "/api/v1/videos/1/file"}).status, 200);
}

TEST_F(ApiTest, TelemetryThatTheIndexNamesLiesInAKnownFolder) {
  const testing::ScratchFolder other;
  const std::string table =
      "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n0,52,13,140,0,-90,0,60\n";
  testing::WriteBytes(other / "table.csv", table);
  testing::WriteBytes(folder_ / "table.csv", table);
  for (const bool is_known : {false, true}) {
    {
      const auto store = OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
      const std::string given = (is_known ? folder_ : other) / "table.csv";
      ASSERT_TRUE((*store)->PutVideo({.content_id = "c1",
                                      .name = (folder_ / "flight.mp4").string(),
                                      .width = 320,
                                      .height = 240,
                                      .telemetry = given}));
    }
    Open();
    const json camera = Get("/api/v1/videos/1/camera");
    EXPECT_EQ(camera["source"].is_null(), !is_known);
    if (!is_known) {
      EXPECT_THAT(camera["reason"].get<std::string>(), HasSubstr("--videos"));
    }
  }
}

TEST_F(ApiTest, CameraPathComesFromTelemetry) {
  EXPECT_TRUE(Get("/api/v1/videos/1/camera")["source"].is_null());
  EXPECT_THAT(Get("/api/v1/videos/1/camera")["reason"].get<std::string>(), HasSubstr("telemetry"));
  testing::WriteBytes(folder_ / "flight.mp4.telemetry.csv",
                      "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
                      "0,52,13,140,0,-90,0,60\n3,52.001,13,140,0,-90,0,60\n");
  Open();
  const json camera = Get("/api/v1/videos/1/camera");
  EXPECT_EQ(camera["source"], "telemetry");
  ASSERT_THAT(camera["points"], SizeIs(2));
  EXPECT_EQ(camera["ground_m"], 40.0) << "that of the located object";
  EXPECT_THAT(camera["points"][0]["footprint"], SizeIs(4));
}

TEST_F(ApiTest, CoverageNeedsAModelAndAVideo) {
  EXPECT_EQ(Get("/api/v1/models/1/coverage", 400)["field"], "video");
  Get("/api/v1/models/99/coverage?video=1", 404);
  Get("/api/v1/models/1/coverage?video=99", 404);
  EXPECT_THAT(Get("/api/v1/models/1/coverage?video=1", 404)["message"].get<std::string>(), HasSubstr("--models"));
}

// A file that is given belongs to the video that the index had, not to those that are added later.
TEST_F(ApiTest, GivenTelemetryIsThatOfOneVideo) {
  testing::WriteBytes(folder_ / "table.csv",
                      "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg\n"
                      "0,52,13,140,0,-90,0,60\n3,52.001,13,140,0,-90,0,60\n");
  Open((folder_ / "table.csv").string());
  std::filesystem::copy(folder_ / "flight.mp4", folder_ / "second.mp4");
  {
    const auto store = OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    ASSERT_TRUE((*store)->PutVideo(
        {.content_id = "c2", .name = (folder_ / "second.mp4").string(), .width = 320, .height = 240}));
  }
  for (int i = 0; i < 500 && Get("/api/v1/videos")["videos"].size() < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(Get("/api/v1/videos/1/camera")["source"], "telemetry");
  EXPECT_TRUE(Get("/api/v1/videos/2/camera")["source"].is_null());
  const auto again = TryToOpen((folder_ / "table.csv").string());
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("VIDEO.telemetry.csv"));
}

TEST_F(ApiTest, IndexWithoutWritePermissionTakesNoReviews) {
  api_.reset();
  std::filesystem::remove(folder_ / "index.db-wal");
  std::filesystem::permissions(folder_ / "index.db", std::filesystem::perms::owner_read);
  std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  std::error_code error;
  const bool is_root = std::ofstream(folder_ / "probe").good();
  if (!is_root) {
    Open();
    EXPECT_EQ(Get("/api/v1/project")["can_review"], false);
    EXPECT_EQ(Review(ids_[0], R"({"verdict": "accepted"})").status, 403);
  }
  std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all);
  if (is_root) GTEST_SKIP() << "root may write everywhere";
}

TEST(Api, ReportsAnIndexThatIsNotThere) {
  const testing::ScratchFolder folder;
  const CancelToken cancel;
  const auto api = Api::Open({.index = folder / "none.db", .models = {}, .telemetry = {}, .web = {}}, cancel);
  ASSERT_FALSE(api);
  EXPECT_EQ(api.error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.db")) << "no file is made";
}

}  // namespace
}  // namespace victorious
