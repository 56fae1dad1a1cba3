// Reports the capabilities of the linked FFmpeg libraries, for `victorious doctor`.
#pragma once

#include <string>
#include <vector>

namespace victorious {

struct CodecReport {
  std::string libraries;              ///< names and versions: "libavformat 59.27.100, …"
  std::vector<std::string> decoders;  ///< available decoders, of a fixed list of common video codecs
  std::vector<std::string> missing;   ///< missing decoders, of the same list
  bool h264_encoder = false;          ///< true if libx264 is available (required by VideoWriter)
};

/// Queries libavformat and libavcodec.
CodecReport DescribeCodecs();

}  // namespace victorious
