#include "victorious/apps/cli/argument_parser.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/suggestion.h"

namespace victorious::cli {
namespace {

// The texts of an error and of none, as CLI11's validators return them.
std::string ErrorText(const Status& status) { return status ? "" : status.error().message; }

// Accepts what CLI11 converts to a Number from `min` to `max`: no NaN.
// @param allowed  the numbers for the message
// @param interval  the same, for help: "0..1024"
template <typename Number>
CLI::Validator InRange(Number min, Number max, const std::string& allowed, const std::string& interval) {
  const auto check = [=](std::string& text) -> std::string {
    Number number{};
    const bool is_number = CLI::detail::lexical_cast(text, number);
    return is_number && number >= min && number <= max ? "" : fmt::format("\"{}\": must be {}", text, allowed);
  };
  return {check, interval};
}

}  // namespace

Argument Argument::Required() {
  option_->required();
  return *this;
}

Argument Argument::TypeName(const std::string& word) {
  option_->type_name(word);
  return *this;
}

Argument Argument::ShowDefault() {
  option_->capture_default_str();
  return *this;
}

Argument Argument::Range(int min, int max) {
  option_->check(
      InRange(min, max, fmt::format("a whole number from {} to {}", min, max), fmt::format("{}..{}", min, max)));
  return *this;
}

Argument Argument::Range(double min, double max) {
  option_->check(InRange(min, max, fmt::format("a number from {} to {}", min, max), fmt::format("{}..{}", min, max)));
  return *this;
}

Argument Argument::AtLeast(std::int64_t min) {
  option_->check(InRange(min, std::numeric_limits<std::int64_t>::max(), fmt::format("a whole number from {}", min),
                         fmt::format("{}..", min)));
  return *this;
}

Argument Argument::OneOf(const std::vector<std::string>& words) {
  const auto check = [words](std::string& text) -> std::string {
    const bool is_one = std::ranges::find(words, text) != words.end();
    return is_one ? "" : fmt::format("\"{}\": must be one of {}", text, fmt::join(words, ", "));
  };
  option_->check(CLI::Validator(check, fmt::format("{{{}}}", fmt::join(words, ","))));
  return *this;
}

Argument Argument::Check(std::function<Status(const std::string& text)> check) {
  option_->check(CLI::Validator([check = std::move(check)](std::string& text) { return ErrorText(check(text)); }, ""));
  return *this;
}

Argument Argument::Transform(std::function<Status(std::string& text)> transform) {
  option_->transform(
      CLI::Validator([transform = std::move(transform)](std::string& text) { return ErrorText(transform(text)); }, ""));
  return *this;
}

Argument Argument::Needs(const Argument& other) {
  option_->needs(other.option_);
  return *this;
}

Argument Argument::Excludes(const Argument& other) {
  option_->excludes(other.option_);
  return *this;
}

Argument Argument::SplitAt(char separator) {
  option_->delimiter(separator);
  return *this;
}

Argument Argument::OneValueEach() {
  option_->allow_extra_args(false);
  return *this;
}

template <ArgumentValue Value>
Argument ArgumentParser::Add(const std::string& name, Value& value, const std::string& description) {
  CLI::Option* option = app_->add_option(name, value, description);
  // CLI11 takes an empty text for an optional that is not given.
  if constexpr (OneOfTypes<Value, std::optional<int>, std::optional<std::int64_t>, std::optional<std::uint64_t>,
                           std::optional<double>>) {
    option->check(CLI::Validator(
        [](const std::string& text) { return std::string(text.empty() ? "\"\": must be a number" : ""); }, ""));
  }
  return Argument(*option);
}

// One for each type of ArgumentValue.
template Argument ArgumentParser::Add(const std::string&, std::string&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, int&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::int64_t&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::uint64_t&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, double&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::optional<std::string>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::optional<int>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::optional<std::int64_t>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::optional<double>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::vector<std::string>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::vector<std::int64_t>&, const std::string&);
template Argument ArgumentParser::Add(const std::string&, std::vector<double>&, const std::string&);

Argument ArgumentParser::AddFlag(const std::string& name, bool& given, const std::string& description) {
  return Argument(*app_->add_flag(name, given, description));
}

Argument ArgumentParser::AddFlag(const std::string& name, const std::string& description) {
  return Argument(*app_->add_flag(name)->description(description));
}

Argument ArgumentParser::AddAction(const std::string& name, std::function<Status(int value)> action,
                                   const std::string& description) {
  const auto run = [name, action = std::move(action)](int value) {
    if (const Status status = action(value); !status) throw CLI::ValidationError(name, status.error().message);
  };
  return Argument(*app_->add_option_function<int>(name, run, description)->trigger_on_parse());
}

ArgumentParser ArgumentParser::AddCommand(const std::string& name, const std::string& summary,
                                          const std::string& group) {
  CLI::App* const command = app_->add_subcommand(name, summary);
  if (!group.empty()) command->group(group);
  return ArgumentParser(*command);
}

void ArgumentParser::RequireCommand() { app_->require_subcommand(1); }

std::vector<ArgumentParser> ArgumentParser::Commands() const {
  std::vector<ArgumentParser> commands;
  for (CLI::App* command : app_->get_subcommands([](const CLI::App*) { return true; })) commands.emplace_back(*command);
  return commands;
}

ArgumentParser ArgumentParser::Program() const {
  CLI::App* program = app_;
  while (program->get_parent() != nullptr) program = program->get_parent();
  return ArgumentParser(*program);
}

const std::string& ArgumentParser::Name() const { return app_->get_name(); }

bool ArgumentParser::IsGiven() const { return app_->parsed(); }

ProgramParser::ProgramParser(const std::string& name, const std::string& description, const std::string& version)
    : ProgramParser(std::make_unique<CLI::App>(description, name)) {
  if (!version.empty()) program_->set_version_flag("-V,--version", version);
}

ProgramParser::ProgramParser(std::unique_ptr<CLI::App> program)
    : ArgumentParser(*program), program_(std::move(program)) {}

ProgramParser::~ProgramParser() = default;

namespace {

// The program and the commands that were parsed, outermost first.
std::vector<const CLI::App*> ParsedCommands(const CLI::App& program) {
  std::vector<const CLI::App*> commands = {&program};
  while (!commands.back()->get_subcommands().empty()) commands.push_back(commands.back()->get_subcommands().front());
  return commands;
}

// "victorious model add"
std::string FullName(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return fmt::format("{}", fmt::join(names, " "));
}

// The names that a word of the command can be: its options, or its subcommands.
std::vector<std::string> KnownNames(const CLI::App& command, bool options) {
  std::vector<std::string> names;
  if (!options) {
    for (const CLI::App* part : command.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(part->get_name());
    return names;
  }
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// "; did you mean --models?" for the first word that the parser did not expect; empty if none is near a known name.
std::string Suggestion(const std::vector<const CLI::App*>& commands) {
  for (const CLI::App* command : commands) {
    for (const std::string& word : command->remaining()) {
      const auto nearest = FindNearest(word, KnownNames(*command, word.starts_with('-')));
      if (nearest) return fmt::format("; {}: did you mean {}?", word, *nearest);
    }
  }
  return "";
}

// "not expected: 13.4 200": the words in the order in which they were given, which CLI11's message reverses.
std::optional<std::string> ExplainExtras(const std::vector<const CLI::App*>& commands, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return std::nullopt;
  std::vector<std::string> words;
  for (const CLI::App* command : commands) std::ranges::copy(command->remaining(), std::back_inserter(words));
  if (words.empty()) return std::nullopt;
  return fmt::format("not expected: {}", fmt::join(words, " "));
}

// "--every 2.5: give a whole number" for CLI11's "Could not convert: --every = 2.5". Of arguments without a range: the
// others say their range, for such texts, too.
std::optional<std::string> ExplainConversion(const CLI::App& command, std::string_view message) {
  constexpr std::string_view kStart = "Could not convert: ";
  constexpr std::string_view kBetween = " = ";
  if (!message.starts_with(kStart)) return std::nullopt;
  message.remove_prefix(kStart.size());
  const std::size_t between = message.find(kBetween);
  if (between == std::string_view::npos) return std::nullopt;
  const std::string name(message.substr(0, between));
  const CLI::Option* option = command.get_option_no_throw(name);
  const bool whole = option != nullptr && option->get_type_name() == "N";
  return fmt::format("{} {}: give a {}number", name, message.substr(between + kBetween.size()), whole ? "whole " : "");
}

}  // namespace

Expected<std::optional<int>> ParseArguments(const ArgumentParser& program, std::vector<std::string> words) {
  CLI::App& app = program.app();
  std::ranges::reverse(words);  // CLI11 takes them last first
  try {
    app.parse(std::move(words));
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    const std::vector<const CLI::App*> commands = ParsedCommands(app);
    std::optional<std::string> what = ExplainExtras(commands, error);
    if (!what) what = ExplainConversion(*commands.back(), error.what());
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}{} (see `{} --help`)", what.value_or(error.what()),
                                                         Suggestion(commands), FullName(commands)));
  }
  return std::nullopt;
}

}  // namespace victorious::cli
