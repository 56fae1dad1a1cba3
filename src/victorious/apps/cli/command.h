// The command interface: one row of the table in main.cc. `setup` adds the command's arguments to its parser and
// returns the action to call after parsing. Each file cmd_<verb>.cc implements one command. A command can also be a
// program of its own.
#pragma once

#include <functional>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/base/error.h"

namespace victorious::cli {

using Action = std::function<Status()>;

struct Command {
  const char* name;
  const char* group;
  const char* summary;                      ///< one line
  Action (*setup)(ArgumentParser& parser);  ///< nullptr if `program` is set
  bool has_threads = false;                 ///< gets the flag --threads
  const char* program = nullptr;            ///< executable in the folder of this one that gets all arguments as given
  bool has_addresses = false;               ///< gets the flag --ca: it opens live sources or other addresses
};

Action SetUpBackup(ArgumentParser& parser);
Action SetUpCategory(ArgumentParser& parser);
Action SetUpCluster(ArgumentParser& parser);
Action SetUpCopy(ArgumentParser& parser);
Action SetUpDoctor(ArgumentParser& parser);
Action SetUpEvaluate(ArgumentParser& parser);
Action SetUpExport(ArgumentParser& parser);
Action SetUpFeatures(ArgumentParser& parser);
Action SetUpFrame(ArgumentParser& parser);
Action SetUpIndex(ArgumentParser& parser);
Action SetUpLocate(ArgumentParser& parser);
Action SetUpManual(ArgumentParser& parser);
Action SetUpMatch(ArgumentParser& parser);
Action SetUpModel(ArgumentParser& parser);
Action SetUpNavigate(ArgumentParser& parser);
Action SetUpObject(ArgumentParser& parser);
Action SetUpParams(ArgumentParser& parser);
Action SetUpRecord(ArgumentParser& parser);
Action SetUpRemove(ArgumentParser& parser);
Action SetUpSearch(ArgumentParser& parser);
Action SetUpSelfTest(ArgumentParser& parser);
Action SetUpServe(ArgumentParser& parser);
Action SetUpSheet(ArgumentParser& parser);
Action SetUpSimulate(ArgumentParser& parser);
Action SetUpSubmit(ArgumentParser& parser);
Action SetUpTelemetry(ArgumentParser& parser);
Action SetUpTrack(ArgumentParser& parser);
Action SetUpUser(ArgumentParser& parser);
Action SetUpWork(ArgumentParser& parser);

}  // namespace victorious::cli
