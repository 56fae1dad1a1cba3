// The manual page and the completions of shells, made from the same description of commands and options that parses the
// arguments: neither can name an option that does not exist.
#pragma once

#include <string>

#include "victorious/apps/cli/argument_parser.h"

namespace victorious::cli {

/// The manual page of the program, section 1, as roff source: every command with its options.
/// @param parser  of the program
/// @param version  of the program
[[nodiscard]] std::string MakeManualPage(const ArgumentParser& parser, const std::string& version);

/// A completion for bash: commands and subcommands, the options of each, else file names.
/// @param parser  of the program
[[nodiscard]] std::string MakeBashCompletion(const ArgumentParser& parser);

/// The same for zsh, with the description of each.
[[nodiscard]] std::string MakeZshCompletion(const ArgumentParser& parser);

/// The same for fish.
[[nodiscard]] std::string MakeFishCompletion(const ArgumentParser& parser);

}  // namespace victorious::cli
