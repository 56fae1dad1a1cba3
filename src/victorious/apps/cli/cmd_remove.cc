// victorious remove --db INDEX (--video NAME | --model NAME): takes a video or a model out of an index
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/object/model/model_library.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

struct RemoveArguments {
  std::string db;
  std::string video;
  std::string model;
  std::string models;
};

Expected<VideoRecord> FindOneVideo(const std::string& name, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  const std::vector<VideoRecord> named = FindVideosByName(videos, name);
  if (named.size() == 1) return named.front();
  if (named.empty()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("--video {}: is not in the index: give a name that `victorious doctor` "
                            "lists for it",
                            OneLine(name)));
  }
  return Fail(ErrorCode::kInvalidArgument, fmt::format("--video {}: {} videos of the index have this name: give the "
                                                       "whole path of one, as {}",
                                                       OneLine(name), named.size(), OneLine(ShownName(named.front()))));
}

Status RemoveVideo(const RemoveArguments& arguments, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord video, FindOneVideo(arguments.video, store));
  VICTORIOUS_RETURN_IF_ERROR(store.DeleteVideo(video.id));
  LogInfo("{}: removed from the index, with all that was found in it; the video itself stays",
          OneLine(ShownName(video)));
  return {};
}

std::string NamesOf(const std::vector<ModelRecord>& models) {
  std::vector<std::string> names;
  for (const ModelRecord& model : models) names.push_back(OneLine(model.name));
  return names.empty() ? "it has none" : fmt::format("there are: {}", fmt::join(names, ", "));
}

// The file goes first: if it cannot be deleted, the index stays as it is.
Status RemoveModel(const RemoveArguments& arguments, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  const auto found = std::ranges::find(models, arguments.model, &ModelRecord::name);
  bool has_file = false;
  if (!arguments.models.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::string> files, ModelLibrary(arguments.models).Names());
    has_file = std::ranges::find(files, arguments.model) != files.end();
  }
  if (found == models.end() && !has_file) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("--model {}: is not in the index{}: {}", OneLine(arguments.model),
                            arguments.models.empty() ? "" : " and has no file in " + OneLine(arguments.models),
                            NamesOf(models)));
  }
  if (has_file) VICTORIOUS_RETURN_IF_ERROR(ModelLibrary(arguments.models).Remove(arguments.model));
  if (found != models.end()) VICTORIOUS_RETURN_IF_ERROR(store.DeleteModel(found->id));
  const std::string of_file = has_file                   ? "its file is deleted"
                              : arguments.models.empty() ? "its file stays, and is searched for again"
                                                         : "no file of it is in " + OneLine(arguments.models);
  LogInfo("{}: {}; {}", OneLine(arguments.model),
          found == models.end() ? "was not in the index" : "removed from the index, with all that was found of it",
          of_file);
  return {};
}

Status Run(const RemoveArguments& arguments) {
  if (arguments.video.empty() == arguments.model.empty()) {
    return Fail(ErrorCode::kInvalidArgument, arguments.video.empty()
                                                 ? "nothing to remove is given: add --video NAME or --model NAME"
                                                 : "--video and --model are given: remove one after the other");
  }
  if (!arguments.video.empty() && !arguments.models.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--models: only with --model NAME");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_index, HasIndex(arguments.db));
  if (!has_index) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such index", StoreName(arguments.db)));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kCreate));
  return arguments.video.empty() ? RemoveModel(arguments, *store) : RemoveVideo(arguments, *store);
}

}  // namespace

Action SetUpRemove(ArgumentParser& parser) {
  const auto arguments = std::make_shared<RemoveArguments>();
  parser.Add("--db", arguments->db, "The index").Required().TypeName("INDEX");
  parser.Add("--video", arguments->video, "A video of the index; its file stays. Give this or --model")
      .TypeName("NAME");
  parser
      .Add("--model", arguments->model,
           "A model or category of the index; `victorious model remove` deletes its file alone")
      .TypeName("NAME");
  parser.Add("--models", arguments->models, "The folder of the model's file, which is deleted, too").TypeName("DIR");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
