#include "victorious/cli/describe_commands.h"

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

// "--db FILE", "VIDEO", "--json"
std::string OptionTitle(const CLI::Option& option) {
  if (option.get_positional()) return "\\fI" + RoffText(option.get_name()) + "\\fR";
  const bool has_value = option.get_expected_max() > 0 && option.get_type_size_max() > 0;
  const std::string name = "\\fB" + RoffText(option.get_name(false, true)) + "\\fR";
  return has_value ? name + " \\fI" + RoffText(option.get_type_name()) + "\\fR" : name;
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

// One case of the completion for each command: its words.
// @param paths  receives the quoted paths of the commands: 'model add'
void AddCase(const CLI::App& command, const std::string& path, std::string& cases, std::vector<std::string>& paths) {
  std::vector<std::string> words;
  for (const CLI::App* part : ListCommands(command)) words.push_back(part->get_name());
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  }
  cases += fmt::format("    '{}') words='{}' ;;\n", path, fmt::join(words, " "));
  for (const CLI::App* part : ListCommands(command)) {
    const std::string of_part = path + (path.empty() ? "" : " ") + part->get_name();
    paths.push_back("'" + of_part + "'");
    AddCase(*part, of_part, cases, paths);
  }
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
  std::string cases;
  std::vector<std::string> paths;
  AddCase(program, "", cases, paths);
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
                     name, cases, fmt::join(paths, " | "));
}

}  // namespace victorious::cli
