#include "victorious/cli/arguments.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/geometry/angles.h"

namespace victorious::cli {

namespace {

// Finite numbers with commas between; nothing for any other text.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> ParseNumbers(std::string_view text) {
  std::array<double, kCount> numbers{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    const bool separated = i + 1 < kCount ? next != end && *next == ',' : next == end;
    if (error != std::errc() || !separated || !std::isfinite(numbers[i])) return std::nullopt;
    at = next + 1;
  }
  return numbers;
}

}  // namespace

Expected<Surroundings> ParseSurroundings(std::string_view text) {
  const auto numbers = ParseNumbers<3>(text);
  if (!numbers || std::abs((*numbers)[0]) > 90 || std::abs((*numbers)[1]) > 360 || (*numbers)[2] < 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--near \"{}\": must be latitude and longitude in degrees and a distance in metres, as in "
                            "52.52,13.40,50",
                            text));
  }
  return Surroundings{{RadiansFromDegrees((*numbers)[0]), RadiansFromDegrees((*numbers)[1]), 0}, (*numbers)[2]};
}

Expected<Box> ParseBox(std::string_view text) {
  const auto numbers = ParseNumbers<4>(text);
  if (!numbers) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("box \"{}\": must be x,y,w,h in pixels, as in 10,20,300,200", text));
  }
  const Box box{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
  if (box.IsEmpty())
    return Fail(ErrorCode::kInvalidArgument, fmt::format("box \"{}\": width and height must be above 0", text));
  return box;
}

std::string CheckSeconds(const std::string& text) {
  double seconds = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, seconds);
  if (error == std::errc() && next == end && std::isfinite(seconds) && seconds >= 0) return "";
  return fmt::format("\"{}\": must be a number of seconds, 0 or more", text);
}

Status ReadParams(const std::string& path, const std::vector<FieldRef>& fields) {
  if (path.empty()) return {};
  constexpr std::size_t kMostBytes = 1 << 20;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMostBytes));
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  if (json.is_discarded()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: not JSON: parameters are an object such as {{\"match\": {{\"ratio\": 0.8}}}}", path));
  }
  if (auto status = SetFromJson(json, fields); !status)
    return std::unexpected(std::move(status).error().WithContext(path));
  return {};
}

Status WriteOutput(const std::string& path, std::string_view text) {
  if (!path.empty() && path != "-") return WriteFileAtomically(path, text);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    return std::unexpected(ErrorFromErrno(errno, "write to standard output"));
  }
  return {};
}

std::string OneLine(std::string text) {
  constexpr char kDelete = 0x7f;
  std::ranges::replace_if(text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == kDelete; }, '?');
  return text;
}

CancelToken& Interrupt() {
  static CancelToken token;
  static const bool installed = [] {
    const auto handler = [](int) { token.Cancel(); };  // may come before `installed` is
    std::signal(SIGINT, handler);
    std::signal(SIGTERM, handler);
    return true;
  }();
  static_cast<void>(installed);
  return token;
}

void FilterArguments::AddTo(CLI::App& app) {
  app.add_option("--video", video, "Only this video: its name as indexed, or its last parts")->type_name("NAME");
  app.add_option("--model", model, "Only this model")->type_name("NAME");
  app.add_option("--from", from_s, "Only from this time of the video on, seconds")->type_name("S")->check(CheckSeconds);
  app.add_option("--to", to_s, "Only up to this time of the video, seconds")->type_name("S")->check(CheckSeconds);
  app.add_option("--near", near, "Only objects at most so far from a place on Earth (degrees, metres)")
      ->type_name("LAT,LON,METRES");
}

Expected<SightingFilter> FilterArguments::Filter() const {
  for (const auto& [flag, time_s] : {std::pair("--from", from_s), std::pair("--to", to_s)}) {
    if (time_s && !std::isfinite(*time_s))
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{} {}: must be a number of seconds", flag, *time_s));
  }
  if (from_s && to_s && *from_s > *to_s) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--from {:g} lies after --to {:g}: give a time and a later one", *from_s, *to_s));
  }
  SightingFilter filter;
  if (!near.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(filter.near, ParseSurroundings(near));
  }
  if (!model.empty()) filter.model_name = model;
  if (!video.empty()) filter.video_name = video;
  filter.from_s = from_s;
  filter.to_s = to_s;
  return filter;
}

}  // namespace victorious::cli
