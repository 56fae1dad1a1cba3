// Fuzzes the readers of work from a database: the first line of an input is the kind, the rest the JSON. A task or a
// job becomes arguments that a process can have, or a one-line error; a task comes back as it was read.
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/apps/cluster/index_task.h"
#include "victorious/apps/serve/job_runner.h"
#include "victorious/base/check.h"

namespace {

using victorious::JobKind;

void CheckError(const victorious::Error& error) {
  VICTORIOUS_CHECK(!error.message.empty() && error.message.find('\n') == std::string::npos);
}

void CheckArguments(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) VICTORIOUS_CHECK(argument.find('\0') == std::string::npos);
}

void CheckTask(std::string_view kind, std::string_view payload) {
  const auto task = victorious::FromQueue(kind, payload);
  if (!task) return CheckError(task.error());
  CheckArguments(task->options);
  CheckArguments({task->video, task->program});
  const auto queued = victorious::ToQueue(*task, "content", {});
  VICTORIOUS_CHECK(queued.has_value());
  const auto again = victorious::FromQueue(queued->kind, queued->payload);
  VICTORIOUS_CHECK(again.has_value() && again->video == task->video && again->options == task->options &&
                   again->program == task->program && again->files == task->files &&
                   again->content_id == task->content_id);
}

void CheckJob(JobKind kind, std::string_view input) {
  const victorious::JobRecord job{.kind = kind, .input_json = std::string(input)};
  const auto arguments = victorious::JobArguments(job, {.index = "/d/index.db", .models = "/m", .copies = "/d"});
  if (!arguments) return CheckError(arguments.error());
  CheckArguments(*arguments);
  VICTORIOUS_CHECK(victorious::MadeFileOf(job).has_value() == victorious::MakesFile(kind));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::string_view kind = text.substr(0, text.find('\n'));
  const std::string_view json = text.substr(std::min(size, kind.size() + 1));
  CheckTask(kind, json);
  if (const auto known = victorious::FromText(victorious::kJobKindTexts, kind)) CheckJob(*known, json);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const auto task = victorious::ToQueue(
      {.video = "/v/a \"b\".mp4", .options = {"--models", "/m", "--every", "5"}, .program = "1-x"}, "content", {});
  VICTORIOUS_CHECK(task.has_value());
  return {
      "",
      "index\n",
      task->kind + "\n" + task->payload,
      "stitch\n{}",
      "index\n{\"video\": \"/v/a.mp4\", \"telemetry\": \"/t.csv\"}",
      "model\n{\"name\": \"jeep\", \"files\": [\"a.jpg\"], \"length_m\": 4.5, \"box\": [1, 2.5, 30, 40]}",
      "live\n{\"video\": \"udp://127.0.0.1:5000\", \"telemetry\": null}",
      "track\n{\"video\": \"/v/a.mp4\", \"at_s\": 1.5, \"box\": [1, 2.5, 30, 40], \"type\": \"van\", \"telemetry\": "
      "null, \"track\": \"/d/t.jsonl\"}",
      "copy\n{\"video\": \"-x.ts\", \"copy\": \"/d/c.mp4\"}",
      "clip\n{\"video\": \"v\", \"object\": 3, \"clip\": \"/d/c.mp4\", \"from_s\": 1.5, \"to_s\": 2, \"telemetry\": "
      "null}"};
}
