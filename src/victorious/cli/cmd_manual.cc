// victorious manual man | bash
#include <memory>
#include <string>

#include "victorious/base/version.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/describe_commands.h"

namespace victorious::cli {

Action SetUpManual(ArgumentParser& parser) {
  const auto format = std::make_shared<std::string>("man");
  parser.Add("FORMAT", *format, "man: the manual page (roff); bash: the completion for bash").OneOf({"man", "bash"});
  return [=]() -> Status {
    const ArgumentParser program = parser.Program();
    return WriteOutput("", *format == "bash" ? MakeBashCompletion(program) : MakeManualPage(program, kVersion));
  };
}

}  // namespace victorious::cli
