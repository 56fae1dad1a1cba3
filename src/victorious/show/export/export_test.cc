#include "victorious/show/export/export.h"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/export_gpkg.h"

namespace victorious {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Two videos; "box" has sightings in frames 37 and 38 of the first, "shed" in frame 0 of the second.
class ExportTest : public ::testing::Test {
 protected:
  void SetUp() override {
    store_ = *OpenSqliteStore(folder_ / "index.db", StoreMode::kCreate);
    const auto a = *store_->PutVideo({.content_id = "1", .name = "flight/a.mp4", .width = 640, .height = 480});
    const auto b = *store_->PutVideo({.content_id = "2", .name = "b.mp4", .width = 320, .height = 240});
    const auto box = *store_->PutModel({.name = "box", .content_id = "1", .kind = ModelKind::kPhotos});
    const auto shed = *store_->PutModel({.name = "shed", .content_id = "2", .kind = ModelKind::kPhotos});
    IndexBatch batch;
    batch.tracklets.push_back({std::nullopt,
                               {.video = a.id,
                                .model = box.id,
                                .score = 0.912349,
                                .frames = 2,
                                .first_time_s = 37 / 25.0,
                                .last_time_s = 38 / 25.0}});
    batch.tracklets.push_back({std::nullopt, {.video = b.id, .model = shed.id, .score = 0.97, .frames = 1}});
    for (const std::int64_t frame : {37, 38}) {
      batch.sightings.push_back({0,
                                 {.frame = frame,
                                  .time_s = static_cast<double>(frame) / 25.0,
                                  .box = {0, 10.126, 100, 50},
                                  .outline = {{-20, 10.126}, {100, 10.126}, {100, 60.126}, {-20, 60.126}},
                                  .score = 0.9,
                                  .matches = 14,
                                  .view_index = 2,
                                  .in_plane_rad = RadiansFromDegrees(12)}});
    }
    batch.sightings.push_back({1,
                               {.frame = 0,
                                .box = {1, 2, 3, 4},
                                .score = 0.97,
                                .source = SightingSource::kTracked,
                                .view = ViewDirection{RadiansFromDegrees(150), RadiansFromDegrees(60)},
                                .sigma_view_rad = RadiansFromDegrees(2.5),
                                .distance_m = 123.4567,
                                .sigma_distance_m = 2}});
    ASSERT_TRUE(store_->Commit(batch));
  }

  std::string Text(std::string_view format, const SightingFilter& filter = {}) {
    std::ostringstream out;
    const Status status = Export(*store_, **FindExportFormat(format), filter, out);
    EXPECT_TRUE(status) << status.error().message;
    return out.str();
  }

  std::vector<std::string> Lines(std::string_view format, const SightingFilter& filter = {}) {
    std::istringstream text(Text(format, filter));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }

  testing::ScratchFolder folder_;
  std::unique_ptr<IndexStore> store_;
};

TEST_F(ExportTest, ObjectsHaveTheDocumentedLines) {
  EXPECT_THAT(
      Lines("objects"),
      ElementsAre(
          R"({"object_id":2,"model":"shed","category":null,"rank":1,"score":0.97,"videos":["b.mp4"],"frames":1,)"
          R"("first_time_s":0.0,"last_time_s":0.0,"place_time_s":null,"latitude_deg":null,"longitude_deg":null,)"
          R"("altitude_m":null,"covariance_enu_m2":null,"ce90_m":null,"le90_m":null,"heading_deg":null,)"
          R"("speed_m_s":null,"sigma_speed_m_s":null,"course_deg":null,"sigma_course_deg":null,)"
          R"("moments":[{"video":"b.mp4","first_time_s":0.0,"last_time_s":0.0,"first_utc":null,"last_utc":null,)"
          R"("frames":1}],"against":[],"evidence":null})",
          R"({"object_id":1,"model":"box","category":null,"rank":2,"score":0.9123,"videos":["flight/a.mp4"],)"
          R"("frames":2,"first_time_s":1.48,"last_time_s":1.52,"place_time_s":null,"latitude_deg":null,)"
          R"("longitude_deg":null,"altitude_m":null,"covariance_enu_m2":null,"ce90_m":null,"le90_m":null,)"
          R"("heading_deg":null,"speed_m_s":null,"sigma_speed_m_s":null,"course_deg":null,)"
          R"("sigma_course_deg":null,"moments":[{"video":"flight/a.mp4","first_time_s":1.48,"last_time_s":1.52,)"
          R"("first_utc":null,"last_utc":null,"frames":2}],"against":[],"evidence":null})"));
}

TEST_F(ExportTest, RanksCountTheListedObjects) {
  const auto lines = Lines("objects", {.model_name = "box"});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(json::parse(lines[0])["rank"], 1);
  EXPECT_EQ(json::parse(lines[0])["object_id"], 1);
}

TEST_F(ExportTest, SightingsHaveTheDocumentedLines) {
  const auto lines = Lines("sightings");
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], R"({"object_id":1,"model":"box","category":null,"video":"flight/a.mp4","frame":37,"time_s":1.48,)"
                      R"("box":[0.0,10.13,100.0,50.0],"score":0.9,"source":"recognised","matches":14,)"
                      R"("view":{"azimuth_deg":null,"off_nadir_deg":null,"in_plane_deg":12.0},"sigma_view_deg":null,)"
                      R"("distance_m":null,"sigma_distance_m":null,"view_index":2,)"
                      R"("outline":[[-20.0,10.13],[100.0,10.13],[100.0,60.13],[-20.0,60.13]]})");
  const json tracked = json::parse(lines[2]);
  EXPECT_EQ(tracked["source"], "tracked");
  EXPECT_EQ(tracked["view"], json::parse(R"({"azimuth_deg":150.0,"off_nadir_deg":60.0,"in_plane_deg":0.0})"));
  EXPECT_EQ(tracked["sigma_view_deg"], 2.5);
  EXPECT_EQ(tracked["distance_m"], 123.457);
  EXPECT_EQ(tracked["sigma_distance_m"], 2.0);
  EXPECT_EQ(tracked["outline"], json::array());
}

TEST_F(ExportTest, FiltersApplyToEveryFormat) {
  EXPECT_EQ(Lines("sightings", {.video_name = "a.mp4", .from_s = 1.5}).size(), 1u);
  EXPECT_EQ(Lines("objects", {.video_name = "a.mp4"}).size(), 1u);
  EXPECT_EQ(Lines("mot", {.video_name = "a.mp4", .to_s = 1.5}).size(), 1u);
  EXPECT_EQ(json::parse(Text("coco", {.model_name = "shed"}))["annotations"].size(), 1u);
}

TEST_F(ExportTest, MotIsOneBasedForOneVideo) {
  EXPECT_THAT(Lines("mot", {.video_name = "a.mp4"}), ElementsAre("38,1,0.00,10.13,100.00,50.00,0.9000,-1,-1,-1",
                                                                 "39,1,0.00,10.13,100.00,50.00,0.9000,-1,-1,-1"));
  std::ostringstream out;
  const Status status = Export(*store_, **FindExportFormat("mot"), {}, out);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.error().message, HasSubstr("--video"));
  EXPECT_TRUE(out.str().empty());
}

TEST_F(ExportTest, CocoReferencesImagesAndCategories) {
  const json coco = json::parse(Text("coco"));
  ASSERT_EQ(coco["images"].size(), 3u);
  EXPECT_EQ(coco["images"][0], json::parse(R"({"id":1,"file_name":"flight/a.mp4/000037.png","width":640,"height":480,
                                               "video":"flight/a.mp4","frame":37,"time_s":1.48,
                                               "video_id":1,"frame_index":37,"timestamp":1.48})"));
  ASSERT_EQ(coco["categories"].size(), 2u);
  EXPECT_EQ(coco["categories"][0], json::parse(R"({"id":1,"name":"box","supercategory":""})"));
  ASSERT_FALSE(coco["videos"].empty());
  EXPECT_EQ(coco["videos"][0]["name"], "flight/a.mp4");
  EXPECT_TRUE(coco["videos"][0].contains("annotation_fps"));
  ASSERT_FALSE(coco["tracks"].empty());
  EXPECT_EQ(coco["tracks"][0]["name"], "box 1");
  EXPECT_TRUE(coco["info"].is_object() && coco["licenses"].is_array()) << "COCO's own keys";
  ASSERT_EQ(coco["annotations"].size(), 3u);
  const json& first = coco["annotations"][0];
  EXPECT_EQ(first["image_id"], 1);
  EXPECT_EQ(first["category_id"], 1);
  EXPECT_EQ(first["bbox"], json::parse("[0.0,10.13,100.0,50.0]"));
  EXPECT_EQ(first["area"], 5000.0) << "of the outline inside the image";
  EXPECT_EQ(first["segmentation"].size(), 1u);
  EXPECT_EQ(first["iscrowd"], 0);
  EXPECT_EQ(first["score"], 0.9);
  EXPECT_EQ(first["track_id"], 1);
  const json& bare = coco["annotations"][2];
  EXPECT_EQ(bare["area"], 12.0) << "of the box, where there is no outline";
  EXPECT_EQ(bare["segmentation"], json::array());
  EXPECT_EQ(bare["image_id"], 3);
}

TEST_F(ExportTest, ErrorsForUnknownNamesListTheKnown) {
  std::ostringstream out;
  const Status video = Export(*store_, **FindExportFormat("objects"), {.video_name = "c.mp4"}, out);
  ASSERT_FALSE(video);
  EXPECT_EQ(video.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(video.error().message, HasSubstr("b.mp4, flight/a.mp4"));
  const Status model = Export(*store_, **FindExportFormat("coco"), {.model_name = "tank"}, out);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(model.error().message, HasSubstr("box, shed"));
  EXPECT_TRUE(out.str().empty());
}

TEST_F(ExportTest, FailedOutputStreamIsAnError) {
  std::ostringstream out;
  out.setstate(std::ios::badbit);
  for (const auto format : {"objects", "sightings", "coco"}) {
    EXPECT_FALSE(Export(*store_, **FindExportFormat(format), {}, out));
  }
}

TEST_F(ExportTest, EmptyIndexGivesEmptyFiles) {
  store_ = *OpenSqliteStore(folder_ / "empty.db", StoreMode::kCreate);
  EXPECT_EQ(Text("objects"), "");
  EXPECT_EQ(Text("sightings"), "");
  EXPECT_EQ(Text("mot"), "");
  json coco = json::parse(Text("coco"));
  coco.erase("info");
  EXPECT_EQ(coco,
            json::parse(R"({"licenses":[],"images":[],"annotations":[],"categories":[],"videos":[],"tracks":[]})"));
}

TEST_F(ExportTest, EllipseIsSplitAtTheAntimeridian) {
  ObjectRecord object = store_->Objects({}).value().front();
  object.place.emplace();
  object.place->point = {RadiansFromDegrees(-17), RadiansFromDegrees(179.99999), 5};
  object.place->covariance_enu_m2 = 9 * Eigen::Matrix3d::Identity();
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  const json feature = json::parse(Text("geojson")).at("features").at(0);
  const json& ellipse = feature.at("geometry").at("geometries").at(1);
  EXPECT_EQ(ellipse.at("type"), "MultiPolygon");
  ASSERT_EQ(ellipse.at("coordinates").size(), 2U);
  for (const json& polygon : ellipse.at("coordinates")) {
    const json& ring = polygon.at(0);
    EXPECT_EQ(ring.front(), ring.back());
    for (const json& corner : ring) {
      const double longitude_deg = corner.at(0);
      EXPECT_GT(longitude_deg * ring.at(0).at(0).get<double>(), 0) << "one side of it";
      EXPECT_GT(std::abs(longitude_deg), 179.999);
      EXPECT_LE(std::abs(longitude_deg), 180);
    }
  }
}

TEST_F(ExportTest, TimesBelongToAVideo) {
  const std::int64_t model = store_->Objects({.model_name = "box"}).value().front().model;
  constexpr std::int64_t kStart_us = 1'700'000'000'000'000;
  const VideoRecord with_utc =
      store_->PutVideo({.content_id = "utc", .name = "utc.mp4", .width = 640, .height = 480, .start_utc_us = kStart_us})
          .value();
  IndexBatch batch;
  batch.tracklets.push_back(
      {std::nullopt,
       {.video = with_utc.id, .model = model, .score = 0.5, .frames = 3, .first_time_s = 4, .last_time_s = 5.1}});
  ASSERT_TRUE(store_->Commit(batch));
  ObjectRecord object = store_->Objects({.model_name = "box"}).value().front();
  object.tracklets = {1, 3};
  object.place.emplace();
  object.place->point = {RadiansFromDegrees(52.5), RadiansFromDegrees(13.25), 81.5};
  object.place->covariance_enu_m2 = 9 * Eigen::Matrix3d::Identity();
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  const json joined = json::parse(Lines("objects", {.model_name = "box"}).front());
  ASSERT_EQ(joined["moments"].size(), 2U);
  EXPECT_EQ(joined["moments"][0]["first_time_s"], 1.48);
  EXPECT_EQ(joined["moments"][0]["first_utc"], nullptr);
  EXPECT_EQ(joined["moments"][1]["video"], "utc.mp4");
  EXPECT_EQ(joined["moments"][1]["last_time_s"], 5.1);
  EXPECT_EQ(joined["moments"][1]["first_utc"], "2023-11-14T22:13:24.000Z");
  const json map = json::parse(Text("geojson"));
  EXPECT_EQ(map["features"][0]["properties"]["moments"], joined["moments"]);
  EXPECT_THAT(Text("kml"), Not(HasSubstr("TimeSpan"))) << "the UTC of one of the two is not known";

  std::vector<ObjectRecord> apart = {object, object};
  apart[0].tracklets = {1};
  apart[1].id = 3;
  apart[1].tracklets = {3};
  ASSERT_TRUE(store_->PutObjects(apart));
  EXPECT_THAT(Text("kml"),
              HasSubstr("<TimeSpan><begin>2023-11-14T22:13:24.000Z</begin><end>2023-11-14T22:13:25.100Z</end>"));
  const json czml = json::parse(Text("czml"));
  const auto packet = std::ranges::find_if(
      czml, [](const json& one) { return one.contains("position") && one.contains("availability"); });
  ASSERT_NE(packet, czml.end());
  EXPECT_EQ((*packet)["availability"], "2023-11-14T22:13:24.000Z/2023-11-14T22:13:25.100Z");
  for (const json& value : (*packet)["properties"]) EXPECT_TRUE(value.is_primitive() && !value.is_null()) << value;
  const std::string id = (*packet)["id"];
  const auto ellipse = std::ranges::find(czml, json(id + "-ellipse-0"), [](const json& one) { return one.at("id"); });
  ASSERT_NE(ellipse, czml.end());
  EXPECT_EQ((*ellipse)["availability"], (*packet)["availability"]);
  EXPECT_EQ((*ellipse)["parent"], id);
}

// Reads the KML back by GDAL.
TEST_F(ExportTest, KmlHasNamesPointsAndEllipses) {
  ObjectRecord object = store_->Objects({.model_name = "box"}).value().front();
  object.place.emplace();
  object.place->point = {RadiansFromDegrees(52.5), RadiansFromDegrees(13.25), 81.5};
  object.place->covariance_enu_m2 = 9 * Eigen::Matrix3d::Identity();
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  const std::filesystem::path path = folder_ / "objects.kml";
  ASSERT_TRUE(WriteFileAtomically(path, Text("kml")));

  GDALAllRegister();
  const std::unique_ptr<GDALDataset> file(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(file);
  ASSERT_EQ(file->GetLayerCount(), 1);
  OGRLayer* objects = file->GetLayer(0);
  ASSERT_EQ(objects->GetFeatureCount(), 1) << "objects without a place are left out";
  const std::unique_ptr<OGRFeature> placemark(objects->GetNextFeature());
  EXPECT_THAT(placemark->GetFieldAsString("Name"), HasSubstr("box"));
  const OGRGeometryCollection* geometries = placemark->GetGeometryRef()->toGeometryCollection();
  ASSERT_EQ(geometries->getNumGeometries(), 2);
  const OGRPoint* point = geometries->getGeometryRef(0)->toPoint();
  EXPECT_NEAR(point->getX(), 13.25, 1e-9) << "longitude first";
  EXPECT_NEAR(point->getY(), 52.5, 1e-9);
  const OGRPolygon* ellipse = geometries->getGeometryRef(1)->toPolygon();
  EXPECT_TRUE(ellipse->getExteriorRing()->get_IsClosed());
  EXPECT_TRUE(OGRPoint(point->getX(), point->getY()).Within(ellipse));
}

// Reads the GeoPackage back by GDAL.
TEST_F(ExportTest, GeoPackageHasPointsEllipsesAndObjectKeys) {
  ObjectRecord object = store_->Objects({.model_name = "box"}).value().front();
  object.place.emplace();
  object.place->point = {RadiansFromDegrees(52.5), RadiansFromDegrees(13.25), 81.5};
  object.place->covariance_enu_m2 = 9 * Eigen::Matrix3d::Identity();
  object.place->ce90_m = 6.4;
  object.rejected = "7 times too large";
  object.against = {"size 600 % off"};
  object.evidence_json = R"({"strength":1.5})";
  ASSERT_TRUE(store_->PutObjects(std::span(&object, 1)));
  const SightingFilter filter{.include_rejected = true};
  const std::string bytes = Text("gpkg", filter);
  EXPECT_EQ(Text("gpkg", filter), bytes) << "the same content, the same bytes";
  const std::filesystem::path path = folder_ / "objects.gpkg";
  ASSERT_TRUE(WriteFileAtomically(path, bytes));

  const std::unique_ptr<GDALDataset> file(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  ASSERT_TRUE(file);
  OGRLayer* objects = file->GetLayerByName("objects");
  OGRLayer* ellipses = file->GetLayerByName("ellipses");
  ASSERT_TRUE(objects != nullptr && ellipses != nullptr);
  ASSERT_EQ(objects->GetFeatureCount(), 1) << "objects without a place are left out";
  const std::unique_ptr<OGRFeature> row(objects->GetNextFeature());
  const OGRPoint* point = row->GetGeometryRef()->toPoint();
  EXPECT_NEAR(point->getX(), 13.25, 1e-12) << "longitude first";
  EXPECT_NEAR(point->getY(), 52.5, 1e-12);
  EXPECT_EQ(point->getZ(), 81.5);
  EXPECT_EQ(row->GetFID(), object.id);
  EXPECT_STREQ(objects->GetFIDColumn(), "object_id");
  const json line = json::parse(Lines("objects", filter).back());
  for (const auto& [key, value] : line.items()) {
    if (key == "object_id") continue;
    const int field = row->GetFieldIndex(key.c_str());
    ASSERT_GE(field, 0) << key << " is no column";
    EXPECT_EQ(row->IsFieldNull(field), value.is_null()) << key;
    if (value.is_string()) {
      EXPECT_EQ(row->GetFieldAsString(field), value.get<std::string>()) << key;
    }
    if (value.is_number()) {
      EXPECT_EQ(row->GetFieldAsDouble(field), value.get<double>()) << key;
    }
    if (value.is_array()) {
      EXPECT_EQ(json::parse(row->GetFieldAsString(field)), value) << key;
    }
  }
  const std::unique_ptr<OGRFeature> around(ellipses->GetNextFeature());
  OGREnvelope box;
  around->GetGeometryRef()->getEnvelope(&box);
  EXPECT_TRUE(box.MinX < 13.25 && 13.25 < box.MaxX && box.MinY < 52.5 && 52.5 < box.MaxY);
  const double height_m = (box.MaxY - box.MinY) * 111'250;  // of a degree of latitude, at 52.5 degrees
  EXPECT_NEAR(height_m, 2 * 3 * 2.146, 0.02);
}

TEST_F(ExportTest, GeoPackageHasWhatPersonsDecided) {
  const auto open = [](const std::filesystem::path& path) {
    return std::unique_ptr<GDALDataset>(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  };
  const std::filesystem::path empty = folder_ / "empty.gpkg";
  ASSERT_TRUE((*MakeGeoPackageFile(empty))->Finish());
  const auto none = open(empty);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->GetLayerByName("objects")->GetFeatureCount(), 0);
  for (const char* column : {"verdict", "reviewer", "note", "is_disputed", "decisions", "model"}) {
    EXPECT_GE(none->GetLayerByName("objects")->GetLayerDefn()->GetFieldIndex(column), 0) << column;
  }

  const std::filesystem::path path = folder_ / "decided.gpkg";
  const auto file = MakeGeoPackageFile(path);
  ASSERT_TRUE(file);
  ListedObject listed{.object = {.id = 7, .score = 0.5}, .rank = 3, .model = "jeep"};
  const Review review{.verdict = Verdict::kRejected, .note = "nothing there", .reviewer = "bob"};
  const std::vector<Review> decisions = {
      review, {.note = "who knows", .reviewer = "cid"}, {.verdict = Verdict::kAccepted}};
  const DecidedObject decided{.review = review, .decisions = decisions, .is_disputed = true};
  ASSERT_TRUE((*file)->Add(listed, decided)) << "an object without a place is left out";
  listed.object.id = 8;
  listed.object.place = Geolocation{.point = {0.9, 0.2, 40}};
  listed.object.place->covariance_enu_m2.setIdentity();
  ASSERT_TRUE((*file)->Add(listed, decided));
  ASSERT_TRUE((*file)->Finish());
  const auto written = open(path);
  ASSERT_TRUE(written);
  OGRLayer* objects = written->GetLayerByName("objects");
  ASSERT_EQ(objects->GetFeatureCount(), 1);
  const std::unique_ptr<OGRFeature> row(objects->GetNextFeature());
  EXPECT_EQ(row->GetFID(), 8);
  const auto text = [&](const char* column) { return std::string(row->GetFieldAsString(row->GetFieldIndex(column))); };
  EXPECT_EQ(text("verdict"), "rejected");
  EXPECT_EQ(text("reviewer"), "bob");
  EXPECT_EQ(text("note"), "nothing there");
  EXPECT_EQ(text("is_disputed"), "1");
  EXPECT_EQ(text("decisions"), "rejected by bob; accepted");
  EXPECT_EQ(text("rank"), "3");
}

TEST(ExportFormatTest, EachIsFoundByItsName) {
  for (const ExportFormat* format : ExportFormats()) {
    EXPECT_EQ(*FindExportFormat(format->name), format);
    EXPECT_FALSE(format->is_file("my notes")) << format->name;
  }
  const auto unknown = FindExportFormat("excel");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(unknown.error().message, HasSubstr("objects, sightings, mot, coco, cvat, vtt, vmti"));
}

}  // namespace
}  // namespace victorious
