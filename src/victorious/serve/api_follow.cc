// The jobs that follow something: a live source, and an object that a user boxed in a frame.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/credentials.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/serve/api.h"
#include "victorious/serve/api_response.h"
#include "victorious/serve/job_body.h"

namespace victorious {
namespace {

using Body = nlohmann::json;

}  // namespace

ApiExpected<Json> Api::LiveInput(const Body& body) {
  constexpr std::size_t kMaxBytes = 1000;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "url"}));
  const auto found = body.find("url");
  const std::string url = found != body.end() && found->is_string() ? found->get<std::string>() : "";
  // Quotes would end the address in a message, and its password would be shown.
  const auto is_plain = [](unsigned char c) { return c > ' ' && c < 0x7f && c != '"' && c != '\''; };
  if (!IsLiveSource(url) || url.size() > kMaxBytes || !std::ranges::all_of(url, is_plain)) {
    return FailField("url",
                     "The address must begin with rtsp://, rtsps://, udp://, srt:// or rtp://, and have no spaces");
  }
  return Json{{"video", url}, {"title", WithoutCredentials(url)}};
}

ApiExpected<Json> Api::TrackInput(const Body& body, const CancelToken& cancel) {
  constexpr std::size_t kMaxTypeBytes = 40;
  VICTORIOUS_RETURN_IF_ERROR(CheckMembers(body, {"kind", "video_id", "frame", "box", "type"}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ListedVideo listed, ReadVideo(body));
  const VideoRecord* video = listed.record;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(*video));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto times_s, videos_.Times(*video, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frame, ReadFrame(body, std::ssize(*times_s)));
  VICTORIOUS_RETURN_IF_ERROR(CheckBox(body));
  // The command takes the first frame at a time or later, and the table's times are rounded.
  constexpr double kRounding_s = 1e-4;
  const double at_s = std::max(0.0, (*times_s)[static_cast<std::size_t>(frame)] - kRounding_s);
  Json input = {{"video", path.string()}, {"video_id", video->id}, {"at_s", at_s}, {"box", body.at("box")}};
  std::string title = "box";
  if (const auto type = body.find("type"); type != body.end() && !type->is_null()) {
    const std::string word = type->is_string() ? type->get<std::string>() : "";
    const auto is_letter = [](unsigned char c) { return c >= ' ' && c != 0x7f; };
    if (word.empty() || word.size() > kMaxTypeBytes || !std::ranges::all_of(word, is_letter)) {
      return FailField("type", fmt::format("The type must be one line of at most {} bytes", kMaxTypeBytes));
    }
    input["type"] = word;
    title = word;
  }
  if (const auto telemetry = TelemetryOf(*video)) input["telemetry"] = *telemetry;
  input["title"] = fmt::format("{} in {}", title, std::filesystem::path(video->name).filename().string());
  Json content = input;
  content["content"] = video->content_id;
  const std::string text = DumpJson(content);
  VICTORIOUS_RETURN_IF_ERROR(copies_.Create());
  input["track"] =
      copies_.PathOf(fmt::format("track-{:016x}.jsonl", Checksum(std::as_bytes(std::span(text))))).string();
  return input;
}

}  // namespace victorious
