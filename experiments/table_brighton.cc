// Consistency of geolocation: the same objects in several nadir photos. The places from single photos must agree with
// the joint place within their CE90. There is no surveyed truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/place_experiments.h"
#include "experiments/place_trials.h"
#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/place/geolocate/locate.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// An object, manually marked in one photo.
struct MarkedObject {
  const char* name;
  const char* photo;
  Box box;  // px
};

constexpr std::array kMarkedObjects = {MarkedObject{"picnic table", "DJI_0031.JPG", {1155, 515, 83, 74}},
                                       MarkedObject{"white car", "DJI_0031.JPG", {1277, 402, 141, 66}},
                                       MarkedObject{"silver car", "DJI_0031.JPG", {1201, 295, 130, 89}},
                                       MarkedObject{"red car", "DJI_0034.JPG", {1468, 476, 146, 80}},
                                       MarkedObject{"dark car", "DJI_0034.JPG", {1465, 602, 118, 67}}};

struct PhotoRecord {
  std::string file;
  GeoreferencedCamera camera;
  double above_takeoff_m = 0;
};

// Parses a photo's record, its cells by column name.
Expected<PhotoRecord> ParseRecord(const std::map<std::string, std::string>& cells, const fs::path& path) {
  const auto number = [&](const char* column) {
    const auto cell = cells.find(column);
    return cell == cells.end() ? std::nan("") : std::strtod(cell->second.c_str(), nullptr);
  };
  PhotoRecord photo;
  const auto name = cells.find("SourceFile");
  if (name != cells.end()) photo.file = name->second;
  photo.above_takeoff_m = number("RelativeAltitude");
  GeoreferencedCamera& camera = photo.camera;
  camera.place = {RadiansFromDegrees(number("GPSLatitude")), RadiansFromDegrees(number("GPSLongitude")),
                  number("GPSAltitude")};
  camera.attitude = {.yaw_rad = RadiansFromDegrees(number("GimbalYawDegree")),
                     .pitch_rad = RadiansFromDegrees(number("GimbalPitchDegree")),
                     .roll_rad = RadiansFromDegrees(number("GimbalRollDegree"))};
  const auto pixels = [&](const char* column) {
    constexpr double kMost = 100'000;
    const double count = number(column);
    return count >= 1 && count <= kMost ? static_cast<int>(count) : 0;
  };
  camera.pinhole.width = pixels("ImageWidth");
  camera.pinhole.height = pixels("ImageHeight");
  // The 35 mm equivalent relates the diagonals of the film (36 x 24 mm) and of the 4:3 sensor; photos are cropped to
  // 16:9.
  const double diagonal_px = camera.pinhole.width * std::hypot(4, 3) / 4;
  camera.pinhole.fx = camera.pinhole.fy = number("FocalLengthIn35mmFormat") / std::hypot(36, 24) * diagonal_px;
  camera.pinhole.cx = camera.pinhole.width / 2.0;
  camera.pinhole.cy = camera.pinhole.height / 2.0;
  const double all = camera.place.latitude_rad + camera.place.longitude_rad + camera.place.altitude_m +
                     camera.attitude.yaw_rad + camera.attitude.pitch_rad + camera.attitude.roll_rad +
                     camera.pinhole.fx + photo.above_takeoff_m;
  const bool has_size = camera.pinhole.width > 0 && camera.pinhole.height > 0;
  if (!photo.file.empty() && has_size && std::isfinite(all)) return photo;
  return Fail(ErrorCode::kDataLoss,
              fmt::format("{}: a photo must have a name, size, place, attitude and focal length", path.string()));
}

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

Expected<std::vector<PhotoRecord>> ReadPhotos(const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> columns = Cells(line);
  std::vector<PhotoRecord> photos;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = Cells(line);
    std::map<std::string, std::string> by_column;
    for (std::size_t i = 0; i < std::min(columns.size(), cells.size()); ++i) by_column[columns[i]] = cells[i];
    VICTORIOUS_ASSIGN_OR_RETURN(PhotoRecord photo, ParseRecord(by_column, path));
    photos.push_back(std::move(photo));
  }
  if (photos.empty()) return Fail(ErrorCode::kDataLoss, fmt::format("{}: no photos", path.string()));
  return photos;
}

Expected<std::vector<ObjectModel>> MakeModels(const fs::path& folder, const FeatureOptions& features) {
  std::vector<ObjectModel> models;
  for (const MarkedObject& object : kMarkedObjects) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Photo photo, LoadPhoto(folder / object.photo, object.box));
    VICTORIOUS_ASSIGN_OR_RETURN(
        ObjectModel model, MakePhotoModel(object.name, std::span(&photo, 1), std::nullopt, {.features = features}));
    models.push_back(std::move(model));
  }
  return models;
}

// An object's line of sight from a photo.
struct PhotoSighting {
  LineOfSight line;
  double ground_m;  // height of the take-off
};

// Returns the lines of sight of each object, from the best detection in each photo.
Expected<std::array<std::vector<PhotoSighting>, kMarkedObjects.size()>> DetectObjects(
    const fs::path& folder, const std::vector<PhotoRecord>& photos, const ExperimentSettings& settings) {
  const FeatureOptions features;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectModel> models, MakeModels(folder, features));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(features));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create(std::move(models), features.engine, RecognizeOptions()));
  std::array<std::vector<PhotoSighting>, kMarkedObjects.size()> found;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(folder / photos[i].file));
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor->Extract(GreyFromBgr(image.bgr)));
    std::array<bool, kMarkedObjects.size()> seen{};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(scene));
    for (const Detection& detection : detections) {
      if (std::exchange(seen[detection.model_index], true)) continue;
      const Eigen::Vector2d middle(detection.box.x + detection.box.width / 2,
                                   detection.box.y + detection.box.height / 2);
      found[detection.model_index].push_back(
          {.line = LineOfSightThrough(middle, photos[i].camera, static_cast<double>(i)),
           .ground_m = photos[i].camera.place.altitude_m - photos[i].above_takeoff_m});
    }
    settings.progress(photos[i].file);
  }
  return found;
}

struct Variant {
  LocateMethod method;
  bool ground;  // whether the ground is given, at the take-off height
};

double MeanGround(const std::vector<PhotoSighting>& sightings) {
  double sum_m = 0;
  for (const PhotoSighting& one : sightings) sum_m += one.ground_m;
  return sum_m / static_cast<double>(sightings.size());
}

// The place from each single photo: the intersection of its line of sight with the ground. Photos without one are left
// out.
std::vector<Geolocation> LocateFromSinglePhotos(const std::vector<PhotoSighting>& sightings, double ground_m) {
  std::vector<Geolocation> places;
  for (const PhotoSighting& one : sightings) {
    LocateOptions options{.method = LocateMethod::kGround};
    options.ground = std::make_shared<FlatGround>(ground_m);
    const auto fix = Locate(std::span(&one.line, 1), options);
    if (fix && fix->place) places.push_back(*fix->place);
  }
  return places;
}

void AddRow(const MarkedObject& object, const std::vector<PhotoSighting>& sightings, const Variant& way,
            Report& report) {
  const double ground_m = MeanGround(sightings);
  LocateOptions options{.method = way.method};
  if (way.ground) options.ground = std::make_shared<FlatGround>(ground_m);
  std::vector<LineOfSight> lines;
  for (const PhotoSighting& one : sightings) lines.push_back(one.line);
  const auto fix = Locate(lines, options);
  std::vector<Cell> row = {std::string(object.name), static_cast<double>(lines.size()),
                           std::string(ToText(kLocateMethodTexts, way.method)),
                           std::string(way.ground ? "given" : "-")};
  if (!fix || !fix->place) {
    row.insert(row.end(), {fix ? StatusText(*fix) : fix.error().message, std::string("-"), std::string("-"),
                           std::string("-"), std::string("-"), std::string("-")});
    report.rows.push_back(std::move(row));
    return;
  }
  const Geolocation& place = *fix->place;
  double farthest_m = 0;
  double min_ce90_m = std::numeric_limits<double>::infinity();
  double inside = 0;
  const std::vector<Geolocation> alone = LocateFromSinglePhotos(sightings, ground_m);
  for (const Geolocation& one : alone) {
    const double off_m = TangentPlane(place.point).EnuFromGeodetic(one.point).head<2>().norm();
    farthest_m = std::max(farthest_m, off_m);
    min_ce90_m = std::min(min_ce90_m, one.ce90_m);
    inside += off_m <= one.ce90_m ? 1 : 0;
  }
  row.insert(row.end(), {farthest_m, min_ce90_m, fmt::format("{:.0f} of {}", inside, alone.size()), place.ce90_m,
                         place.point.altitude_m - ground_m, place.le90_m});
  report.rows.push_back(std::move(row));
}

}  // namespace

Expected<Report> RunTableBrighton(const ExperimentSettings& settings) {
  const fs::path folder = settings.data / "real/geo_gcp/brighton_beach";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<PhotoRecord> photos, ReadPhotos(folder / "telemetry.csv"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto found, DetectObjects(folder, photos, settings));
  Report report{
      .title = "Places of one object from several photos",
      .notes = {"Each object is marked in one photo and detected in the others. Photos alone: the intersection of "
                "one ray with the ground at the take-off height, with a standard deviation of 2 m. Errors of lines "
                "and flight: the defaults. Nothing was surveyed: the rows show whether the photos agree."},
      .columns = {"object", "photos", "method", "ground", "photos alone: max distance from joint place, m",
                  "their CE90, min m", "within their CE90", "CE90, m", "above the take-off, m", "LE90, m"}};
  for (std::size_t i = 0; i < kMarkedObjects.size(); ++i) {
    if (found[i].empty()) continue;
    for (const Variant& way : std::initializer_list<Variant>{{LocateMethod::kGround, true},
                                                             {LocateMethod::kMaximumLikelihood, true},
                                                             {LocateMethod::kMaximumLikelihood, false},
                                                             {LocateMethod::kRansac, false},
                                                             {LocateMethod::kPrior, false},
                                                             {LocateMethod::kLeastSquares, false}}) {
      AddRow(kMarkedObjects[i], found[i], way, report);
    }
  }
  return report;
}

}  // namespace victorious
