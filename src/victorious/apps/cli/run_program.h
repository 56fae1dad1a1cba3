// The frame of every program of the project: log, signals, one line for an error, exit status.
#pragma once

#include <string>
#include <vector>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/base/error.h"

namespace victorious::cli {

/// Sets up the log on stderr, runs `body` and reports its error as one line. Third-party exceptions end here.
/// @param body  returns the exit status
/// @return the exit status: that of `body`, 128 + the signal's number if SIGINT or SIGTERM stopped it (130, 143), else
///   ExitStatus() of its error
int RunProgram(int argc, char** argv, Expected<int> (*body)(int argc, char** argv));

/// Adds --events, which sends the log, the progress and the error of this program to a descriptor as events
/// (base/program_events.h) instead of to stderr. It takes effect before the rest of the command line is parsed: an
/// error there is an event as well.
void AddEvents(ProgramParser& program);

/// Replaces this process by another executable of the folder of this one, with `arguments`. Returns only on failure.
/// Errors: kNotFound if it is not built, and those of starting it.
Error StartSiblingProgram(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace victorious::cli
