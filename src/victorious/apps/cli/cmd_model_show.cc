// victorious model list | show
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/cmd_model.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/median.h"
#include "victorious/base/one_line.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/lab/evaluate/detectability_report.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/view_sheet.h"

namespace victorious::cli {
namespace {

struct ListArguments {
  std::string folder;
  bool json = false;
};

struct ShowArguments {
  std::string folder;
  std::string name;
  std::string views;
  bool json = false;
  DetectabilityArguments findable;
};

nlohmann::ordered_json Summary(const ObjectModel& model) {
  return {{"name", model.name},
          {"id", model.id},
          {"kind", ToText(model.kind)},
          {"views", model.views.size()},
          {"features", model.features.size()},
          {"length_m", model.length_m ? nlohmann::ordered_json(*model.length_m) : nlohmann::ordered_json()},
          {"engine", model.engine},
          {"program_version", model.program_version}};
}

nlohmann::ordered_json Details(const ObjectModel& model) {
  nlohmann::ordered_json json = Summary(model);
  json["options"] = nlohmann::ordered_json::parse(model.options_json, nullptr, /*allow_exceptions=*/false);
  json["view_list"] = nlohmann::ordered_json::array();
  for (const ModelView& view : model.views) {
    const Box box = BoundingBox(view.outline);
    nlohmann::ordered_json row = {{"source", view.source},
                                  {"width_px", view.width},
                                  {"height_px", view.height},
                                  {"features", view.feature_count},
                                  {"outline_box", {box.x, box.y, box.width, box.height}}};
    row["azimuth_deg"] =
        view.angles ? nlohmann::ordered_json(DegreesFromRadians(view.angles->azimuth_rad)) : nlohmann::ordered_json();
    row["off_nadir_deg"] =
        view.angles ? nlohmann::ordered_json(DegreesFromRadians(view.angles->off_nadir_rad)) : nlohmann::ordered_json();
    json["view_list"].push_back(std::move(row));
  }
  return json;
}

std::string SizeText(const ObjectModel& model) {
  return model.length_m ? fmt::format("{:g} m", *model.length_m) : "unknown";
}

Status List(const ListArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectModel> models, ModelLibrary(arguments.folder).LoadAll());
  if (models.empty()) LogInfo("{}: no models: `victorious model add` makes one", OneLine(arguments.folder));
  std::string text;
  if (!arguments.json)
    text = fmt::format("{:<24} {:<7} {:>6} {:>9}  {:<9} {}\n", "name", "kind", "views", "features", "length", "engine");
  for (const ObjectModel& model : models) {
    text += arguments.json ? DumpJson(Summary(model)) + "\n"
                           : fmt::format("{:<24} {:<7} {:>6} {:>9}  {:<9} {}\n", model.name, ToText(model.kind),
                                         model.views.size(), model.features.size(), SizeText(model), model.engine);
  }
  return WriteOutput("", text);
}

// One line for each view; for more than 12 views, only statistics of their features.
std::string ViewsText(const ObjectModel& model) {
  constexpr std::size_t kMaxLines = 12;
  std::string text;
  if (model.views.size() > kMaxLines) {
    std::vector<double> counts;
    for (const ModelView& view : model.views) counts.push_back(static_cast<double>(view.feature_count));
    const auto [fewest, most] = std::ranges::minmax(counts);
    return fmt::format("  per view  {} to {} features, median {}; --json lists the views, --views FILE draws them\n",
                       fewest, most, Median(counts));
  }
  for (const ModelView& view : model.views) {
    const Box box = BoundingBox(view.outline);
    text += fmt::format("  view      {}: {} x {} px, object {:.0f} x {:.0f} px at {:.0f},{:.0f}, {} features\n",
                        view.source, view.width, view.height, box.width, box.height, box.x, box.y, view.feature_count);
  }
  return text;
}

Status Show(const ShowArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(
      parser, {{"--views", arguments.views, FileKind::kImage}, {"--draw", arguments.findable.draw, FileKind::kImage}}));
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectModel model, ModelLibrary(arguments.folder).Load(arguments.name));
  std::optional<Detectability> findable;
  if (arguments.findable.wanted) {
    VICTORIOUS_ASSIGN_OR_RETURN(findable, RunDetectabilityTest(model, arguments.findable));
  }
  if (!arguments.views.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat sheet, DrawViewSheet(model));
    VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments.views, sheet));
  }
  if (arguments.json) {
    nlohmann::ordered_json json = Details(model);
    if (findable) json["findable"] = ToJson(*findable);
    return WriteOutput("", DumpJson(json) + "\n");
  }
  if (findable) return WriteOutput("", model.name + "\n" + ToText(*findable));
  const std::string text = fmt::format(
      "{}\n  from      {}\n  length    {}\n  features  {} in {}\n  engine    {}, version {}\n  options   {}\n",
      model.name, ToText(model.kind), SizeText(model), model.features.size(), CountText(model.views.size(), "view"),
      model.engine, model.program_version, model.options_json);
  return WriteOutput("", text + ViewsText(model));
}

}  // namespace

std::string SummaryJson(const ObjectModel& model) { return DumpJson(Summary(model)) + "\n"; }

Action SetUpModelList(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ListArguments>();
  AddModelsFolder(parser, arguments->folder);
  parser.AddFlag("--json", arguments->json, "One JSON object per line");
  return [=] { return List(*arguments); };
}

Action SetUpModelShow(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ShowArguments>();
  AddModelsFolder(parser, arguments->folder);
  parser.Add("NAME", arguments->name).Required();
  parser.AddFlag("--json", arguments->json, "Print JSON");
  parser.Add("--views", arguments->views, "Draw all its views into this file (.png, .jpg)").TypeName("FILE");
  AddDetectabilityFlags(parser, arguments->findable);
  AddForce(parser);
  return [=] { return Show(*arguments, parser); };
}

}  // namespace victorious::cli
