// victorious model add | grow | list | show | remove
#include "victorious/apps/cli/cmd_model.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/json.h"
#include "victorious/object/model/model_library.h"

namespace victorious::cli {

void AddModelsFolder(ArgumentParser& parser, std::string& folder) {
  parser.Add("--models", folder, "Folder of models").Required().TypeName("DIR");
}

Action SetUpModelRemove(ArgumentParser& parser) {
  struct Arguments {
    std::string folder;
    std::string name;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  AddModelsFolder(parser, arguments->folder);
  parser.Add("NAME", arguments->name).Required();
  parser.AddFlag("--json", arguments->json, "Print the removed model as JSON");
  return [=]() -> Status {
    VICTORIOUS_RETURN_IF_ERROR(ModelLibrary(arguments->folder).Remove(arguments->name));
    if (!arguments->json) return {};
    return WriteOutput("", DumpJson(nlohmann::json({{"removed", arguments->name}})) + "\n");
  };
}

Action SetUpModel(ArgumentParser& parser) {
  parser.RequireCommand();
  std::vector<std::pair<ArgumentParser, Action>> parts;
  const auto add = [&](const char* name, const char* summary, Action (*set_up)(ArgumentParser&)) {
    ArgumentParser part = parser.AddCommand(name, summary);
    parts.emplace_back(part, set_up(part));
  };
  add("add", "Make a searchable model from a CAD file or from photos", &SetUpModelAdd);
  add("grow", "Learn the views of an object that was found or followed", &SetUpModelGrow);
  add("list", "List the models of a folder", &SetUpModelList);
  add("show", "Show one model's views, features, size and origin", &SetUpModelShow);
  add("remove", "Delete a model", &SetUpModelRemove);
  return [parts = std::move(parts)]() -> Status {
    for (const auto& [part, action] : parts) {
      if (part.IsGiven()) return action();
    }
    return {};  // not reached: one of them is required
  };
}

}  // namespace victorious::cli
