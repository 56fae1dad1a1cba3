// victorious model grow: a model learns the views of an object that an index has
#include <cstdint>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/cmd_model.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/jobs/learn_views.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

struct ModelGrowArguments {
  std::string folder;
  std::string name;
  std::string db;
  std::int64_t object = 0;
  bool json = false;
};

Status Grow(const ModelGrowArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kRead));
  const SightingFilter filter{.object = arguments.object};
  VICTORIOUS_RETURN_IF_ERROR(CheckObject(filter, *store));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string nothing, ExplainNothingFound(filter, *store));
  if (!nothing.empty()) return Fail(ErrorCode::kInvalidArgument, nothing);
  const ModelLibrary library(arguments.folder);
  const Status is_new = library.CheckNewName(arguments.name);
  if (!is_new && is_new.error().code != ErrorCode::kAlreadyExists) return is_new;
  ObjectModel known = EmptyPhotoModel(arguments.name, {}, {});
  if (!is_new) {
    VICTORIOUS_ASSIGN_OR_RETURN(known, library.Load(arguments.name));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const LearntViews learnt, LearnViews(known, arguments.object, *store, Interrupt()));
  if (learnt.looked_at == 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("object {}: nothing can be learnt from its sightings: all are smaller than 16 px, at the "
                            "frame's border, or score less than 0.5",
                            arguments.object));
  }
  if (learnt.model.views.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("object {}: none of {} shows enough texture to be learnt: follow a box where it is larger "
                            "(`victorious track --db`)",
                            arguments.object, CountText(learnt.looked_at, "sighting")));
  }
  if (learnt.learnt > 0) {
    VICTORIOUS_RETURN_IF_ERROR(is_new ? library.Add(learnt.model) : library.Replace(learnt.model));
  }
  if (arguments.json) return WriteOutput("", SummaryJson(learnt.model));
  return WriteOutput("", fmt::format("{}: {} learnt from {} of object {}; {}, {}\n", learnt.model.name,
                                     CountText(learnt.learnt, "view"), CountText(learnt.looked_at, "sighting"),
                                     arguments.object, CountText(learnt.model.views.size(), "view"),
                                     CountText(learnt.model.features.size(), "feature")));
}

}  // namespace

Action SetUpModelGrow(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ModelGrowArguments>();
  AddModelsFolder(parser, arguments->folder);
  parser
      .Add("NAME", arguments->name,
           "A model of photos, which keeps its views and learns more, or a new name: then all views are learnt")
      .Required();
  AddDb(parser, arguments->db, "The index that has the object, whose videos must still be at their paths");
  parser.Add("--object", arguments->object, "Id of the object: found, or followed from a box")
      .Required()
      .TypeName("ID");
  parser.AddFlag("--json", arguments->json, "Print the model as JSON");
  return [=]() -> Status { return Grow(*arguments); };
}

}  // namespace victorious::cli
