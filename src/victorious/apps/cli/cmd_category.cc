// victorious category train | classify | refine; the others are in cmd_category_import.cc
#include "victorious/apps/cli/cmd_category.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/progress.h"
#include "victorious/category/category_file.h"
#include "victorious/category/channels/channel_file.h"
#include "victorious/category/explanation.h"
#include "victorious/category/finder/category_finder.h"
#include "victorious/category/finder/category_images.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/category/finder/channel_source.h"
#include "victorious/category/finder/review_marks.h"
#include "victorious/category/refine.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

// What `category train` trains.
enum class TrainMethod {
  kAuto,        // channels if an image of the list has several boxes, and windows are not asked for
  kClassifier,  // of whole images or windows
  kChannels,    // a detector by channels
};

constexpr auto kTrainMethodTexts = std::to_array<EnumText<TrainMethod>>(
    {{TrainMethod::kAuto, "auto"}, {TrainMethod::kClassifier, "classifier"}, {TrainMethod::kChannels, "channels"}});

struct CategoryArguments {
  std::string images;
  std::string list;
  std::string out;
  std::string params;
  std::optional<std::uint64_t> seed;
  std::string model;
  std::string trainer = std::string(ToText(kTrainMethodTexts, TrainMethod::kAuto));
  std::string method = std::string(ToText(kCategoryMethodTexts, CategoryMethod::kPhrases));
  std::string explain;
  std::string db;
  std::vector<std::string> files_below;
  bool json = false;
};

// Warns if the model has no background class: an image of none of the categories would still get one of their labels.
Status WarnWithoutBackground(const CategoryModel& model) {
  const CategoryFindOptions defaults;
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryFinder finder, CategoryFinder::Create(model, defaults));
  const auto labels = static_cast<std::size_t>(std::ranges::count(model.nodes, true, &CategoryNode::can_be_label));
  if (finder.names().size() < labels) return {};
  LogWarning(
      "no background category: every image is labelled as one of the categories, whatever it shows; add images of "
      "other objects, listed as {}, to the training list",
      defaults.background);
  return {};
}

// Error: kUnsupported for a detector.
Expected<CategoryModel> ReadTrainedModel(const std::string& file) {
  VICTORIOUS_ASSIGN_OR_RETURN(CategorySourceModel model, ReadCategorySource(file));
  if (auto* trained = std::get_if<CategoryModel>(&model)) return std::move(*trained);
  return Fail(ErrorCode::kUnsupported,
              fmt::format("{}: a detector: it is for `index`; only classifiers of `category train` classify whole "
                          "images and are refined",
                          file));
}

// The images of the list, which the command reads.
std::vector<std::string> ListImages(const CategoryArguments& arguments, const std::vector<CategoryListRow>& rows) {
  std::vector<std::string> images;
  for (const CategoryListRow& row : rows) {
    images.push_back((std::filesystem::path(arguments.images) / row.image).string());
  }
  return images;
}

// Prefixes the error with the list's name, unless it already names a line of the list.
Error WithListContext(Error error, const std::string& list) {
  if (error.message.starts_with(list + " line ")) return error;
  return std::move(error).WithContext(list);
}

std::string ToLine(const nlohmann::ordered_json& json) { return DumpJson(json) + "\n"; }

Status TrainChannels(const CategoryArguments& arguments, const CategoryTrainOptions& options,
                     std::span<const CategoryListRow> rows) {
  std::optional<Progress> progress(std::in_place, arguments.list, std::ssize(rows), "boxes");
  Expected<ChannelModel> model =
      TrainChannelsOnList(arguments.images, rows, options.channels, options.category.seed,
                          [&](std::size_t done) { progress->Update(static_cast<std::int64_t>(done)); });
  progress.reset();
  if (!model) return std::unexpected(WithListContext(std::move(model).error(), arguments.list));
  VICTORIOUS_RETURN_IF_ERROR(WriteChannelModel(arguments.out, *model));
  if (arguments.json) {
    nlohmann::ordered_json categories = nlohmann::ordered_json::array();
    for (const ChannelCategory& category : model->categories) categories.push_back(category.name);
    return WriteOutput("", ToLine({{"model", arguments.out},
                                   {"method", "channels"},
                                   {"categories", std::move(categories)},
                                   {"images", model->images},
                                   {"boxes", model->boxes}}));
  }
  return WriteOutput("", fmt::format("{}: a detector of {} categories, from {} boxes in {} images\n", arguments.out,
                                     model->categories.size(), model->boxes, model->images));
}

Status Train(const CategoryArguments& arguments, const ArgumentParser& parser) {
  CategoryTrainOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.seed) options.category.seed = *arguments.seed;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCategoryList(arguments.list));
  VICTORIOUS_RETURN_IF_ERROR(
      CheckOutputs(parser, {{"--out", arguments.out, FileKind::kCategoryModel}}, ListImages(arguments, rows)));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  const TrainMethod method = FromText(kTrainMethodTexts, arguments.trainer).value();  // checked by the parser
  const bool is_automatic = method == TrainMethod::kAuto && !options.features.windows.enabled;
  if (method == TrainMethod::kChannels || (is_automatic && HasSeveralBoxesAnImage(rows))) {
    return TrainChannels(arguments, options, rows);
  }
  std::optional<Progress> progress(std::in_place, arguments.list, static_cast<std::int64_t>(rows.size()), "images");
  Expected<CategoryModel> model = TrainOnList(
      arguments.images, rows, options, [&](std::size_t done) { progress->Update(static_cast<std::int64_t>(done)); },
      [](const std::string& warning) { LogWarning(OneLine(warning)); });
  progress.reset();
  if (!model) return std::unexpected(WithListContext(std::move(model).error(), arguments.list));
  VICTORIOUS_RETURN_IF_ERROR(WriteCategoryModel(arguments.out, *model));
  VICTORIOUS_RETURN_IF_ERROR(WarnWithoutBackground(*model));
  const auto labels = std::ranges::count(model->nodes, true, &CategoryNode::can_be_label);
  const auto cad_files = std::ranges::count_if(rows, [](const CategoryListRow& row) { return IsCadFile(row.image); });
  if (arguments.json) {
    nlohmann::ordered_json categories = nlohmann::ordered_json::array();
    for (const CategoryNode& node : model->nodes) {
      if (node.can_be_label) categories.push_back(node.name);
    }
    return WriteOutput("", ToLine({{"model", arguments.out},
                                   {"categories", std::move(categories)},
                                   {"words", model->vocabulary.size()},
                                   {"images", std::ssize(rows) - cad_files},
                                   {"cad_files", cad_files}}));
  }
  const std::string cad = cad_files == 0 ? "" : fmt::format(" and {} CAD file{}", cad_files, cad_files == 1 ? "" : "s");
  return WriteOutput("", fmt::format("{}: {} categories, {} words, from {} images{}\n", arguments.out, labels,
                                     model->vocabulary.size(), std::ssize(rows) - cad_files, cad));
}

std::string FormatResult(const std::string& image, const CategoryModel& model, const CategoryResult& result,
                         bool json) {
  if (!json) {
    return fmt::format("{}: {} {:.3f}\n", OneLine(image), model.nodes[result.label].name,
                       result.scores[result.label].probability);
  }
  nlohmann::ordered_json scores = nlohmann::ordered_json::object();
  for (std::size_t n = 0; n < model.nodes.size(); ++n) scores[model.nodes[n].name] = result.scores[n].probability;
  const nlohmann::ordered_json line = {
      {"image", image}, {"label", model.nodes[result.label].name}, {"scores", std::move(scores)}};
  return ToLine(line);
}

// The output file of --explain for one image: FILE itself for the first image, FILE-2.png and so on for the others.
std::string ExplanationPath(const std::string& file, std::size_t row) {
  if (row == 0) return file;
  const std::filesystem::path path(file);
  return (path.parent_path() / fmt::format("{}-{}{}", path.stem().string(), row + 1, path.extension().string()))
      .string();
}

Status Explain(const std::string& file, const cv::Mat& bgr, const CategoryModel& model,
               const ClassifiedImage& classified) {
  const CategoryResult& result = classified.result;
  const Box& part = classified.classified_box;
  cv::Mat region = bgr(cv::Rect(cv::Rect2d(part.x, part.y, part.width, part.height)) & cv::Rect({0, 0}, bgr.size()));
  if (region.size() != cv::Size(classified.image.width, classified.image.height))
    cv::resize(region, region, {classified.image.width, classified.image.height}, 0, 0, cv::INTER_AREA);
  const std::string caption =
      fmt::format("{} {:.3f}", model.nodes[result.label].name, result.scores[result.label].probability);
  return WriteImage(file, DrawContributions(region, classified.image,
                                            ComputeContributions(model, classified.image, result.label), caption));
}

Status Classify(const CategoryArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryModel model, ReadTrainedModel(arguments.model));
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryFeaturizer featurizer, CategoryFeaturizer::Of(model));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<CategoryListRow> rows, ReadCategoryList(arguments.list));
  const CategoryMethod method = FromText(kCategoryMethodTexts, arguments.method).value();  // checked by the parser
  if (!arguments.explain.empty() && method == CategoryMethod::kWords)
    return Fail(ErrorCode::kInvalidArgument, "--explain draws phrases: it needs --method phrases");
  if (!arguments.explain.empty()) {
    std::vector<OutputFile> drawings;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      drawings.push_back({"--explain", ExplanationPath(arguments.explain, row), FileKind::kImage});
    }
    VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, drawings, ListImages(arguments, rows)));
  }
  std::vector<std::string> lines(rows.size());
  const auto classify = [&](std::size_t row, const cv::Mat& bgr) -> Status {
    VICTORIOUS_ASSIGN_OR_RETURN(const ClassifiedImage classified,
                                ClassifyImage(featurizer, model, GreyFromBgr(bgr), method));
    lines[row] = FormatResult(rows[row].image, model, classified.result, arguments.json);
    if (!arguments.explain.empty())
      VICTORIOUS_RETURN_IF_ERROR(Explain(ExplanationPath(arguments.explain, row), bgr, model, classified));
    return {};
  };
  {
    Progress progress(arguments.list, static_cast<std::int64_t>(rows.size()), "images");
    VICTORIOUS_RETURN_IF_ERROR(ForEachImage(
        arguments.images, rows, classify, [&](std::size_t done) { progress.Update(static_cast<std::int64_t>(done)); }));
  }
  std::string text;
  for (const std::string& line : lines) text += line;
  return WriteOutput("", text);
}

// Reads the marks of a list.
Expected<std::vector<CategoryFeedback>> ReadListedMarks(const CategoryArguments& arguments,
                                                        const std::vector<CategoryListRow>& rows,
                                                        const CategoryFeaturizer& featurizer) {
  std::vector<CategoryFeedback> marks(rows.size());
  const auto read_mark = [&](std::size_t row, const cv::Mat& bgr) -> Status {
    const CategoryListRow& listed = rows[row];
    if (listed.category.empty() || !listed.mark) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: no {}: a line must be image,category,mark, with mark right or wrong", listed.where,
                              listed.category.empty() ? "category" : "mark"));
    }
    marks[row] = {.category = listed.category, .right = listed.mark == FeedbackMark::kRight, .features = {}};
    VICTORIOUS_ASSIGN_OR_RETURN(marks[row].features, featurizer.Extract(GreyFromBgr(bgr)));
    return {};
  };
  VICTORIOUS_RETURN_IF_ERROR(ForEachImage(arguments.images, rows, read_mark, [](std::size_t) {}));
  return marks;
}

// Reads the marks that the reviews of an index give. Those that cannot be used are left out with a warning.
Expected<std::vector<CategoryFeedback>> ReadReviewedMarks(const CategoryArguments& arguments,
                                                          const CategoryModel& model,
                                                          const CategoryFeaturizer& featurizer) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ReviewMark> reviewed, ListReviewMarks(*store));
  const FileRoots roots = RootsOf(arguments.files_below);
  Progress progress(StoreName(arguments.db), std::ssize(reviewed), "marks");
  std::vector<CategoryFeedback> marks;
  std::int64_t done = 0;
  for (const ReviewMark& one : reviewed) {
    progress.Update(done++);
    if (std::ranges::find(model.nodes, one.category, &CategoryNode::name) == model.nodes.end()) {
      LogWarning("{} is not a category of {}: its objects are left out", OneLine(one.category), arguments.model);
      continue;
    }
    const auto grey = ReadMarkedFrame(one, roots, Interrupt());
    if (!grey) {
      if (grey.error().code == ErrorCode::kCancelled) return std::unexpected(grey.error());
      LogWarning("an object is left out: {}", OneLine(grey.error().message));
      continue;
    }
    marks.push_back({.category = one.category, .right = one.is_right, .features = {}});
    VICTORIOUS_ASSIGN_OR_RETURN(marks.back().features, featurizer.Extract(*grey));
  }
  if (!marks.empty()) return marks;
  return Fail(
      ErrorCode::kNotFound,
      fmt::format("{}: no object of a category of {} is accepted or rejected: review some in `victorious serve`",
                  StoreName(arguments.db), arguments.model));
}

Status Refine(const CategoryArguments& arguments, const ArgumentParser& parser) {
  const bool has_list = !arguments.images.empty() && !arguments.list.empty();
  if (has_list == !arguments.db.empty() || (!has_list && !(arguments.images.empty() && arguments.list.empty()))) {
    return Fail(ErrorCode::kInvalidArgument, "give --images and --list, or --db: where the marks are");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(CategoryModel model, ReadTrainedModel(arguments.model));
  VICTORIOUS_ASSIGN_OR_RETURN(const CategoryFeaturizer featurizer, CategoryFeaturizer::Of(model));
  if (featurizer.options().windows.enabled) {
    return Fail(
        ErrorCode::kUnsupported,
        fmt::format("{}: a model with windows cannot be refined: add the marked examples to the training images and "
                    "train again",
                    arguments.model));
  }
  std::vector<CategoryListRow> rows;
  if (has_list) {
    VICTORIOUS_ASSIGN_OR_RETURN(rows, ReadCategoryList(arguments.list));
  }
  VICTORIOUS_RETURN_IF_ERROR(
      CheckOutputs(parser, {{"--out", arguments.out, FileKind::kCategoryModel}}, ListImages(arguments, rows)));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments.out));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::vector<CategoryFeedback> marks,
      has_list ? ReadListedMarks(arguments, rows, featurizer) : ReadReviewedMarks(arguments, model, featurizer));
  const std::size_t before = CountAgreeing(model, marks);
  Expected<CategoryModel> refined = RefineCategories(std::move(model), marks);
  if (!refined) {
    if (has_list) return std::unexpected(WithListContext(std::move(refined).error(), arguments.list));
    return std::unexpected(std::move(refined).error().WithContext(arguments.model));
  }
  VICTORIOUS_RETURN_IF_ERROR(WriteCategoryModel(arguments.out, *refined));
  const std::size_t after = CountAgreeing(*refined, marks);
  const auto right = std::ranges::count(marks, true, &CategoryFeedback::right);
  LogInfo("{} marks, {} right and {} wrong: {} agreed with the model, {} agree with the refined one", marks.size(),
          right, std::ssize(marks) - right, before, after);
  return WriteOutput("", arguments.json ? ToLine({{"model", arguments.out},
                                                  {"marks", marks.size()},
                                                  {"right", right},
                                                  {"wrong", std::ssize(marks) - right},
                                                  {"agreed_before", before},
                                                  {"agreed_after", after}})
                                        : fmt::format("{}: refined with {} marks\n", arguments.out, marks.size()));
}

}  // namespace

Action SetUpCategory(ArgumentParser& parser) {
  const auto arguments = std::make_shared<CategoryArguments>();
  parser.RequireCommand();
  const auto add_images = [&](ArgumentParser& command, const char* list) {
    command.Add("--images", arguments->images, "Folder to which the paths of the list are relative")
        .Required()
        .TypeName("DIR");
    command.Add("--list", arguments->list, list).Required().TypeName("CSV");
  };
  ArgumentParser train = parser.AddCommand("train", "Train a category model from images");
  add_images(
      train,
      "CSV with a header and lines image,category,x0,y0,x1,y1; the box is in pixels, or empty. An image may be a CAD "
      "file: it is rendered from all directions");
  train
      .Add("--method", arguments->trainer,
           "channels: a detector of objects in the frame, from images in which every object has a box (in boxes of the "
           "category `ignored` nothing is labelled); classifier: of whole images, or windows; auto: channels if an "
           "image has several boxes")
      .OneOf({"auto", "classifier", "channels"});
  train.Add("--out", arguments->out, "The category model to write").Required().TypeName("FILE");
  AddParams(train, arguments->params, "category");
  train.Add("--seed", arguments->seed, "Seed of the random numbers (default 1)").TypeName("N");
  train.AddFlag("--json", arguments->json, "Print one JSON object: the model, its categories, words, images");

  ArgumentParser classify = parser.AddCommand("classify", "Classify images: a label, and a score for each category");
  classify.Add("--model", arguments->model, "A category model").Required().TypeName("FILE");
  add_images(classify, "CSV with a header and one image per line: the column image; other columns are ignored");
  classify.Add("--method", arguments->method, "phrases, or words (bag-of-words baseline)").OneOf({"phrases", "words"});
  classify
      .Add("--explain", arguments->explain,
           "Draw the phrases that support the label, and their box, into this PNG; for further images into "
           "FILE-2.png, ...")
      .TypeName("FILE");
  classify.AddFlag("--json", arguments->json, "One JSON line per image, with the score of every category");

  ArgumentParser refine = parser.AddCommand("refine", "Refine a model by results marked right or wrong");
  refine.Add("--model", arguments->model, "The category model to refine; it is not changed")
      .Required()
      .TypeName("FILE");
  refine.Add("--images", arguments->images, "Folder to which the paths of the list are relative").TypeName("DIR");
  refine.Add("--list", arguments->list, "CSV with a header and lines image,category,mark; mark is right or wrong")
      .TypeName("CSV");
  refine
      .Add("--db", arguments->db,
           "Instead of a list, an index: its accepted and rejected objects of categories, each by the frame of its "
           "best sighting")
      .TypeName("FILE");
  AddFilesBelow(refine, arguments->files_below);
  refine.Add("--out", arguments->out, "The new category model to write").Required().TypeName("FILE");
  refine.AddFlag("--json", arguments->json, "Print one JSON object: the model, the number of marks");
  for (ArgumentParser command : {train, classify, refine}) AddForce(command);
  ArgumentParser import = parser.AddCommand("import", "Import a detection network: ONNX, or darknet's");
  ArgumentParser show = parser.AddCommand("show", "Show a category model or a detector");
  ArgumentParser list = parser.AddCommand("list", "List the category models and detectors of a folder");
  const Action run_import = SetUpCategoryImport(import);
  const Action run_show = SetUpCategoryShow(show);
  const Action run_list = SetUpCategoryList(list);
  return [=]() -> Status {
    if (import.IsGiven()) return run_import();
    if (show.IsGiven()) return run_show();
    if (list.IsGiven()) return run_list();
    if (refine.IsGiven()) return Refine(*arguments, refine);
    return train.IsGiven() ? Train(*arguments, train) : Classify(*arguments, classify);
  };
}

}  // namespace victorious::cli
