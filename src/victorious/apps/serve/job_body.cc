#include "victorious/apps/serve/job_body.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

// Sources that send by themselves. Without http and file, an analyst cannot fetch pages and files that only the server
// reaches; that an rtsp:// address answers can still be seen.
constexpr std::array<std::string_view, 5> kLiveSchemes = {"rtsp://", "rtsps://", "udp://", "srt://", "rtp://"};

bool IsBox(const nlohmann::json& box) {
  return box.is_array() && box.size() == 4 &&
         std::ranges::all_of(box, [](const nlohmann::json& one) { return one.is_number(); }) &&
         box[2].get<double>() > 0 && box[3].get<double>() > 0;
}

}  // namespace

bool IsLiveSource(std::string_view url) {
  return std::ranges::any_of(
      kLiveSchemes, [&](std::string_view scheme) { return url.starts_with(scheme) && url.size() > scheme.size(); });
}

ApiStatus CheckMembers(const nlohmann::json& body, std::initializer_list<std::string_view> names) {
  for (const auto& [name, value] : body.items()) {
    if (std::ranges::find(names, name) == names.end())
      return FailField(name, fmt::format("A job of this kind has no {}", name));
  }
  return {};
}

std::int64_t ReadNumber(const nlohmann::json& body, std::string_view name) {
  const auto found = body.find(name);
  return found != body.end() && found->is_number_integer() ? found->get<std::int64_t>() : -1;
}

ApiExpected<std::int64_t> ReadFrame(const nlohmann::json& body, std::int64_t frames) {
  const std::int64_t frame = ReadNumber(body, "frame");
  if (frame >= 0 && frame < frames) return frame;
  return FailField("frame", fmt::format("The frame must be a number from 0 to {}", frames - 1));
}

ApiStatus CheckBox(const nlohmann::json& body) {
  const auto box = body.find("box");
  if (box != body.end() && IsBox(*box)) return {};
  return FailField("box", "The box must be x, y, width and height in pixels");
}

ApiStatus CheckBoxes(const nlohmann::json& body, std::size_t photos) {
  const auto boxes = body.find("boxes");
  if (boxes != body.end() && boxes->is_array() && boxes->size() == photos && std::ranges::all_of(*boxes, IsBox)) {
    return {};
  }
  return FailField("boxes", "Give one box for each photo: x, y, width and height in pixels");
}

ApiExpected<std::string> ReadText(const nlohmann::json& body, const std::string& name) {
  const auto found = body.find(name);
  if (found != body.end() && found->is_string()) return found->get<std::string>();
  return FailField(name, fmt::format("The {} must be a text", name));
}

}  // namespace victorious
