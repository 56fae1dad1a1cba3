#include "victorious/base/program_events.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "victorious/base/credentials.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/json.h"
#include "victorious/base/one_line.h"

namespace victorious {
namespace {

using Json = nlohmann::ordered_json;

enum class EventKind { kProgress, kInfo, kWarning, kError, kVideoLeft, kVideoCut };

constexpr auto kEventKindTexts = std::to_array<EnumText<EventKind>>({{EventKind::kProgress, "progress"},
                                                                     {EventKind::kInfo, "info"},
                                                                     {EventKind::kWarning, "warning"},
                                                                     {EventKind::kError, "error"},
                                                                     {EventKind::kVideoLeft, "video_left"},
                                                                     {EventKind::kVideoCut, "video_cut"}});

std::string EventText(const std::string& text) {
  return OneLine(WithoutCredentials(text).substr(0, kMaxEventTextBytes));
}

Json NewEvent(EventKind kind) { return {{"event", ToText(kEventKindTexts, kind)}}; }

struct EventWriter {
  Json operator()(const ProgressEvent& event) const {
    Json json = NewEvent(EventKind::kProgress);
    json["label"] = EventText(event.label);
    json["done"] = event.done;
    json["total"] = event.total ? Json(*event.total) : Json();
    json["unit"] = EventText(event.unit);
    json["elapsed_s"] = event.elapsed_s;
    if (event.behind_s) json["behind_s"] = *event.behind_s;
    return json;
  }

  Json operator()(const InfoEvent& event) const { return Message(EventKind::kInfo, event.message); }
  Json operator()(const WarningEvent& event) const { return Message(EventKind::kWarning, event.message); }

  Json operator()(const ErrorEvent& event) const {
    Json json = Message(EventKind::kError, event.error.message);
    json["code"] = Name(event.error.code);
    return json;
  }

  Json operator()(const VideoLeftEvent& event) const { return Video(EventKind::kVideoLeft, event.video); }

  Json operator()(const VideoCutEvent& event) const {
    Json json = Video(EventKind::kVideoCut, event.video);
    json["cut"] = event.cut;
    return json;
  }

 private:
  static Json Video(EventKind kind, const std::string& video) {
    Json json = NewEvent(kind);
    json["video"] = EventText(video);
    return json;
  }
  static Json Message(EventKind kind, const std::string& message) {
    Json json = NewEvent(kind);
    json["message"] = EventText(message);
    return json;
  }
};

std::unexpected<Error> Invalid(std::string_view member, std::string_view rule) {
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must be {}", member, rule));
}

// The members of the object of one line.
class EventReader {
 public:
  explicit EventReader(const nlohmann::json& json) : json_(json) {}

  [[nodiscard]] Expected<std::string> Text(const char* member) const {
    const auto found = json_.find(member);
    if (found == json_.end() || !found->is_string()) return Invalid(member, "a text");
    auto text = found->get<std::string>();
    if (text != OneLine(text)) return Invalid(member, "one line without control characters");
    return text;
  }

  [[nodiscard]] Expected<std::int64_t> Count(const char* member) const {
    const auto found = json_.find(member);
    const bool is_count =
        found != json_.end() && found->is_number_unsigned() && std::in_range<std::int64_t>(found->get<std::uint64_t>());
    if (!is_count) return Invalid(member, "a whole number from 0");
    return found->get<std::int64_t>();
  }

  [[nodiscard]] Expected<std::optional<std::int64_t>> OptionalCount(const char* member) const {
    const auto found = json_.find(member);
    if (found == json_.end() || found->is_null()) return std::nullopt;
    return Count(member);
  }

  [[nodiscard]] Expected<double> Seconds(const char* member) const {
    const auto found = json_.find(member);
    const bool is_time = found != json_.end() && found->is_number() && found->get<double>() >= 0;
    if (!is_time) return Invalid(member, "a number of seconds from 0");
    return found->get<double>();
  }

  [[nodiscard]] Expected<std::optional<double>> OptionalSeconds(const char* member) const {
    if (!json_.contains(member)) return std::nullopt;
    return Seconds(member);
  }

 private:
  const nlohmann::json& json_;
};

Expected<ProgramEvent> ReadProgress(const EventReader& reader) {
  ProgressEvent event;
  VICTORIOUS_ASSIGN_OR_RETURN(event.label, reader.Text("label"));
  VICTORIOUS_ASSIGN_OR_RETURN(event.done, reader.Count("done"));
  VICTORIOUS_ASSIGN_OR_RETURN(event.total, reader.OptionalCount("total"));
  VICTORIOUS_ASSIGN_OR_RETURN(event.unit, reader.Text("unit"));
  VICTORIOUS_ASSIGN_OR_RETURN(event.elapsed_s, reader.Seconds("elapsed_s"));
  VICTORIOUS_ASSIGN_OR_RETURN(event.behind_s, reader.OptionalSeconds("behind_s"));
  return event;
}

Expected<ProgramEvent> ReadError(const EventReader& reader) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, reader.Text("code"));
  const std::optional<ErrorCode> code = FromText(kErrorCodeTexts, name);
  if (!code) return Invalid("code", fmt::format("the code of an error, not \"{}\"", name));
  VICTORIOUS_ASSIGN_OR_RETURN(std::string message, reader.Text("message"));
  return ErrorEvent{Error{*code, std::move(message)}};
}

struct EventOutput {
  std::mutex mutex;
  int descriptor = -1;  // -1: none
};

EventOutput& Output() {
  static EventOutput output;
  return output;
}

}  // namespace

std::string FormatEvent(const ProgramEvent& event) { return DumpJson(std::visit(EventWriter(), event)); }

Expected<ProgramEvent> ParseEvent(std::string_view line) {
  if (line.size() > kMaxEventBytes) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("a line of more than {} bytes", kMaxEventBytes));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const nlohmann::json json, ParseJson(line));
  if (!json.is_object()) return Fail(ErrorCode::kInvalidArgument, "must be a JSON object");
  const EventReader reader(json);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, reader.Text("event"));
  const std::optional<EventKind> kind = FromText(kEventKindTexts, name);
  if (!kind) return Invalid("event", fmt::format("the name of a kind of event, not \"{}\"", name));
  switch (*kind) {
    case EventKind::kProgress:
      return ReadProgress(reader);
    case EventKind::kError:
      return ReadError(reader);
    case EventKind::kVideoLeft:
    case EventKind::kVideoCut: {
      VICTORIOUS_ASSIGN_OR_RETURN(std::string video, reader.Text("video"));
      if (*kind == EventKind::kVideoLeft) return VideoLeftEvent{std::move(video)};
      VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t cut, reader.Count("cut"));
      return VideoCutEvent{std::move(video), cut};
    }
    case EventKind::kInfo:
    case EventKind::kWarning:
      break;
  }
  VICTORIOUS_ASSIGN_OR_RETURN(std::string message, reader.Text("message"));
  if (*kind == EventKind::kInfo) return InfoEvent{std::move(message)};
  return WarningEvent{std::move(message)};
}

Status OpenEventOutput(int descriptor) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not a descriptor that is open for writing", descriptor));
  }
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away must not end the work
  if (descriptor > STDERR_FILENO) ::fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  const std::scoped_lock lock(Output().mutex);
  Output().descriptor = descriptor;
  return {};
}

bool HasEventOutput() {
  const std::scoped_lock lock(Output().mutex);
  return Output().descriptor >= 0;
}

void ReportEvent(const ProgramEvent& event) {
  const std::scoped_lock lock(Output().mutex);
  if (Output().descriptor < 0) return;
  const std::string line = FormatEvent(event) + "\n";
  for (std::string_view rest = line; !rest.empty();) {
    const ssize_t written = ::write(Output().descriptor, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace victorious
