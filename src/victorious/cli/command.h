// The command interface: one row of the table in main.cc. `setup` adds the command's arguments to its parser and
// returns the action to call after parsing. Each file cmd_<verb>.cc implements one command. A command can also be a
// program of its own.
#pragma once

#include <functional>

#include <CLI/App.hpp>

#include "victorious/base/error.h"

namespace victorious::cli {

using Action = std::function<Status()>;

struct Command {
  const char* name;
  const char* group;
  const char* summary;             ///< one line
  Action (*setup)(CLI::App& app);  ///< nullptr if `program` is set
  bool has_threads = false;        ///< gets the flag --threads
  const char* program = nullptr;   ///< executable in the folder of this one that gets all arguments as given
};

Action SetUpCategory(CLI::App& app);
Action SetUpCluster(CLI::App& app);
Action SetUpCopy(CLI::App& app);
Action SetUpDoctor(CLI::App& app);
Action SetUpEvaluate(CLI::App& app);
Action SetUpExport(CLI::App& app);
Action SetUpFeatures(CLI::App& app);
Action SetUpFrame(CLI::App& app);
Action SetUpIndex(CLI::App& app);
Action SetUpLocate(CLI::App& app);
Action SetUpManual(CLI::App& app);
Action SetUpMatch(CLI::App& app);
Action SetUpModel(CLI::App& app);
Action SetUpNavigate(CLI::App& app);
Action SetUpParams(CLI::App& app);
Action SetUpSearch(CLI::App& app);
Action SetUpServe(CLI::App& app);
Action SetUpSheet(CLI::App& app);
Action SetUpSimulate(CLI::App& app);
Action SetUpSubmit(CLI::App& app);
Action SetUpTelemetry(CLI::App& app);
Action SetUpTrack(CLI::App& app);
Action SetUpUser(CLI::App& app);
Action SetUpWork(CLI::App& app);

}  // namespace victorious::cli
