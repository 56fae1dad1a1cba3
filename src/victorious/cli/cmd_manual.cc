// victorious manual man | bash
#include <memory>
#include <string>

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include "victorious/base/version.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/describe_commands.h"

namespace victorious::cli {

Action SetUpManual(CLI::App& app) {
  const auto format = std::make_shared<std::string>("man");
  app.add_option("FORMAT", *format, "man: the manual page (roff); bash: the completion for bash")
      ->check(CLI::IsMember({"man", "bash"}));
  return [=, &app]() -> Status {
    const CLI::App& program = *app.get_parent();
    return WriteOutput("", *format == "bash" ? MakeBashCompletion(program) : MakeManualPage(program, kVersion));
  };
}

}  // namespace victorious::cli
