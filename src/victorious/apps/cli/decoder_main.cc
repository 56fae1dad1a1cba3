// The program victorious-decoder: reads files that may be hostile, in a process without rights
// (base/isolated_process.h). `victorious` starts it by itself.
#include <array>
#include <string>
#include <string_view>

#include <opencv2/core/utility.hpp>

#include "victorious/apps/decoder/frame_source.h"
#include "victorious/base/isolated_main.h"
#include "victorious/category/network/network_request.h"
#include "victorious/category/network/network_runner.h"
#include "victorious/input/image/pixel_limit.h"
#include "victorious/object/mesh/import_request.h"
#include "victorious/place/cameras/camera_request.h"

namespace victorious::cli {
namespace {

// What the page asks about one video.
Expected<std::string> AnswerPage(FrameSource& frames, std::string_view request) {
  const char kind = request.front();
  request.remove_prefix(1);
  return kind == kCameraRequest ? AnswerCameraRequest(request) : frames.Answer(request);
}

int RunDecoder(int argc, char** argv) {
  cv::setNumThreads(1);                // the memory that is allowed is for the image, not for the stacks of threads
  LimitImagePixels(kMaxServedPixels);  // textures have a limit of their own
  FrameSource frames;
  NetworkRunner network;
  const std::array<IsolatedFunction, 3> functions = {
      {{kMeshImport, &ImportMeshRequest},
       {kRunNetwork, [&](std::string_view request) { return network.Answer(request); }},
       {kPage, [&](std::string_view request) { return AnswerPage(frames, request); }}}};
  return RunIsolatedFunction(argc, argv, functions);
}

}  // namespace
}  // namespace victorious::cli

int main(int argc, char** argv) { return victorious::cli::RunDecoder(argc, argv); }
