// victorious model add | list | show | remove
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <spdlog/spdlog.h>

#include "victorious/base/median.h"
#include "victorious/base/progress.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/evaluate/findable.h"
#include "victorious/geometry/angles.h"
#include "victorious/image/image_file.h"
#include "victorious/image/montage.h"
#include "victorious/mesh/load_mesh.h"
#include "victorious/model/cad_model.h"
#include "victorious/model/model_library.h"
#include "victorious/model/photo_model.h"
#include "victorious/model/view_sheet.h"
#include "victorious/pipeline/index_options.h"

namespace victorious::cli {
namespace {

// The flags of `model show --findable`.
struct DetectabilityArguments {
  bool wanted = false;
  DetectabilityOptions options;
  std::string sun = "off";
  bool no_attitude = false;
  std::string draw;
  std::string params;
};

struct Arguments {
  std::string folder;
  std::string name;
  std::vector<std::string> inputs;
  std::vector<std::string> boxes;
  std::optional<double> length_m;
  std::optional<double> step_deg;
  std::optional<double> max_off_nadir_deg;
  std::string up;
  std::string front;
  std::string params;
  std::string draw;
  std::string views;
  bool json = false;
  DetectabilityArguments findable;
};

// Draws the photos, with the outline of the object in each, one below the other.
cv::Mat DrawCutOuts(const std::vector<Photo>& photos) {
  std::vector<cv::Mat> rows;
  int width = 0;
  for (const Photo& photo : photos) width = std::max(width, photo.grey.cols);
  for (const Photo& photo : photos) {
    cv::Mat row(photo.grey.rows, width, CV_8UC3, cv::Scalar::all(32));
    cv::cvtColor(photo.grey, row.colRange(0, photo.grey.cols), cv::COLOR_GRAY2BGR);
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& corner : photo.outline) corners.emplace_back(cv::Point2d(corner.x(), corner.y()));
    cv::polylines(row, corners, true, {0, 255, 255}, 2, cv::LINE_AA);
    rows.push_back(std::move(row));
  }
  cv::Mat picture;
  cv::vconcat(rows, picture);
  return picture;
}

// Without a cut-out, the background would be learned as part of the object.
void LogUncroppedPhotos(const std::vector<Photo>& photos) {
  for (const Photo& photo : photos) {
    if (!photo.mask.empty() && cv::countNonZero(photo.mask) < static_cast<int>(photo.mask.total())) continue;
    spdlog::info("{}: the whole photo is used as the object; cut it out by --box X,Y,W,H or an alpha channel",
                 OneLine(photo.source));
  }
}

Expected<ObjectModel> FromPhotos(const Arguments& arguments) {
  if (arguments.step_deg || arguments.max_off_nadir_deg || !arguments.up.empty() || !arguments.front.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--step, --max-off-nadir, --up and --front apply to CAD files, not to photos");
  }
  if (!arguments.boxes.empty() && arguments.boxes.size() != arguments.inputs.size()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} boxes for {} photos: give one --box for each photo, in their order, or none",
                            arguments.boxes.size(), arguments.inputs.size()));
  }
  PhotoModelOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  std::vector<Photo> photos;
  for (std::size_t i = 0; i < arguments.inputs.size(); ++i) {
    std::optional<Box> box;
    if (!arguments.boxes.empty()) {
      VICTORIOUS_ASSIGN_OR_RETURN(box, ParseBox(arguments.boxes[i]));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(Photo photo, LoadPhoto(arguments.inputs[i], box));
    photos.push_back(std::move(photo));
  }
  Expected<ObjectModel> model = MakePhotoModel(arguments.name, photos, arguments.length_m, options);
  if (model && !arguments.draw.empty()) VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments.draw, DrawCutOuts(photos)));
  if (model && arguments.boxes.empty()) LogUncroppedPhotos(photos);
  return model;
}

Expected<ObjectModel> FromCad(const Arguments& arguments) {
  const std::string& input = arguments.inputs.front();
  if (!arguments.boxes.empty() || !arguments.draw.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--box and --draw apply to photos, not to CAD files");
  }
  CadModelOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.step_deg) options.sphere.step_deg = *arguments.step_deg;
  if (arguments.max_off_nadir_deg) options.sphere.max_off_nadir_deg = *arguments.max_off_nadir_deg;
  VICTORIOUS_RETURN_IF_ERROR(
      CheckFlags(CollectFields(options), {{"sphere.step", "--step"}, {"sphere.max_off_nadir", "--max-off-nadir"}}));
  LoadMeshOptions load{.up = {}, .front = {}, .length_m = arguments.length_m};
  if (!arguments.up.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(load.up, ParseAxis(arguments.up));
  }
  if (!arguments.front.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(load.front, ParseAxis(arguments.front));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(input, load));
  for (const std::string& warning : loaded.warnings) spdlog::warn("{}", OneLine(fmt::format("{}: {}", input, warning)));
  std::optional<Progress> progress;
  const auto show = [&](int done, int all) {
    if (!progress) progress.emplace(arguments.name, all, "views");
    progress->Update(done);
  };
  Expected<ObjectModel> model = MakeCadModel(arguments.name, loaded.mesh, input, options, show);
  if (model) model->length_m = loaded.length_m;
  return model;
}

Status Add(const Arguments& arguments) {
  const ModelLibrary library(arguments.folder);
  VICTORIOUS_RETURN_IF_ERROR(library.CheckNewName(arguments.name));
  if (arguments.length_m && !(*arguments.length_m > 0 && *arguments.length_m < 1e6)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--length {:g}: must be the object's length in metres, above 0", *arguments.length_m));
  }
  const bool cad = std::ranges::any_of(arguments.inputs, IsCadFile);
  if (cad && arguments.inputs.size() > 1) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("model {}: give one CAD file, or photos", arguments.name));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectModel model, cad ? FromCad(arguments) : FromPhotos(arguments));
  VICTORIOUS_RETURN_IF_ERROR(library.Add(model));
  return WriteOutput("", fmt::format("{}: {} {}, {} features\n", model.name, model.views.size(),
                                     model.views.size() == 1 ? "view" : "views", model.features.size()));
}

nlohmann::ordered_json Summary(const ObjectModel& model) {
  return {{"name", model.name},
          {"id", model.id},
          {"kind", ToText(kModelKindTexts, model.kind)},
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

Status List(const Arguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectModel> models, ModelLibrary(arguments.folder).LoadAll());
  std::string text;
  if (!arguments.json)
    text = fmt::format("{:<24} {:<7} {:>6} {:>9}  {:<9} {}\n", "name", "kind", "views", "features", "length", "engine");
  for (const ObjectModel& model : models) {
    text += arguments.json
                ? Summary(model).dump() + "\n"
                : fmt::format("{:<24} {:<7} {:>6} {:>9}  {:<9} {}\n", model.name, ToText(kModelKindTexts, model.kind),
                              model.views.size(), model.features.size(), SizeText(model), model.engine);
  }
  return WriteOutput("", text);
}

// Measures the recall of the same search that `index` runs.
Expected<Detectability> RunDetectabilityTest(const ObjectModel& model, const DetectabilityArguments& arguments) {
  IndexOptions search;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, search));
  DetectabilityOptions options = arguments.options;
  options.attitude_known = !arguments.no_attitude;
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(
      CollectFields(options), {{"size_px", "--size-px"}, {"noise", "--noise"}, {"directions", "--directions"}}));
  if (arguments.sun != "off") {
    double elevation_deg = 0;
    if (!CLI::detail::lexical_cast(arguments.sun, elevation_deg)) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--sun {}: must be an elevation of 5 to 90 degrees, or off", OneLine(arguments.sun)));
    }
    options.sun_deg = elevation_deg;
  }
  std::optional<Progress> progress;
  std::vector<cv::Mat> pictures;
  DetectabilityCallbacks callbacks;
  callbacks.progress = [&](int done, int /*all*/) {
    if (!progress) progress.emplace(model.name, std::nullopt, "directions");
    progress->Update(done);
  };
  if (!arguments.draw.empty()) {
    callbacks.picture = [&](const cv::Mat& bgr) {
      constexpr std::size_t kMaxPictures = 24;
      if (pictures.size() < kMaxPictures) pictures.push_back(bgr);
    };
  }
  Expected<Detectability> found =
      MeasureDetectability(model, search.features, search.recognize, options, Interrupt(), callbacks);
  if (found && !pictures.empty()) VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments.draw, Montage(pictures, 4)));
  return found;
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

Status Show(const Arguments& arguments) {
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
    return WriteOutput("", json.dump() + "\n");
  }
  if (findable) return WriteOutput("", model.name + "\n" + ToText(*findable));
  std::string text = fmt::format(
      "{}\n  from      {}\n  length    {}\n  features  {} in {} views\n  engine    {}, version {}\n  options   {}\n",
      model.name, ToText(kModelKindTexts, model.kind), SizeText(model), model.features.size(), model.views.size(),
      model.engine, model.program_version, model.options_json);
  return WriteOutput("", text + ViewsText(model));
}

void AddDetectabilityFlags(CLI::App& show, DetectabilityArguments& findable) {
  CLI::Option* wanted =
      show.add_flag("--findable", findable.wanted,
                    "Measure the fraction of rendered test images in which the search finds the model");
  const auto add = [&](CLI::Option* option) {
    option->needs(wanted);
    return option;
  };
  add(show.add_option("--size-px", findable.options.size_px, "Longest side of its box in the image (default 64)"))
      ->type_name("PX");
  add(show.add_option("--noise", findable.options.noise, "Fraction of salt-and-pepper pixels (default 0)"))
      ->type_name("SHARE");
  add(show.add_option("--sun", findable.sun, "Elevation of the sun in degrees, or off: diffuse light (default)"))
      ->type_name("DEG");
  add(show.add_flag("--no-attitude", findable.no_attitude,
                    "Search without the camera's attitude, as without telemetry"));
  add(show.add_option(
          "--directions", findable.options.directions,
          "Number of view directions: more take longer and estimate fractions more accurately (default 24)"))
      ->type_name("N");
  add(show.add_option("--seed", findable.options.seed, "Seed of the random numbers (default 1)"))->type_name("N");
  add(show.add_option("--draw", findable.draw, "Draw the test images into this file: found green, missed red"))
      ->type_name("FILE");
  add(show.add_option("--params", findable.params, "Parameters of the search, as for `index` (JSON)"))
      ->type_name("FILE");
}

}  // namespace

Action SetUpModel(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.require_subcommand(1);
  const auto add_subcommand = [&](const char* name, const char* summary) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->add_option("--models", arguments->folder, "Folder of models")->required()->type_name("DIR");
    return command;
  };
  CLI::App* add = add_subcommand("add", "Make a searchable model from a CAD file or from photos");
  add->add_option("NAME", arguments->name, "Name of the object")->required();
  add->add_option("INPUT", arguments->inputs,
                  "One CAD file (glTF, GLB, OBJ, AC3D, COLLADA, 3DS, PLY, STL), or photos (PNG, JPEG) with an alpha "
                  "channel or --box")
      ->required();
  add->add_option("--box", arguments->boxes,
                  "The object in the photo, x,y,w,h in pixels; one for each photo, in their order")
      ->type_name("X,Y,W,H")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);  // the word after a box is not another box
  add->add_option("--length", arguments->length_m,
                  "Length of the object in metres: its longest side; for glTF its extent along the front axis (+Z). "
                  "Without it, CAD units are metres and photos have no size")
      ->type_name("M");
  add->add_option("--step", arguments->step_deg, "CAD: degrees between views (default 10)")->type_name("DEG");
  add->add_option("--max-off-nadir", arguments->max_off_nadir_deg,
                  "CAD: largest off-nadir angle of the views, degrees (default 70)")
      ->type_name("DEG");
  add->add_option("--up", arguments->up, "CAD: the file's axis that points up, as in +y (default: by format)")
      ->type_name("AXIS");
  add->add_option("--front", arguments->front, "CAD: the file's axis that points to the front (default: by format)")
      ->type_name("AXIS");
  add->add_option("--draw", arguments->draw, "Draw the photos with the object outlines into this file")
      ->type_name("FILE");
  AddParams(*add, arguments->params, "model|cad");
  CLI::App* list = add_subcommand("list", "List the models of a folder");
  list->add_flag("--json", arguments->json, "One JSON object per line");
  CLI::App* show = add_subcommand("show", "Show one model's views, features, size and origin");
  show->add_option("NAME", arguments->name)->required();
  show->add_flag("--json", arguments->json, "Print JSON");
  show->add_option("--views", arguments->views, "Draw all its views into this file (.png, .jpg)")->type_name("FILE");
  AddDetectabilityFlags(*show, arguments->findable);
  CLI::App* remove = add_subcommand("remove", "Delete a model");
  remove->add_option("NAME", arguments->name)->required();
  remove->add_flag("--json", arguments->json, "Print the removed model as JSON");
  return [=]() -> Status {
    if (add->parsed()) return Add(*arguments);
    if (list->parsed()) return List(*arguments);
    if (show->parsed()) return Show(*arguments);
    VICTORIOUS_RETURN_IF_ERROR(ModelLibrary(arguments->folder).Remove(arguments->name));
    if (!arguments->json) return {};
    return WriteOutput("", nlohmann::json({{"removed", arguments->name}}).dump() + "\n");
  };
}

}  // namespace victorious::cli
