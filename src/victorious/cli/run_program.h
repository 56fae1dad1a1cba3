// The frame of every program of the project: log, signals, one line for an error, exit status.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "victorious/base/error.h"

namespace victorious::cli {

/// Sets up the log on stderr, runs `body` and reports its error as one line. Third-party exceptions end here.
/// @param body  returns the exit status
/// @return the exit status: that of `body`, 128 + the signal's number if SIGINT or SIGTERM stopped it (130, 143), else
///   ExitStatus() of its error
int RunProgram(int argc, char** argv, Expected<int> (*body)(int argc, char** argv));

/// For `--events`: sends the log, the progress and the error of this program to `descriptor` as events
/// (base/program_events.h) instead of to stderr. Error: kInvalidArgument for a descriptor that is not open for writing.
[[nodiscard]] Status SendLogToEvents(int descriptor);

/// Parses the arguments. The error of a mistyped option or subcommand names the nearest one.
/// @param name  of the program and its command, for the hint to --help
/// @return the exit status if --help or --version ended the program; std::nullopt if it continues
/// Error: kInvalidArgument.
[[nodiscard]] Expected<std::optional<int>> ParseArguments(CLI::App& app, int argc, char** argv,
                                                          const std::string& name);

/// Replaces this process by another executable of the folder of this one, with `arguments`. Returns only on failure.
/// Errors: kNotFound if it is not built, and those of starting it.
Error StartSiblingProgram(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace victorious::cli
