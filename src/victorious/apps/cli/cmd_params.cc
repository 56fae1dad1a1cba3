// victorious params: lists every parameter, from the field lists of the options structs
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/json.h"
#include "victorious/category/finder/category_images.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/navigate/navigate_job.h"
#include "victorious/jobs/track/track_job.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/place/calibrate/time_offset.h"
#include "victorious/place/geolocate/locate_options.h"
#include "victorious/show/coverage_job.h"

namespace victorious::cli {

namespace {

// The default parameters of a command or stage.
template <typename Options>
std::vector<FieldRef> Defaults() {
  static Options options;
  return CollectFields(options);
}

struct ParameterList {
  const char* name;
  const char* what;  ///< beside the name in the help; empty if the name says it
  std::vector<FieldRef> (*fields)();
};

constexpr std::array kLists = {
    ParameterList{"index", "search and match use its recognition part", &Defaults<IndexOptions>},
    ParameterList{"model", "from photos", &Defaults<PhotoModelOptions>},
    ParameterList{"cad", "model from a CAD file", &Defaults<CadModelOptions>},
    ParameterList{"features", "", &Defaults<FeatureOptions>},
    ParameterList{"telemetry", "", &Defaults<TimedTelemetryOptions>},
    ParameterList{"locate", "", &Defaults<LocateOptions>},
    ParameterList{"track", "", &Defaults<TrackBoxesOptions>},
    ParameterList{"navigate", "", &Defaults<NavigateVideoOptions>},
    ParameterList{"coverage", "of export", &Defaults<CoverageOptions>},
    ParameterList{"category", "", &Defaults<CategoryTrainOptions>},
};

}  // namespace

Action SetUpParams(ArgumentParser& parser) {
  struct Arguments {
    std::string name = kLists.front().name;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  std::vector<std::string> names;
  std::string help;
  for (const ParameterList& list : kLists) {
    names.emplace_back(list.name);
    help += (help.empty() ? "" : ", ") + names.back() + (*list.what == 0 ? "" : fmt::format(" ({})", list.what));
  }
  parser.Add("WHOSE", arguments->name, "Command or stage: " + help).OneOf(names);
  parser.AddFlag("--json", arguments->json, "Print the defaults as JSON, to be edited and given to --params");
  return [=]() -> Status {
    const auto list =
        std::ranges::find_if(kLists, [&](const ParameterList& one) { return arguments->name == one.name; });
    const std::vector<FieldRef> fields = list->fields();
    return WriteOutput("", arguments->json ? DumpJson(ToJson(fields), 2) + "\n" : MarkdownTable(fields));
  };
}

}  // namespace victorious::cli
