#include "victorious/jobs/navigate/landmark_list.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/warning_list.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/store/index_store.h"
#include "victorious/store/open_store.h"

namespace victorious {

void LandmarkListOptions::ListFields(FieldList& fields) {
  fields.Add("heading_deg", heading_deg,
             {.min = 0,
              .max = 180,
              .unit = "deg",
              .reason = "standard deviation of a landmark's heading if the list gives none"});
  fields.Add("common_fraction", common_fraction,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "standard deviation of the error common to all landmarks' places, over that of the best place: "
                        "1 for landmarks located in one flight, 0 for landmarks surveyed independently"});
  fields.Add("max_speed_m_s", max_speed_m_s,
             {.min = 0, .max = 1e3, .unit = "m/s", .reason = "objects that move faster are not landmarks"});
}

namespace {

using InputJson = nlohmann::json;

constexpr std::string_view kSqlite = "SQLite format 3";

// std::nullopt if the key is missing or null.
Expected<std::optional<double>> NumberAt(const InputJson& json, const char* key, double min_value, double max_value) {
  const auto at = json.find(key);
  if (at == json.end() || at->is_null()) return std::nullopt;
  if (!at->is_number() || !(at->get<double>() >= min_value && at->get<double>() <= max_value)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is not a number from {} to {}", key, min_value, max_value));
  }
  return at->get<double>();
}

Expected<double> RequiredNumberAt(const InputJson& json, const char* key, double min_value, double max_value) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto number, NumberAt(json, key, min_value, max_value));
  if (!number) return Fail(ErrorCode::kInvalidArgument, fmt::format("{} is missing: give a number", key));
  return *number;
}

// Zero if the key is missing or null.
Expected<Eigen::Matrix3d> CovarianceAt(const InputJson& json) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  const auto at = json.find("covariance_enu_m2");
  if (at == json.end() || at->is_null()) return covariance;
  const auto refuse = [] {
    return Fail(ErrorCode::kInvalidArgument,
                "covariance_enu_m2 is not three rows of three numbers, symmetric and "
                "without negative variances");
  };
  if (!at->is_array() || at->size() != 3) return refuse();
  for (std::size_t row = 0; row < 3; ++row) {
    if (!(*at)[row].is_array() || (*at)[row].size() != 3) return refuse();
    for (std::size_t column = 0; column < 3; ++column) {
      if (!(*at)[row][column].is_number()) return refuse();
      covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = (*at)[row][column].get<double>();
    }
  }
  const double size = covariance.cwiseAbs().maxCoeff();
  constexpr double kRounding = 1e-3;
  constexpr double kMaxM2 = 1e12;
  if (!(size <= kMaxM2) || (covariance - covariance.transpose()).cwiseAbs().maxCoeff() > kRounding * size) {
    return refuse();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  if (axes.eigenvalues().minCoeff() < -kRounding * size) return refuse();
  return Eigen::Matrix3d(axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() *
                         axes.eigenvectors().transpose());
}

Expected<Landmark> ParseLandmark(std::string_view line, const LandmarkListOptions& options) {
  const Expected<InputJson> parsed = ParseStrictJson(line);
  if (!parsed || !parsed->is_object()) return Fail(ErrorCode::kInvalidArgument, "not a JSON object on one line");
  const InputJson& json = *parsed;
  Landmark landmark;
  const auto model = json.find("model");
  if (model == json.end() || !model->is_string()) {
    return Fail(ErrorCode::kInvalidArgument, "model is missing: give a model's name");
  }
  landmark.model = model->get<std::string>();
  constexpr double kMaxHeightM = 1e5;
  VICTORIOUS_ASSIGN_OR_RETURN(const double latitude_deg, RequiredNumberAt(json, "latitude_deg", -90, 90));
  VICTORIOUS_ASSIGN_OR_RETURN(const double longitude_deg, RequiredNumberAt(json, "longitude_deg", -180, 360));
  VICTORIOUS_ASSIGN_OR_RETURN(const double altitude_m, RequiredNumberAt(json, "altitude_m", -kMaxHeightM, kMaxHeightM));
  landmark.place = {RadiansFromDegrees(latitude_deg), RadiansFromDegrees(longitude_deg), altitude_m};
  VICTORIOUS_ASSIGN_OR_RETURN(landmark.covariance_enu_m2, CovarianceAt(json));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto heading_deg, NumberAt(json, "heading_deg", -360, 360));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto sigma_deg, NumberAt(json, "sigma_heading_deg", 0, 180));
  if (heading_deg) landmark.heading_rad = RadiansFromDegrees(*heading_deg);
  landmark.sigma_heading_rad = RadiansFromDegrees(sigma_deg.value_or(options.heading_deg));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto speed_m_s, NumberAt(json, "speed_m_s", 0, 1e4));
  if (speed_m_s.value_or(0) > options.max_speed_m_s) {
    return Fail(ErrorCode::kInvalidArgument, "it moves: only static objects are landmarks");
  }
  return landmark;
}

Expected<LandmarkList> ReadIndexLandmarks(IndexStore& store, const LandmarkListOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, {}));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(store, catalogue, {.without_weak = true}));
  LandmarkList list;
  WarningList skipped;
  for (const ListedObject& listed : objects) {
    const ObjectRecord& object = listed.object;
    if (listed.is_category) continue;  // categories are not recognised by a model
    if (!object.place || ComputeSpeed(object).value_or(0) > options.max_speed_m_s) {
      skipped.Add(fmt::format("object {}, {}, is skipped: {}", object.id, listed.model,
                              object.place ? "it moves" : "it has no place"));
      continue;
    }
    list.landmarks.push_back({.model = listed.model,
                              .place = object.place->point,
                              .covariance_enu_m2 = object.place->covariance_enu_m2,
                              .heading_rad = object.heading_rad,
                              .sigma_heading_rad = RadiansFromDegrees(options.heading_deg)});
  }
  list.warnings = skipped.Lines();
  if (list.landmarks.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "no static object with a place: index a video with telemetry first");
  }
  return list;
}

}  // namespace

Expected<LandmarkList> ParseLandmarks(std::string_view text, const LandmarkListOptions& options) {
  LandmarkList list;
  WarningList skipped;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    Expected<Landmark> landmark = ParseLandmark(line, options);
    if (landmark) {
      list.landmarks.push_back(*std::move(landmark));
    } else {
      skipped.Add(fmt::format("line {} is skipped: {}", number, landmark.error().message));
    }
  }
  list.warnings = skipped.Lines();
  if (!list.landmarks.empty()) return list;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("neither an index nor a list of landmarks (JSON Lines){}",
                          list.warnings.empty() ? ": it is empty" : "; " + list.warnings.front()));
}

Expected<LandmarkList> ReadLandmarks(const std::string& path, const LandmarkListOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  Expected<LandmarkList> list = LandmarkList{};
  std::shared_ptr<const MappedFile> file;
  std::string_view text;
  if (!IsDatabaseUrl(path)) {
    VICTORIOUS_ASSIGN_OR_RETURN(file, MappedFile::Open(path));
    const auto bytes = file->bytes();
    text = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  if (IsDatabaseUrl(path) || text.starts_with(kSqlite)) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(path, StoreMode::kRead));
    list = ReadIndexLandmarks(*store, options);
  } else {
    list = ParseLandmarks(text, options);
  }
  if (!list) return std::unexpected(std::move(list).error().WithContext(StoreName(path)));
  const auto variance = [](const Landmark& landmark) { return landmark.covariance_enu_m2.trace(); };
  const Landmark& best = *std::ranges::min_element(list->landmarks, {}, variance);
  list->common_covariance_enu_m2 = options.common_fraction * options.common_fraction * best.covariance_enu_m2;
  return list;
}

}  // namespace victorious
