// victorious copy VIDEO --out FILE: writes a copy of a video that browsers play
#include <memory>
#include <string>

#include <spdlog/spdlog.h>

#include "victorious/base/count_text.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/output_files.h"
#include "victorious/video/playable_copy.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string video;
  std::string out;
};

Status Run(const Arguments& arguments, const CLI::App& app) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(app, {{"--out", arguments.out, FileKind::kVideo}}));
  if (!arguments.out.ends_with(".mp4")) {
    return Fail(ErrorCode::kInvalidArgument, OneLine(arguments.out) + ": the copy's name must end in .mp4");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const PlayableCopy copy, WritePlayableCopy(arguments.video, arguments.out, Interrupt()));
  spdlog::info("{}, {}", CountText(static_cast<std::size_t>(copy.frames), "frame"),
               copy.is_remuxed ? "copied as they are" : "encoded as H.264");
  return {};
}

}  // namespace

Action SetUpCopy(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("VIDEO", arguments->video, "A file or a folder of frames")->required();
  app.add_option("--out", arguments->out, "The copy (.mp4)")->required()->type_name("FILE");
  AddForce(app);
  return [=, &app] { return Run(*arguments, app); };
}

}  // namespace victorious::cli
