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

#include "victorious/base/file.h"
#include "experiments/place_experiments.h"
#include "experiments/place_trials.h"
#include "victorious/features/feature_extractor.h"
#include "victorious/geolocate/locate.h"
#include "victorious/geometry/angles.h"
#include "victorious/model/photo_model.h"
#include "victorious/recognize/recognizer.h"
#include "victorious/image/image_file.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

// An object, manually marked in one photo.
struct Thing {
  const char* name;
  const char* photo;
  Box box;  // px
};

constexpr std::array kThings = {
    Thing{"picnic table", "DJI_0031.JPG", {1155, 515, 83, 74}},
    Thing{"white car", "DJI_0031.JPG", {1277, 402, 141, 66}}, Thing{"silver car", "DJI_0031.JPG", {1201, 295, 130, 89}},
    Thing{"red car", "DJI_0034.JPG", {1468, 476, 146, 80}}, Thing{"dark car", "DJI_0034.JPG", {1465, 602, 118, 67}}};

struct Photographed {
  std::string file;
  StandingCamera camera;
  double above_takeoff_m = 0;
};

// Parses a photo's record, its cells by column name.
Expected<Photographed> RecordOf(const std::map<std::string, std::string>& cells, const fs::path& path) {
  const auto number = [&](const char* column) {
    const auto cell = cells.find(column);
    return cell == cells.end() ? std::nan("") : std::strtod(cell->second.c_str(), nullptr);
  };
  Photographed photo;
  const auto name = cells.find("SourceFile");
  if (name != cells.end()) photo.file = name->second;
  photo.above_takeoff_m = number("RelativeAltitude");
  StandingCamera& camera = photo.camera;
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

Expected<std::vector<Photographed>> PhotosOf(const fs::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> columns = Cells(line);
  std::vector<Photographed> photos;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = Cells(line);
    std::map<std::string, std::string> by_column;
    for (std::size_t i = 0; i < std::min(columns.size(), cells.size()); ++i) by_column[columns[i]] = cells[i];
    VICTORIOUS_ASSIGN_OR_RETURN(Photographed photo, RecordOf(by_column, path));
    photos.push_back(std::move(photo));
  }
  if (photos.empty()) return Fail(ErrorCode::kDataLoss, fmt::format("{}: no photos", path.string()));
  return photos;
}

Expected<std::vector<ObjectModel>> ModelsIn(const fs::path& folder, const FeatureOptions& features) {
  std::vector<ObjectModel> models;
  for (const Thing& thing : kThings) {
    VICTORIOUS_ASSIGN_OR_RETURN(const Photo photo, LoadPhoto(folder / thing.photo, thing.box));
    VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model,
                                MakePhotoModel(thing.name, std::span(&photo, 1), std::nullopt, {.features = features}));
    models.push_back(std::move(model));
  }
  return models;
}

// An object's line of sight from a photo.
struct Sighted {
  LineOfSight line;
  double ground_m;  // height of the take-off
};

// Returns the lines of sight of each object, from the best detection in each photo.
Expected<std::array<std::vector<Sighted>, kThings.size()>> FindThings(const fs::path& folder,
                                                                      const std::vector<Photographed>& photos,
                                                                      const ExperimentSettings& settings) {
  const FeatureOptions features;
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectModel> models, ModelsIn(folder, features));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(features));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create(std::move(models), features.engine, RecognizeOptions()));
  std::array<std::vector<Sighted>, kThings.size()> found;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
    VICTORIOUS_ASSIGN_OR_RETURN(const Image image, ReadImage(folder / photos[i].file));
    VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor->Extract(GreyFromBgr(image.bgr)));
    std::array<bool, kThings.size()> seen{};
    for (const Detection& detection : recognizer.Recognize(scene)) {
      if (std::exchange(seen[detection.model], true)) continue;
      const Eigen::Vector2d middle(detection.box.x + detection.box.width / 2,
                                   detection.box.y + detection.box.height / 2);
      found[detection.model].push_back({.line = LineThrough(middle, photos[i].camera, static_cast<double>(i)),
                                        .ground_m = photos[i].camera.place.altitude_m - photos[i].above_takeoff_m});
    }
    settings.progress(photos[i].file);
  }
  return found;
}

struct Way {
  const char* method;
  bool ground;  // whether the ground is given, at the take-off height
};

double MeanGround(const std::vector<Sighted>& sighted) {
  double sum_m = 0;
  for (const Sighted& one : sighted) sum_m += one.ground_m;
  return sum_m / static_cast<double>(sighted.size());
}

// The place from each single photo: the intersection of its line of sight with the ground. Photos without one are left
// out.
std::vector<Place> PlacesByOne(const std::vector<Sighted>& sighted, double ground_m) {
  std::vector<Place> places;
  for (const Sighted& one : sighted) {
    LocateOptions options{.method = "ground"};
    options.ground = std::make_shared<FlatGround>(ground_m);
    const auto fix = Locate(std::span(&one.line, 1), options);
    if (fix && fix->place) places.push_back(*fix->place);
  }
  return places;
}

void AddRow(const Thing& thing, const std::vector<Sighted>& sighted, const Way& way, Report& report) {
  const double ground_m = MeanGround(sighted);
  LocateOptions options{.method = way.method};
  if (way.ground) options.ground = std::make_shared<FlatGround>(ground_m);
  std::vector<LineOfSight> lines;
  for (const Sighted& one : sighted) lines.push_back(one.line);
  const auto fix = Locate(lines, options);
  std::vector<Cell> row = {std::string(thing.name), static_cast<double>(lines.size()), std::string(way.method),
                           std::string(way.ground ? "told" : "-")};
  if (!fix || !fix->place) {
    row.insert(row.end(), {fix ? fix->status : fix.error().message, std::string("-"), std::string("-"),
                           std::string("-"), std::string("-"), std::string("-")});
    report.rows.push_back(std::move(row));
    return;
  }
  const Place& place = *fix->place;
  double farthest_m = 0;
  double least_ce90_m = std::numeric_limits<double>::infinity();
  double inside = 0;
  const std::vector<Place> alone = PlacesByOne(sighted, ground_m);
  for (const Place& one : alone) {
    const double off_m = TangentPlane(place.point).EnuFromGeodetic(one.point).head<2>().norm();
    farthest_m = std::max(farthest_m, off_m);
    least_ce90_m = std::min(least_ce90_m, one.ce90_m);
    inside += off_m <= one.ce90_m ? 1 : 0;
  }
  row.insert(row.end(), {farthest_m, least_ce90_m, fmt::format("{:.0f} of {}", inside, alone.size()), place.ce90_m,
                         place.point.altitude_m - ground_m, place.le90_m});
  report.rows.push_back(std::move(row));
}

}  // namespace

Expected<Report> RunTableBrighton(const ExperimentSettings& settings) {
  const fs::path folder = settings.data / "real/geo_gcp/brighton_beach";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Photographed> photos, PhotosOf(folder / "telemetry.csv"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto found, FindThings(folder, photos, settings));
  Report report{
      .title = "Places of one object from several photos",
      .notes = {"Each object is marked in one photo and detected in the others. Photos alone: the intersection of "
                "one ray with the ground at the take-off height, with a standard deviation of 2 m. Errors of lines "
                "and flight: the defaults. Nothing was surveyed: the rows show whether the photos agree."},
      .columns = {"thing", "photos", "method", "ground", "photos alone: farthest from it, m", "their CE90, least m",
                  "within it", "CE90, m", "above the take-off, m", "LE90, m"}};
  for (std::size_t i = 0; i < kThings.size(); ++i) {
    if (found[i].empty()) continue;
    for (const Way& way : std::initializer_list<Way>{{"ground", true},
                                                     {"ml", true},
                                                     {"ml", false},
                                                     {"ransac", false},
                                                     {"prior", false},
                                                     {"least-squares", false}}) {
      AddRow(kThings[i], found[i], way, report);
    }
  }
  return report;
}

}  // namespace victorious
