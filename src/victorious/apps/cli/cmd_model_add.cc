// victorious model add: makes a model from a CAD file or from photos
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/cmd_model.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/count_text.h"
#include "victorious/base/log.h"
#include "victorious/base/median.h"
#include "victorious/base/progress.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/video/image_sequence_reader.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/photo_model.h"

namespace victorious::cli {
namespace {

struct ModelAddArguments {
  std::string folder;
  std::string name;
  std::vector<std::string> inputs;
  std::vector<std::string> boxes;
  std::optional<double> length_m;
  std::optional<double> step_deg;
  std::optional<double> max_off_nadir_deg;
  std::string layout;
  std::string up;
  std::string front;
  std::string params;
  std::string draw;
  bool json = false;
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
  cv::Mat image;
  cv::vconcat(rows, image);
  return image;
}

// Without a cut-out, the background would be learned as part of the object.
void LogUncroppedPhotos(const std::vector<Photo>& photos) {
  for (const Photo& photo : photos) {
    if (!photo.mask.empty() && cv::countNonZero(photo.mask) < static_cast<int>(photo.mask.total())) continue;
    LogInfo("{}: the whole photo is used as the object; cut it out by --box X,Y,W,H or an alpha channel",
            OneLine(photo.source));
  }
}

Expected<ObjectModel> FromPhotos(const ModelAddArguments& arguments) {
  if (arguments.step_deg || arguments.max_off_nadir_deg || !arguments.layout.empty() || !arguments.up.empty() ||
      !arguments.front.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: not a CAD file ({}): --step, --max-off-nadir, --layout, --up and --front apply to "
                            "those, not to photos",
                            arguments.inputs.front(), kCadExtensions));
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
    Expected<Photo> photo = LoadPhoto(arguments.inputs[i], box);
    if (!photo && photo.error().code == ErrorCode::kDataLoss && !IsImageFile(arguments.inputs[i])) {
      return Fail(ErrorCode::kUnsupported,
                  fmt::format("{}, nor a CAD file ({})", photo.error().message, kCadExtensions));
    }
    if (!photo) return std::unexpected(std::move(photo).error());
    photos.push_back(*std::move(photo));
  }
  Expected<ObjectModel> model = MakePhotoModel(arguments.name, photos, arguments.length_m, options);
  if (model && !arguments.draw.empty()) VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments.draw, DrawCutOuts(photos)));
  if (model && arguments.boxes.empty()) LogUncroppedPhotos(photos);
  return model;
}

// Doubts a length that nothing has which one searches for: files without a unit are often in millimetres.
void DoubtLength(const std::string& input, double length_m) {
  constexpr double kLongest_m = 450;  // a ship
  constexpr double kShortest_m = 0.3;
  if (length_m > kLongest_m) {
    const char* unit = length_m > 100 * kLongest_m || length_m >= 1000 ? "millimetres" : "centimetres, or inches";
    LogWarning("{}: {:.4g} m long: is the file in {}? give --length", OneLine(input), length_m, unit);
  } else if (length_m < kShortest_m) {
    LogWarning("{}: {:.2g} m long: is the file in another unit than metres? give --length", OneLine(input), length_m);
  }
}

Expected<ObjectModel> FromCad(const ModelAddArguments& arguments) {
  const std::string& input = arguments.inputs.front();
  if (!arguments.boxes.empty() || !arguments.draw.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--box and --draw apply to photos, not to CAD files");
  }
  CadModelOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.step_deg) options.sphere.step_deg = *arguments.step_deg;
  if (arguments.max_off_nadir_deg) options.sphere.max_off_nadir_deg = *arguments.max_off_nadir_deg;
  if (!arguments.layout.empty()) options.sphere.layout = FromText(kViewLayoutTexts, arguments.layout).value();
  VICTORIOUS_RETURN_IF_ERROR(
      CheckFlags(CollectFields(options), {{"sphere.step", "--step"}, {"sphere.max_off_nadir", "--max-off-nadir"}}));
  LoadMeshOptions load{.up = {}, .front = {}, .length_m = arguments.length_m, .cancel = &Interrupt()};
  if (!arguments.up.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(load.up, ParseAxis(arguments.up));
  }
  if (!arguments.front.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(load.front, ParseAxis(arguments.front));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const LoadedMesh loaded, LoadMesh(input, load));
  for (const std::string& warning : loaded.warnings) LogWarning(OneLine(fmt::format("{}: {}", input, warning)));
  if (!arguments.length_m) DoubtLength(input, loaded.length_m);
  std::optional<Progress> progress;
  const auto show = [&](int done, int all) {
    if (!progress) progress.emplace(arguments.name, all, "views");
    progress->Update(done);
  };
  Expected<ObjectModel> model = MakeCadModel(arguments.name, loaded.mesh, input, options, show, &Interrupt());
  if (model) model->length_m = loaded.length_m;
  return model;
}

// What the features of a model promise: in a few words, which stand behind their number, and as a message that gives
// the remedy unless they promise much. The limits are rounded from `model show --findable` on photos of few and of many
// features (docs/results/recognition.md).
std::string DescribePromise(const ObjectModel& model) {
  constexpr double kMinFeatures = 40;
  constexpr double kManyFeatures = 120;
  std::vector<double> counts;
  for (const ModelView& view : model.views) counts.push_back(static_cast<double>(view.feature_count));
  const bool cad = model.kind == ModelKind::kCad;
  const double typical = cad ? Median(counts) : std::ranges::max(counts);
  if (typical >= kManyFeatures) return "well recognisable";
  const std::string what = fmt::format("{:.0f} features in {}", typical, cad ? "its median view" : "its best photo");
  const std::string measure =
      fmt::format("`victorious model show {} --findable` measures from which size it is found", OneLine(model.name));
  if (typical < kMinFeatures) {
    LogWarning("{}: {}: hardly recognisable: use {}; {}", OneLine(model.name), what,
               cad ? "a model with more texture, or more pixels_per_m (--params)"
                   : "a larger and sharper photo of a textured side",
               measure);
    return "hardly recognisable";
  }
  LogInfo("{}: {}: recognisable when large and seen as in the {}; {}", OneLine(model.name), what,
          cad ? "views" : "photo", measure);
  return "recognisable when large";
}

Status Add(const ModelAddArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--draw", arguments.draw, FileKind::kImage}}));
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
  const std::string promise = DescribePromise(model);
  if (arguments.json) return WriteOutput("", SummaryJson(model));
  const std::string length = cad && model.length_m ? fmt::format("{:.4g} m long, ", *model.length_m) : "";
  return WriteOutput("", fmt::format("{}: {}{}, {}: {}\n", model.name, length, CountText(model.views.size(), "view"),
                                     CountText(model.features.size(), "feature"), promise));
}

}  // namespace

Action SetUpModelAdd(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ModelAddArguments>();
  AddModelsFolder(parser, arguments->folder);
  parser.Add("NAME", arguments->name, "Name of the object").Required();
  parser
      .Add("INPUT", arguments->inputs,
           "One CAD file (glTF, GLB, OBJ, AC3D, COLLADA, 3DS, PLY, STL), or photos (PNG, JPEG) with an alpha "
           "channel or --box")
      .Required();
  parser
      .Add("--box", arguments->boxes, "The object in the photo, x,y,w,h in pixels; one for each photo, in their order")
      .TypeName("X,Y,W,H")
      .OneValueEach();
  parser
      .Add("--length", arguments->length_m,
           "Length of the object in metres: its longest side; for glTF its extent along the front axis (+Z). "
           "Without it, CAD units are metres and photos have no size")
      .TypeName("M");
  parser.Add("--step", arguments->step_deg, "CAD: degrees between views (default 10)").TypeName("DEG");
  parser
      .Add("--max-off-nadir", arguments->max_off_nadir_deg,
           "CAD: largest off-nadir angle of the views, degrees (default 70)")
      .TypeName("DEG");
  parser
      .Add("--layout", arguments->layout,
           "CAD: views on a grid of azimuth and off-nadir angle (default), or equally dense in all directions: fewer")
      .OneOf(kViewLayoutTexts);
  parser.Add("--up", arguments->up, "CAD: the file's axis that points up, as in +y (default: by format)")
      .TypeName("AXIS");
  parser.Add("--front", arguments->front, "CAD: the file's axis that points to the front (default: by format)")
      .TypeName("AXIS");
  parser.Add("--draw", arguments->draw, "Draw the photos with the object outlines into this file").TypeName("FILE");
  parser.AddFlag("--json", arguments->json, "Print the model as JSON, as `model list --json` does");
  AddParams(parser, arguments->params, "model|cad");
  AddForce(parser);
  return [=] { return Add(*arguments, parser); };
}

}  // namespace victorious::cli
