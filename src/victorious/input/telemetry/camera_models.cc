#include "victorious/input/telemetry/camera_models.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

#include "victorious/base/text.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kWidth_mm = 36;  // of the 35 mm film

constexpr double k4To3 = 0.8;
constexpr double k3To2 = 0.832;

constexpr std::array kModels = std::to_array<CameraModel>({
    {"air-2s", "FC3411", 88, k3To2},
    {"air-3", "FC8282", 82, k4To3},
    {"air-3-tele", "FC8284", 35, k4To3},
    {"inspire-1", "FC350", 94, k4To3},
    {"mavic-2-pro", "L1D-20c", 77, k3To2},
    {"mavic-2-zoom", "FC2204", 83, k4To3},
    {"mavic-3", "L2D-20c", 84, k4To3},
    {"mavic-3-tele", "FC4170", 15, k4To3},
    {"mavic-3e", "M3E", 84, k4To3},
    {"mavic-3t", "M3T", 84, k4To3},
    {"mavic-air", "FC2103", 85, k4To3},
    {"mavic-air-2", "FC3170", 84, k4To3},
    {"mavic-mini", "FC7203", 83, k4To3},
    {"mavic-pro", "FC220", 78.8, k4To3},
    {"mini-2", "FC7303", 83, k4To3},
    {"mini-3", "FC3682", 82.1, k4To3},
    {"mini-3-pro", "FC3582", 82.1, k4To3},
    {"mini-4-pro", "FC8482", 82.1, k4To3},
    {"phantom-3-advanced", "FC300S", 94, k4To3},
    {"phantom-3-pro", "FC300X", 94, k4To3},
    {"phantom-3-standard", "FC300C", 94, k4To3},
    {"phantom-4", "FC330", 94, k4To3},
    {"phantom-4-pro", "FC6310", 84, k3To2},
    {"phantom-4-pro-v2", "FC6310S", 84, k3To2},
    {"phantom-4-rtk", "FC6310R", 84, k3To2},
    {"spark", "FC1102", 81.9, k4To3},
    {"zenmuse-h20", "ZH20", 82.9, k4To3},
    {"zenmuse-h20t", "ZH20T", 82.9, k4To3},
    {"zenmuse-p1", "ZenmuseP1", 63.5, k3To2},
    {"zenmuse-x4s", "FC6510", 84, k3To2},
    {"zenmuse-x5", "FC550", 72, k4To3},
    {"zenmuse-x5s", "FC6520", 72, k4To3},
});

std::string Plain(std::string_view name) {
  std::string plain;
  for (const char c : LowerCase(name)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain.push_back(c);
  }
  return plain.starts_with("dji") ? plain.substr(3) : plain;
}

double AngleFromHalfTangent(double tangent) { return 2 * std::atan(tangent); }

}  // namespace

std::span<const CameraModel> CameraModels() { return kModels; }

const CameraModel* FindCameraModel(std::string_view name) {
  const std::string wanted = Plain(name);
  const auto found = std::ranges::find_if(kModels, [&](const CameraModel& model) {
    return Plain(model.aircraft) == wanted || Plain(model.code) == wanted;
  });
  return found == kModels.end() ? nullptr : &*found;
}

double FieldOfViewFromFocal(double focal_35mm_mm) { return AngleFromHalfTangent(kWidth_mm / (2 * focal_35mm_mm)); }

double FocalFromFieldOfView(double hfov_rad) { return kWidth_mm / (2 * std::tan(hfov_rad / 2)); }

double FieldOfView(const CameraModel& camera, std::optional<double> focal_35mm_mm) {
  constexpr double kDiagonal_mm = 43.267;  // of 36 x 24 mm
  const double half_diagonal =
      focal_35mm_mm ? kDiagonal_mm / (2 * *focal_35mm_mm) : std::tan(RadiansFromDegrees(camera.diagonal_deg) / 2);
  return AngleFromHalfTangent(camera.width_of_diagonal * half_diagonal);
}

}  // namespace victorious
