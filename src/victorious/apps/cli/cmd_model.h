// Private to cmd_model*.cc: the parts of `victorious model`, one file each.
#pragma once

#include <optional>
#include <string>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/error.h"
#include "victorious/lab/evaluate/detectability.h"
#include "victorious/types/object_model.h"

namespace victorious::cli {

/// Adds the required option --models: the folder of the model library.
void AddModelsFolder(ArgumentParser& parser, std::string& folder);

/// `model add`: a model from a CAD file or from photos.
Action SetUpModelAdd(ArgumentParser& parser);
/// `model grow`: a model learns the views of an object that an index has.
Action SetUpModelGrow(ArgumentParser& parser);
/// `model list`: one row per model.
Action SetUpModelList(ArgumentParser& parser);
/// `model show`: one model in detail.
Action SetUpModelShow(ArgumentParser& parser);
/// `model remove`
Action SetUpModelRemove(ArgumentParser& parser);

/// A model as one line of JSON, as `model list --json` prints it.
[[nodiscard]] std::string SummaryJson(const ObjectModel& model);

/// The flags of `model show --findable`.
struct DetectabilityArguments {
  bool wanted = false;
  DetectabilityOptions options;
  std::string sun = "off";
  bool no_attitude = false;
  std::string draw;
  std::string params;
};

void AddDetectabilityFlags(ArgumentParser& parser, DetectabilityArguments& arguments);

/// Measures the recall of the search that `index` runs, and draws the test images if that is wanted. Shows progress on
/// stderr. Errors: those of MeasureDetectability and of writing the images; kInvalidArgument for the flags.
[[nodiscard]] Expected<Detectability> RunDetectabilityTest(const ObjectModel& model,
                                                           const DetectabilityArguments& arguments);

}  // namespace victorious::cli
