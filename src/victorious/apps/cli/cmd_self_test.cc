// victorious self-test [--json]: whether this machine can do what the program does
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/sample_files.h"
#include "victorious/apps/cli/self_test.h"
#include "victorious/base/json.h"
#include "victorious/base/temporary_folder.h"

namespace victorious::cli {
namespace {

void PrintRow(const SelfTestRow& row) {
  const std::string line = fmt::format("{:<7} {:<12} {:>5.1f} s  {}\n", row.is_good ? "ok" : "FAILED", row.name,
                                       row.seconds, OneLine(row.text));
  static_cast<void>(WriteOutput("", line));
}

nlohmann::ordered_json ToJson(const std::vector<SelfTestRow>& rows) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const SelfTestRow& row : rows) {
    checks.push_back({{"check", row.name}, {"good", row.is_good}, {"seconds", row.seconds}, {"text", row.text}});
  }
  return {{"good", std::ranges::all_of(rows, &SelfTestRow::is_good)}, {"checks", std::move(checks)}};
}

Status Run(bool json) {
  const std::optional<SampleFiles> sample = FindSample();
  if (!sample) {
    return Fail(ErrorCode::kNotFound,
                "self-test: the sample (scenes, assets) is not beside the program: install the package victorious, or "
                "run the program of a build folder");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const TemporaryFolder> folder, TemporaryFolder::Make());
  const auto report = [&](const SelfTestRow& row) {
    if (!json) PrintRow(row);
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SelfTestRow> rows,
                              RunSelfTest(*sample, folder->path(), Interrupt(), report));
  if (json) VICTORIOUS_RETURN_IF_ERROR(WriteOutput("", DumpJson(ToJson(rows)) + "\n"));
  const auto failed = std::ranges::count(rows, false, &SelfTestRow::is_good);
  if (failed == 0) return {};
  return Fail(ErrorCode::kInternal, fmt::format("self-test: {} of {} checks failed", failed, rows.size()));
}

}  // namespace

Action SetUpSelfTest(ArgumentParser& parser) {
  const auto json = std::make_shared<bool>(false);
  parser.AddFlag("--json", *json, "Print one JSON object instead of a line for each check");
  return [=] { return Run(*json); };
}

}  // namespace victorious::cli
