// The program victorious-decoder: reads files that may be hostile, in a process without rights
// (base/isolated_process.h). `victorious` starts it by itself.
#include <array>

#include <opencv2/core/utility.hpp>

#include "victorious/base/isolated_main.h"
#include "victorious/decoder/frame_source.h"
#include "victorious/image/pixel_limit.h"
#include "victorious/mesh/import_request.h"

int main(int argc, char** argv) {
  using victorious::IsolatedFunction;
  cv::setNumThreads(1);  // the memory that is allowed is for the image, not for the stacks of threads
  victorious::LimitImagePixels(victorious::kMaxServedPixels);  // textures have a limit of their own
  victorious::FrameSource frames;
  const std::array<IsolatedFunction, 2> functions = {
      {{victorious::kMeshImport, &victorious::ImportMeshRequest},
       {victorious::kFrames, [&](std::string_view request) { return frames.Answer(request); }}}};
  return victorious::RunIsolatedFunction(argc, argv, functions);
}
