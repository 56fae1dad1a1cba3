// victorious model add | list | show | remove
#include "victorious/cli/cmd_model.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/model/model_library.h"

namespace victorious::cli {

void AddModelsFolder(CLI::App& app, std::string& folder) {
  app.add_option("--models", folder, "Folder of models")->required()->type_name("DIR");
}

Action SetUpModelRemove(CLI::App& app) {
  struct Arguments {
    std::string folder;
    std::string name;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  AddModelsFolder(app, arguments->folder);
  app.add_option("NAME", arguments->name)->required();
  app.add_flag("--json", arguments->json, "Print the removed model as JSON");
  return [=]() -> Status {
    VICTORIOUS_RETURN_IF_ERROR(ModelLibrary(arguments->folder).Remove(arguments->name));
    if (!arguments->json) return {};
    return WriteOutput("", nlohmann::json({{"removed", arguments->name}}).dump() + "\n");
  };
}

Action SetUpModel(CLI::App& app) {
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, Action>> parts;
  const auto add = [&](const char* name, const char* summary, Action (*set_up)(CLI::App&)) {
    CLI::App* part = app.add_subcommand(name, summary);
    parts.emplace_back(part, set_up(*part));
  };
  add("add", "Make a searchable model from a CAD file or from photos", &SetUpModelAdd);
  add("list", "List the models of a folder", &SetUpModelList);
  add("show", "Show one model's views, features, size and origin", &SetUpModelShow);
  add("remove", "Delete a model", &SetUpModelRemove);
  return [parts = std::move(parts)]() -> Status {
    for (const auto& [part, action] : parts) {
      if (part->parsed()) return action();
    }
    return {};  // not reached: one of them is required
  };
}

}  // namespace victorious::cli
