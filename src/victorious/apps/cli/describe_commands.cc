#include "victorious/apps/cli/describe_commands.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace victorious::cli {
namespace {

std::vector<const CLI::App*> ListCommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_name().empty(); });
}

// Text as roff prints it: hyphens are minus signs, so that an option can be copied; no line is a request.
std::string RoffText(std::string_view text) {
  std::string roff;
  for (const char c : text) {
    if (roff.empty() && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";
    } else {
      roff += c == '\n' ? ' ' : c;
    }
  }
  return roff;
}

bool HasValue(const CLI::Option& option) { return option.get_expected_max() > 0 && option.get_type_size_max() > 0; }

// "--db FILE", "VIDEO", "--json"
std::string OptionTitle(const CLI::Option& option) {
  if (option.get_positional()) return "\\fI" + RoffText(option.get_name()) + "\\fR";
  const std::string name = "\\fB" + RoffText(option.get_name(false, true)) + "\\fR";
  return HasValue(option) ? name + " \\fI" + RoffText(option.get_type_name()) + "\\fR" : name;
}

void AddOptions(const CLI::App& command, std::string& page) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_lnames() == std::vector<std::string>{"help"}) continue;
    page += fmt::format(".TP\n{}\n{}{}\n", OptionTitle(*option), RoffText(option->get_description()),
                        option->get_required() ? " (required)" : "");
  }
}

// The command's section, then those of its parts.
void AddCommand(const CLI::App& command, const std::string& parents, std::string& page) {
  const std::string path = parents + command.get_name();
  page += fmt::format(".SS {}\n{}.\n", RoffText(path), RoffText(command.get_description()));
  AddOptions(command, page);
  for (const CLI::App* part : ListCommands(command)) AddCommand(*part, path + " ", page);
}

// A command or a part of one, and the words that lead to it: "model add"; empty for the program.
struct CommandPath {
  std::string path;
  const CLI::App* command;
};

// With all their parts, each before its own.
void CollectPaths(const CLI::App& command, const std::string& path, std::vector<CommandPath>& paths) {
  paths.push_back({path, &command});
  for (const CLI::App* part : ListCommands(command))
    CollectPaths(*part, path + (path.empty() ? "" : " ") + part->get_name(), paths);
}

std::vector<CommandPath> CollectPaths(const CLI::App& program) {
  std::vector<CommandPath> paths;
  CollectPaths(program, "", paths);
  return paths;
}

// The paths of all but the program itself, quoted.
std::string JoinPaths(const std::vector<CommandPath>& paths, std::string_view separator) {
  std::vector<std::string> quoted;
  for (const CommandPath& one : paths) {
    if (!one.path.empty()) quoted.push_back("'" + one.path + "'");
  }
  return fmt::format("{}", fmt::join(quoted, separator));
}

// Text as one word of a shell.
// @param quote  what stands for a single quote within
std::string Quoted(std::string_view text, std::string_view quote) {
  std::string word = "'";
  for (const char c : text) {
    if (c == '\'') {
      word += quote;
    } else {
      word += c == '\n' ? ' ' : c;
    }
  }
  return word + "'";
}

// 'add:Make a model', as _describe of zsh takes it.
std::string ZshEntry(const std::string& name, const std::string& description) {
  return " " + Quoted(name + ":" + description, "'\\''");
}

}  // namespace

std::string MakeManualPage(const ArgumentParser& parser, const std::string& version) {
  const CLI::App& program = parser.app();
  const std::string& name = program.get_name();
  std::string page = fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", name, name, version);
  page += fmt::format(".SH NAME\n{} \\- {}\n", name, RoffText(program.get_description()));
  page += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH OPTIONS\n", name);
  AddOptions(program, page);
  page += ".SH COMMANDS\n";
  for (const CLI::App* command : ListCommands(program)) AddCommand(*command, "", page);
  page +=
      ".SH EXIT STATUS\n0: done. 1: a full disk, a read\\-only folder, or another failure of the system. 2: bad usage "
      "or "
      "bad input, in one line on standard error. 130: stopped by SIGINT. 143: stopped by SIGTERM.\n"
      ".SH ENVIRONMENT\n.TP\nNO_COLOR\nNo colours on standard error, if set and not empty.\n";
  return page;
}

std::string MakeBashCompletion(const ArgumentParser& parser) {
  const CLI::App& program = parser.app();
  const std::string& name = program.get_name();
  const std::vector<CommandPath> paths = CollectPaths(program);
  std::string cases;
  for (const auto& [path, command] : paths) {
    std::vector<std::string> words;
    for (const CLI::App* part : ListCommands(*command)) words.push_back(part->get_name());
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& long_name : option->get_lnames()) words.push_back("--" + long_name);
    }
    cases += fmt::format("    '{}') words='{}' ;;\n", path, fmt::join(words, " "));
  }
  return fmt::format(R"(# bash completion of {0}, printed by `{0} manual bash`
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path='' words='' word next
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    next=${{path:+$path }}$word
    case "$next" in
    {2})
      path=$next ;;
    esac
  done
  case "$path" in
{1}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [[ ${{#COMPREPLY[@]}} -eq 0 ]]; then
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}}
complete -o filenames -F _{0} {0}
)",
                     name, cases, JoinPaths(paths, " | "));
}

std::string MakeZshCompletion(const ArgumentParser& parser) {
  const CLI::App& program = parser.app();
  const std::string& name = program.get_name();
  const std::vector<CommandPath> paths = CollectPaths(program);
  std::string cases;
  for (const auto& [path, command] : paths) {
    std::string parts;
    std::string options;
    for (const CLI::App* part : ListCommands(*command)) parts += ZshEntry(part->get_name(), part->get_description());
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& long_name : option->get_lnames())
        options += ZshEntry("--" + long_name, option->get_description());
    }
    cases += fmt::format("  ('{}')\n    parts=({} )\n    options=({} ) ;;\n", path, parts, options);
  }
  return fmt::format(R"(#compdef {0}
# zsh completion of {0}, printed by `{0} manual zsh`
_{0}() {{
  local at='' word next
  local -a parts options
  for word in "${{(@)words[2,CURRENT-1]}}"; do
    next=${{at:+$at }}$word
    case "$next" in
    ({2})
      at=$next ;;
    esac
  done
  case "$at" in
{1}  esac
  if [[ $words[CURRENT] == -* ]]; then
    _describe -o option options
  elif (( $#parts )); then
    _describe command parts
  else
    _files
  fi
}}
_{0} "$@"
)",
                     name, cases, JoinPaths(paths, " | "));
}

std::string MakeFishCompletion(const ArgumentParser& parser) {
  const CLI::App& program = parser.app();
  const std::string& name = program.get_name();
  const std::vector<CommandPath> paths = CollectPaths(program);
  std::string lines;
  for (const auto& [path, command] : paths) {
    const std::string start = fmt::format("complete -c {0} -n '__{0}_is_at \"{1}\"'", name, path);
    const std::vector<const CLI::App*> parts = ListCommands(*command);
    for (const CLI::App* part : parts)
      lines += fmt::format("{} -f -a {} -d {}\n", start, part->get_name(), Quoted(part->get_description(), "\\'"));
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& long_name : option->get_lnames())
        lines += fmt::format("{} -l {}{} -d {}\n", start, long_name, HasValue(*option) ? " -r" : "",
                             Quoted(option->get_description(), "\\'"));
    }
  }
  return fmt::format(R"(# fish completion of {0}, printed by `{0} manual fish`
function __{0}_is_at
  set -l at ''
  for word in (commandline -opc)[2..-1]
    set -l next (string trim -- "$at $word")
    if contains -- "$next" {2}
      set at $next
    end
  end
  test "$at" = "$argv[1]"
end
{1})",
                     name, lines, JoinPaths(paths, " "));
}

}  // namespace victorious::cli
