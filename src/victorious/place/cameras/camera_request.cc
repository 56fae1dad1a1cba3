#include "victorious/place/cameras/camera_request.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "victorious/base/check.h"
#include "victorious/base/one_line.h"
#include "victorious/base/options.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/input/telemetry/geoid.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {
namespace {

bool IsSound(const std::vector<CameraState>& states) {
  const auto is_number = [](const CameraState& state) {
    return std::isfinite(state.time_s) && std::isfinite(state.place.latitude_rad) &&
           std::isfinite(state.place.longitude_rad) && std::isfinite(state.place.altitude_m);
  };
  return std::ranges::all_of(states, is_number) && std::ranges::is_sorted(states, {}, &CameraState::time_s);
}

}  // namespace

std::vector<std::filesystem::path> FilesOfCameraRequest(const CameraRequest& request) {
  std::vector<std::filesystem::path> files;
  if (request.file) files.emplace_back(*request.file);
  if (const auto beside = FindTelemetryFile(request.video)) files.push_back(*beside);
  if (const auto grid = FindEgm96Grid()) files.push_back(*grid);
  return files;
}

std::string PackCameraRequest(const CameraRequest& request) {
  ByteWriter writer;
  writer.PutText(request.video);
  writer.PutOptional(request.duration_s);
  writer.Put(std::int64_t{request.width});
  writer.Put(std::int64_t{request.height});
  writer.Put(request.file.has_value());
  writer.PutText(request.file.value_or(""));
  writer.PutText(OptionsToJsonText(request.options));
  writer.PutText(request.consequence);
  return writer.TakeText();
}

Expected<std::string> AnswerCameraRequest(std::string_view packed) {
  ByteReader reader(std::as_bytes(std::span(packed)));
  CameraRequest request;
  request.video = reader.GetText();
  request.duration_s = reader.GetOptional<double>();
  request.width = static_cast<int>(reader.Get<std::int64_t>());
  request.height = static_cast<int>(reader.Get<std::int64_t>());
  const bool has_file = reader.Get<bool>();
  std::string file = reader.GetText();
  if (has_file) request.file = std::move(file);
  const std::string options = reader.GetText();
  request.consequence = reader.GetText();
  VICTORIOUS_CHECK(reader.IsAtEnd());
  VICTORIOUS_RETURN_IF_ERROR(SetFromJsonText(options, CollectFields(request.options)));

  VideoInfo info;
  info.duration_s = request.duration_s;
  info.width = request.width;
  info.height = request.height;
  std::vector<std::string> warnings;
  VICTORIOUS_ASSIGN_OR_RETURN(
      const CameraStates cameras,
      CameraStates::Load(request.video, info, request.file, request.options, request.consequence,
                         [&](const std::string& warning) { warnings.push_back(warning); }));
  ByteWriter writer;
  writer.Put(std::uint64_t{warnings.size()});
  for (const std::string& warning : warnings) writer.PutText(warning);
  cameras.Pack(writer);
  return writer.TakeText();
}

Expected<CameraStates> UnpackCameraAnswer(std::string_view answer, const WarningSink& warn) {
  ByteReader reader(std::as_bytes(std::span(answer)));
  for (std::size_t left = reader.GetCount(sizeof(std::uint64_t)); left > 0; --left) {
    const std::string warning = reader.GetText();
    if (warn) warn(OneLine(warning));
  }
  CameraStates cameras = CameraStates::Unpack(reader);
  const bool is_sound =
      reader.IsAtEnd() && (cameras.trajectory() == nullptr || IsSound(cameras.trajectory()->states()));
  if (is_sound) return cameras;
  return Fail(ErrorCode::kDataLoss, "damaged: its decoder gave an answer without a meaning");
}

}  // namespace victorious
