// victorious params: lists every parameter, from the field lists of the options structs
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "victorious/calibrate/time_offset.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/geolocate/locate_options.h"
#include "victorious/model/cad_model.h"
#include "victorious/model/photo_model.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/pipeline/navigate_job.h"
#include "victorious/pipeline/track_job.h"
#include "victorious/recognize/category_images.h"

namespace victorious::cli {

Action SetUpParams(CLI::App& app) {
  struct Arguments {
    std::string of = "index";
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("WHOSE", arguments->of,
                 "Command or stage: index (search and match use its recognition part), model (from photos), cad (model "
                 "from a CAD file), features, telemetry, locate, track, navigate, category")
      ->check(
          CLI::IsMember({"index", "model", "cad", "features", "telemetry", "locate", "track", "navigate", "category"}));
  app.add_flag("--json", arguments->json, "Print the defaults as JSON, to be edited and given to --params");
  return [=]() -> Status {
    IndexOptions index;
    PhotoModelOptions model;
    CadModelOptions cad;
    FeatureOptions features;
    TimedTelemetryOptions telemetry;
    LocateOptions locate;
    TrackBoxesOptions track;
    NavigateVideoOptions navigate;
    CategoryTrainOptions category;
    const std::map<std::string, std::vector<FieldRef>> lists = {{"index", CollectFields(index)},
                                                                {"model", CollectFields(model)},
                                                                {"cad", CollectFields(cad)},
                                                                {"features", CollectFields(features)},
                                                                {"telemetry", CollectFields(telemetry)},
                                                                {"locate", CollectFields(locate)},
                                                                {"track", CollectFields(track)},
                                                                {"navigate", CollectFields(navigate)},
                                                                {"category", CollectFields(category)}};
    const std::vector<FieldRef>& fields = lists.at(arguments->of);
    return WriteOutput("", arguments->json ? ToJson(fields).dump(2) + "\n" : MarkdownTable(fields));
  };
}

}  // namespace victorious::cli
