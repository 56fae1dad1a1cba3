// What this build of FFmpeg's libraries can do, for `victorious doctor`.
#pragma once

#include <string>
#include <vector>

namespace victorious {

struct CodecReport {
  std::string libraries;              ///< "libavformat 59.27.100, …"
  std::vector<std::string> decoders;  ///< of the usual video codecs, those that are there
  std::vector<std::string> missing;   ///< of the usual video codecs, those that are not
  bool h264_encoder = false;          ///< libx264, which VideoWriter needs
};

CodecReport DescribeCodecs();

}  // namespace victorious
