// victorious copy VIDEO --out FILE [--json]: writes a copy of a video that browsers play
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/count_text.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/input/video/playable_copy.h"

namespace victorious::cli {
namespace {

struct CopyArguments {
  std::string video;
  std::string out;
  bool json = false;
};

Status Run(const CopyArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments.out, FileKind::kVideo}}));
  if (!arguments.out.ends_with(".mp4")) {
    return Fail(ErrorCode::kInvalidArgument, OneLine(arguments.out) + ": the copy's name must end in .mp4");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const PlayableCopy copy, WritePlayableCopy(arguments.video, arguments.out, Interrupt()));
  LogInfo("{}, {}", CountText(static_cast<std::size_t>(copy.frames), "frame"),
          copy.is_remuxed ? "copied as they are" : "encoded as H.264");
  if (!arguments.json) return {};
  const nlohmann::ordered_json line = {
      {"video", arguments.video}, {"copy", arguments.out}, {"frames", copy.frames}, {"is_remuxed", copy.is_remuxed}};
  return WriteOutput("", DumpJson(line) + "\n");
}

}  // namespace

Action SetUpCopy(ArgumentParser& parser) {
  const auto arguments = std::make_shared<CopyArguments>();
  parser.Add("VIDEO", arguments->video, "A file or a folder of frames").Required();
  parser.Add("--out", arguments->out, "The copy (.mp4)").Required().TypeName("FILE");
  parser.AddFlag("--json", arguments->json,
                 "Print one JSON object: the copy, its frames, whether they are encoded anew");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
