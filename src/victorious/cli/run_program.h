// The frame of every program of the project: log, signals, one line for an error, exit status.
#pragma once

#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "victorious/base/error.h"
#include "victorious/cli/command.h"

namespace victorious::cli {

/// Sets up the log on stderr, runs `body` and reports its error as one line. Third-party exceptions end here.
/// @param body  returns the exit status
/// @return the exit status: that of `body`, or ExitStatus() of its error
int RunProgram(int argc, char** argv, Expected<int> (*body)(int argc, char** argv));

/// Parses the arguments.
/// @param name  of the program and its command, for the hint to --help
/// @return the exit status if --help or --version ended the program; std::nullopt if it continues
/// Error: kInvalidArgument.
Expected<std::optional<int>> ParseArguments(CLI::App& app, int argc, char** argv, const std::string& name);

/// Sets up a command that is an executable of its own in the folder of this one. It gets every argument as given.
/// @param program  file name of the executable
Action SetUpSiblingProgram(CLI::App& app, const std::string& program);

}  // namespace victorious::cli
