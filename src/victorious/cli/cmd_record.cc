// victorious record URL --to DIR: a live source into files, as it comes
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "victorious/base/log.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/video/stream_recorder.h"

namespace victorious::cli {
namespace {

struct RecordArguments {
  std::string url;
  std::string folder;
  double segment_s = 60;
  double max_size_gb = 100;
};

Status Run(const RecordArguments& arguments) {
  const RecordOptions options{.folder = arguments.folder,
                              .segment_s = arguments.segment_s,
                              .max_bytes = static_cast<std::int64_t>(arguments.max_size_gb * 1e9)};
  const auto inform = [](const RecordedFile& file) {
    LogInfo("{}: {:.1f} MB", OneLine(file.path.string()), static_cast<double>(file.bytes) / 1e6);
  };
  const auto warn = [](const std::string& warning) { LogWarning("{}", OneLine(warning)); };
  return RecordStream(arguments.url, options, Interrupt(), inform, warn);
}

}  // namespace

Action SetUpRecord(ArgumentParser& parser) {
  const auto arguments = std::make_shared<RecordArguments>();
  parser.Add("URL", arguments->url, "A live source: rtsp://…, udp://…, srt://…, …").Required();
  parser.Add("--to", arguments->folder, "Folder for the files, one for each source; created if it does not exist")
      .Required()
      .TypeName("DIR");
  parser
      .Add("--segment", arguments->segment_s,
           "Seconds of video in a file: it ends before the next key frame after them")
      .ShowDefault()
      .Range(1.0, 86'400.0)
      .TypeName("SECONDS");
  parser.Add("--max-size", arguments->max_size_gb, "What the files may take, in GB; the oldest are removed first")
      .ShowDefault()
      .Range(0.001, 1e6)
      .TypeName("GB");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
