// victorious manual man | bash | zsh | fish
#include <array>
#include <memory>
#include <string>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/describe_commands.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/version.h"

namespace victorious::cli {

namespace {

enum class ManualFormat { kMan, kBash, kZsh, kFish };

constexpr auto kManualFormatTexts = std::to_array<EnumText<ManualFormat>>({{ManualFormat::kMan, "man"},
                                                                           {ManualFormat::kBash, "bash"},
                                                                           {ManualFormat::kZsh, "zsh"},
                                                                           {ManualFormat::kFish, "fish"}});

std::string Print(ManualFormat format, const ArgumentParser& program) {
  switch (format) {
    case ManualFormat::kBash:
      return MakeBashCompletion(program);
    case ManualFormat::kZsh:
      return MakeZshCompletion(program);
    case ManualFormat::kFish:
      return MakeFishCompletion(program);
    case ManualFormat::kMan:
      break;
  }
  return MakeManualPage(program, kVersion);
}

}  // namespace

Action SetUpManual(ArgumentParser& parser) {
  const auto format = std::make_shared<std::string>("man");
  parser.Add("FORMAT", *format, "man: the manual page (roff); bash, zsh or fish: the completion for this shell")
      .OneOf(kManualFormatTexts);
  return [=] { return WriteOutput("", Print(*FromText(kManualFormatTexts, *format), parser.Program())); };
}

}  // namespace victorious::cli
