// The arguments of a program and of its commands: what CLI11 parses, behind an interface that includes none of its
// headers, which take longer to compile than most commands. Only the sources of cli/ that describe or run the parser
// itself reach CLI11, by app().
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace victorious::cli {

template <typename Type, typename... Types>
concept OneOfTypes = (std::same_as<Type, Types> || ...);

/// The type of an argument's value. An optional keeps whether the argument was given; a vector takes one value or more.
template <typename Type>
concept ArgumentValue =
    OneOfTypes<Type, std::string, int, std::int64_t, std::uint64_t, double, std::optional<std::string>,
               std::optional<int>, std::optional<std::int64_t>, std::optional<std::uint64_t>, std::optional<double>,
               std::vector<std::string>, std::vector<std::int64_t>, std::vector<double>>;

/// An option, a flag or a positional argument. A handle: copies name the same argument, which lives as long as the
/// program's parser. Each function changes the argument and returns it, so that calls can be chained.
class Argument {
 public:
  explicit Argument(CLI::Option& option) : option_(&option) {}

  Argument Required();
  /// The word that stands for the value in help and errors: "FILE". By default it follows from the value's type.
  Argument TypeName(const std::string& word);
  /// Shows the value that the variable has now as the default.
  Argument ShowDefault();

  /// Accepts whole numbers from `min` to `max`, both inclusive.
  Argument Range(int min, int max);
  /// Accepts numbers from `min` to `max`, both inclusive.
  Argument Range(double min, double max);
  /// Accepts whole numbers from `min`.
  Argument AtLeast(std::int64_t min);
  /// Accepts these words.
  Argument OneOf(const std::vector<std::string>& words);
  /// Accepts the texts of a table.
  template <typename Enum, std::size_t count>
  Argument OneOf(const std::array<EnumText<Enum>, count>& table) {
    const auto texts = Texts(table);
    return OneOf(std::vector<std::string>(texts.begin(), texts.end()));
  }
  /// Accepts the texts for which `check` has no error.
  Argument Check(std::function<Status(const std::string& text)> check);
  /// Changes each text by `transform` before it is converted to the value's type.
  Argument Transform(std::function<Status(std::string& text)> transform);

  /// May be given only together with `other`.
  Argument Needs(const Argument& other);
  /// May not be given together with `other`.
  Argument Excludes(const Argument& other);

  /// Of a vector: splits each text into values at `separator`.
  Argument SplitAt(char separator);
  /// Of a vector: takes one value each time the option is given, so that the next word is not another one.
  Argument OneValueEach();

 private:
  CLI::Option* option_;
};

/// The parser of a program or of one of its commands. A handle: copies name the same parser, which lives as long as the
/// program's (ProgramParser). Variables that receive values must live until the arguments are parsed.
class ArgumentParser {
 public:
  explicit ArgumentParser(CLI::App& app) : app_(&app) {}

  /// Adds an argument: an option if its name starts with "--", else a positional one.
  /// @param value  receives the value; unchanged if the argument is not given
  template <ArgumentValue Value>
  Argument Add(const std::string& name, Value& value, const std::string& description = "");

  /// Adds an option without value. `given` becomes true if it is given.
  Argument AddFlag(const std::string& name, bool& given, const std::string& description);
  /// Adds an option without value or variable.
  Argument AddFlag(const std::string& name, const std::string& description);

  /// Adds an option whose action runs as soon as it is parsed, before the rest of the command line. An error of the
  /// action is one of parsing.
  Argument AddAction(const std::string& name, std::function<Status(int value)> action, const std::string& description);

  /// Adds a command with a parser of its own.
  /// @param group  the heading under which help lists it; empty: that of this parser
  ArgumentParser AddCommand(const std::string& name, const std::string& summary, const std::string& group = "");
  /// Makes it an error to give none of the commands.
  void RequireCommand();

  /// The commands that were added, in that order.
  [[nodiscard]] std::vector<ArgumentParser> Commands() const;
  /// The parser of the whole program.
  [[nodiscard]] ArgumentParser Program() const;
  [[nodiscard]] const std::string& Name() const;
  /// True if the command was given. Valid after parsing.
  [[nodiscard]] bool IsGiven() const;

  /// The parser of CLI11, for sources that include its headers.
  [[nodiscard]] CLI::App& app() const { return *app_; }

 private:
  CLI::App* app_;
};

/// The parser of a program, which owns those of its commands.
class ProgramParser : public ArgumentParser {
 public:
  /// @param name  the words that start the program: "victorious experiment"
  /// @param version  what --version prints; empty: there is no such flag
  ProgramParser(const std::string& name, const std::string& description, const std::string& version = "");
  ~ProgramParser();
  ProgramParser(const ProgramParser&) = delete;
  ProgramParser& operator=(const ProgramParser&) = delete;

 private:
  explicit ProgramParser(std::unique_ptr<CLI::App> program);

  std::unique_ptr<CLI::App> program_;
};

/// Parses the words after the program's name. The error of a mistyped option or command names the nearest one; all end
/// with the command whose --help describes the arguments.
/// @return the exit status if --help or --version ended the program; std::nullopt if it continues
/// Error: kInvalidArgument.
[[nodiscard]] Expected<std::optional<int>> ParseArguments(const ArgumentParser& program,
                                                          std::vector<std::string> words);

}  // namespace victorious::cli
