// victorious category import | show | list
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/cmd_category.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/base/text.h"
#include "victorious/base/version.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/category/network/network_detector.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  std::string network;
  std::string weights;
  std::string classes;
  std::string out;
  std::string input;
  std::string layout;
  std::string fit;
  std::string channels;
  std::string resampling;
  std::optional<int> border;
  std::string mean;
  std::string deviation;
  std::optional<double> score;
  std::optional<double> overlap;
  std::string trained_on;
  bool json = false;
};

// "640x480", or "640" for both sides.
Expected<cv::Size> ParseInputSize(const std::string& text) {
  const std::size_t cross = text.find('x');
  const auto width = ParseInteger(text.substr(0, cross));
  const auto height = cross == std::string::npos ? width : ParseInteger(text.substr(cross + 1));
  const auto is_side = [](const std::optional<std::int64_t>& side) {
    return side && *side >= kMinInputSide_px && *side <= kMaxInputSide_px;
  };
  if (is_side(width) && is_side(height)) return cv::Size(static_cast<int>(*width), static_cast<int>(*height));
  return Fail(ErrorCode::kInvalidArgument, fmt::format("--input {}: must be WxH with sides of {} to {} px, as 640x480",
                                                       OneLine(text), kMinInputSide_px, kMaxInputSide_px));
}

// Three numbers, or one for all channels.
Expected<std::array<double, 3>> ParseChannels(const std::string& flag, const std::string& text) {
  const std::vector<std::string> cells = SplitRow(text);
  std::array<double, 3> values{};
  bool is_valid = cells.size() == 1 || cells.size() == values.size();
  for (std::size_t c = 0; is_valid && c < values.size(); ++c) {
    const auto value = ParseNumber(cells[cells.size() == 1 ? 0 : c]);
    is_valid = value.has_value();
    values[c] = value.value_or(0);
  }
  if (is_valid) return values;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} {}: must be a number, or three with commas", flag, OneLine(text)));
}

Expected<DetectorImport> ImportOf(const ImportArguments& arguments) {
  DetectorImport import;
  // The parser has checked the texts.
  if (!arguments.layout.empty()) import.layout = FromText(kDetectorLayoutTexts, arguments.layout);
  if (!arguments.fit.empty()) import.fit = FromText(kImageFitTexts, arguments.fit);
  if (!arguments.channels.empty()) import.channels = FromText(kChannelOrderTexts, arguments.channels);
  if (!arguments.resampling.empty()) import.resampling = FromText(kImageResamplingTexts, arguments.resampling);
  if (!arguments.input.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(import.input, ParseInputSize(arguments.input));
  }
  if (!arguments.mean.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(import.mean, ParseChannels("--mean", arguments.mean));
  }
  if (!arguments.deviation.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(import.deviation, ParseChannels("--deviation", arguments.deviation));
  }
  import.border = arguments.border;
  import.min_score = arguments.score;
  import.max_overlap = arguments.overlap;
  return import;
}

constexpr std::size_t kMaxTrainedOnBytes = 1000;

Expected<DetectorModel> ReadNetwork(const ImportArguments& arguments) {
  const bool is_description = LowerCase(fs::path(arguments.network).extension().string()) == ".cfg";
  if (is_description == arguments.weights.empty()) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: {}", OneLine(arguments.network),
                    is_description ? "a description of darknet (.cfg) needs --weights FILE"
                                   : "--weights is for a description of darknet (.cfg): an ONNX file has its own"));
  }
  if (arguments.trained_on.size() > kMaxTrainedOnBytes) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("--trained-on: must be at most {} bytes", kMaxTrainedOnBytes));
  }
  DetectorModel model{.program_version = kVersion,
                      .source = ReplaceInvalidUtf8(OneLine(fs::path(arguments.network).filename().string())),
                      .trained_on = ReplaceInvalidUtf8(OneLine(arguments.trained_on))};
  VICTORIOUS_ASSIGN_OR_RETURN(model.classes, ReadClassList(arguments.classes));
  VICTORIOUS_ASSIGN_OR_RETURN(model.files.network, ReadFile(arguments.network, kMaxNetworkBytes));
  if (!arguments.weights.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(model.files.weights, ReadFile(arguments.weights, kMaxNetworkBytes));
  }
  const bool is_empty = model.files.network.empty() || (is_description && model.files.weights.empty());
  if (is_empty) {
    return Fail(ErrorCode::kDataLoss, fmt::format("{}: an empty file, not a network", OneLine(arguments.network)));
  }
  return model;
}

nlohmann::ordered_json ToJson(const std::string& file, const DetectorModel& model) {
  DetectorSettings settings = model.settings;
  FieldList fields;
  settings.ListFields(fields);
  return {
      {"model", file},
      {"kind", "detector"},
      {"source", model.source},
      {"format", model.files.IsDarknet() ? "darknet" : "onnx"},
      {"trained_on", model.trained_on.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(model.trained_on)},
      {"categories", model.classes},
      {"network_bytes", model.files.network.size() + model.files.weights.size()},
      {"settings", victorious::ToJson(fields.fields())},
      {"program_version", model.program_version}};
}

nlohmann::ordered_json ToJson(const std::string& file, const CategoryModel& model) {
  nlohmann::ordered_json categories = nlohmann::ordered_json::array();
  for (const CategoryNode& node : model.nodes) {
    if (node.can_be_label) categories.push_back(node.name);
  }
  return {{"model", file},
          {"kind", "trained"},
          {"categories", std::move(categories)},
          {"words", model.vocabulary.size()},
          {"windows", model.windows.has_value()}};
}

nlohmann::ordered_json ToJson(const std::string& file, const ChannelModel& model) {
  nlohmann::ordered_json categories = nlohmann::ordered_json::array();
  for (const ChannelCategory& category : model.categories) categories.push_back(category.name);
  return {{"model", file},
          {"kind", "channels"},
          {"categories", std::move(categories)},
          {"images", model.images},
          {"boxes", model.boxes},
          {"min_object_px", model.min_object_px},
          {"program_version", model.program_version}};
}

nlohmann::ordered_json ToJson(const std::string& file, const CategorySourceModel& model) {
  return std::visit([&](const auto& one) { return ToJson(file, one); }, model);
}

std::string TrainedOnText(const DetectorModel& model) {
  return model.trained_on.empty() ? "not known: its results are good for images like those that it was trained on"
                                  : model.trained_on;
}

std::string Describe(const std::string& file, const DetectorModel& model) {
  const DetectorSettings& settings = model.settings;
  return fmt::format(
      "{}: a detector, imported from {}\n"
      "trained on: {}\n"
      "layout: {}; input {} x {} px, {}, {}, (v - {}) / {}\n"
      "sightings: score from {:g} on, overlap up to {:g}\n"
      "{} categories: {}\n",
      OneLine(file), model.source, TrainedOnText(model), ToText(kDetectorLayoutTexts, settings.layout), settings.width,
      settings.height, ToText(kChannelOrderTexts, settings.channels), ToText(kImageFitTexts, settings.fit),
      fmt::join(settings.mean, ","), fmt::join(settings.deviation, ","), settings.min_score, settings.max_overlap,
      model.classes.size(), fmt::join(model.classes, ", "));
}

std::string Describe(const std::string& file, const CategoryModel& model) {
  std::vector<std::string> categories;
  for (const CategoryNode& node : model.nodes) {
    if (node.can_be_label) categories.push_back(node.name);
  }
  return fmt::format("{}: trained from images, {} words, {}\n{} categories: {}\n", OneLine(file),
                     model.vocabulary.size(), model.windows ? "sliding windows" : "whole frames", categories.size(),
                     fmt::join(categories, ", "));
}

std::string Describe(const std::string& file, const ChannelModel& model) {
  std::vector<std::string> categories;
  for (const ChannelCategory& category : model.categories) categories.push_back(category.name);
  return fmt::format(
      "{}: a detector by channels, trained on {} boxes in {} images; objects of {:g} px or more\n{} "
      "categories: {}\n",
      OneLine(file), model.boxes, model.images, model.min_object_px, categories.size(), fmt::join(categories, ", "));
}

Status Import(const ImportArguments& arguments, const ArgumentParser& parser) {
  std::string out = arguments.out;
  if (out.empty()) out = fs::path(arguments.network).stem().string() + ".vcat";
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", out, FileKind::kCategoryModel}},
                                          {arguments.network, arguments.weights, arguments.classes}));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(out));
  VICTORIOUS_ASSIGN_OR_RETURN(const DetectorImport import, ImportOf(arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(DetectorModel model, ReadNetwork(arguments));
  Expected<DetectorModel> imported = ImportDetector(std::move(model), import);
  if (!imported) return std::unexpected(std::move(imported).error().WithContext(OneLine(arguments.network)));
  VICTORIOUS_RETURN_IF_ERROR(WriteDetector(out, *imported));
  return WriteOutput("", arguments.json ? DumpJson(ToJson(out, *imported)) + "\n" : Describe(out, *imported));
}

template <std::size_t count, typename Enum>
std::vector<std::string> ChoicesOf(const std::array<EnumText<Enum>, count>& texts) {
  std::vector<std::string> choices;
  for (const EnumText<Enum>& entry : texts) choices.emplace_back(entry.text);
  return choices;
}

}  // namespace

Action SetUpCategoryImport(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ImportArguments>();
  parser.Add("FILE", arguments->network, "The network: ONNX, or darknet's description (.cfg)").Required();
  parser.Add("--classes", arguments->classes, "Text file with the names of its classes, one a line, in its order")
      .Required()
      .TypeName("FILE");
  parser.Add("--weights", arguments->weights, "The weights of a .cfg").TypeName("FILE");
  parser
      .Add("--out", arguments->out,
           "The detector to write, for `index --categories`. Default: the network's name with .vcat, in this folder")
      .TypeName("FILE");
  parser
      .Add("--trained-on", arguments->trained_on,
           "What it was trained on, for `category show`: \"COCO, photos of people\"")
      .TypeName("TEXT");
  parser.Add("--input", arguments->input, "Size of its input. Default: what its file says").TypeName("WxH");
  parser
      .Add("--layout", arguments->layout,
           "What its outputs mean. Default: recognised from their shapes; v9 and v11 as v8")
      .OneOf(ChoicesOf(kDetectorLayoutTexts));
  parser
      .Add("--fit", arguments->fit,
           "How a frame is brought to the size of the input: each side by itself, with its aspect kept in the middle "
           "of a "
           "border, or at the top left of one. Default of this and of what follows: as the layout's authors train it")
      .OneOf(ChoicesOf(kImageFitTexts));
  parser.Add("--color", arguments->channels, "Order of the colours").OneOf(ChoicesOf(kChannelOrderTexts));
  parser.Add("--resampling", arguments->resampling, "Interpolation of the frame")
      .OneOf(ChoicesOf(kImageResamplingTexts));
  parser.Add("--border", arguments->border, "Grey level of the border, 0 to 255").TypeName("N");
  parser.Add("--mean", arguments->mean, "Subtracted from the pixels of 0 to 255: a number, or one a channel")
      .TypeName("A[,B,C]");
  parser.Add("--deviation", arguments->deviation, "By which they are then divided").TypeName("A[,B,C]");
  parser.Add("--score", arguments->score, "Minimum score of a sighting, 0 to 1").TypeName("S");
  parser
      .Add("--overlap", arguments->overlap,
           "Intersection over union of two sightings of a class from which on the less likely one is left out")
      .TypeName("F");
  parser.AddFlag("--json", arguments->json, "Print the detector as one JSON object");
  AddForce(parser);
  return [=] { return Import(*arguments, parser); };
}

Action SetUpCategoryShow(ArgumentParser& parser) {
  struct Arguments {
    std::string model;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  parser.Add("FILE", arguments->model, "A category model or an imported detector").Required();
  parser.AddFlag("--json", arguments->json, "Print one JSON object");
  return [=]() -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const CategorySourceModel model, ReadCategorySource(arguments->model));
    if (arguments->json) return WriteOutput("", DumpJson(ToJson(arguments->model, model)) + "\n");
    return WriteOutput("", std::visit([&](const auto& one) { return Describe(arguments->model, one); }, model));
  };
}

Action SetUpCategoryList(ArgumentParser& parser) {
  struct Arguments {
    std::string folder;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  parser.Add("DIR", arguments->folder, "Folder with category models and imported detectors").Required();
  parser.AddFlag("--json", arguments->json, "Print one JSON object a line");
  return [=]() -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<fs::path> files, ListFolder(arguments->folder));
    std::string text;
    for (const fs::path& file : files) {
      if (file.extension() != ".vcat") continue;
      const Expected<CategorySourceModel> model = ReadCategorySource(file);
      if (!model) {
        LogWarning("left out: {}", OneLine(model.error().message));
        continue;
      }
      const nlohmann::ordered_json json = ToJson(file.string(), *model);
      if (arguments->json) {
        text += DumpJson(json) + "\n";
        continue;
      }
      constexpr std::size_t kShownCategories = 5;
      std::vector<std::string> names = json["categories"].get<std::vector<std::string>>();
      const bool is_short = names.size() <= kShownCategories;
      const std::size_t count = names.size();
      names.resize(std::min(names.size(), kShownCategories));
      const auto* detector = std::get_if<DetectorModel>(&*model);
      text += fmt::format("{}: {}; {} categories: {}{}{}\n", OneLine(file.string()), json["kind"].get<std::string>(),
                          count, fmt::join(names, ", "), is_short ? "" : ", …",
                          detector == nullptr ? "" : "; trained on: " + TrainedOnText(*detector));
    }
    return WriteOutput("", text);
  };
}

}  // namespace victorious::cli
