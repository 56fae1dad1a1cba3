// The processes that decode videos for the page (decoder/, base/isolated_process.h). Each belongs to one video: it can
// read nothing else, and keeps it open for the next frame. They are copies of one that has started and reads nothing,
// so that a new video does not wait for a program to start. Thread-safe.
#pragma once

#include <cstddef>
#include <filesystem>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/isolated_process.h"

namespace victorious {

class DecoderPool {
 public:
  DecoderPool();

  /// Asks a process of a video.
  /// @param request  for the function kPage (apps/decoder/frame_request.h), about this path
  /// Errors: those of IsolatedProcess::Start and Ask, with the video's name; those of the decoder.
  [[nodiscard]] Expected<std::string> Ask(const std::filesystem::path& video, std::string_view request,
                                          const AskOptions& options);

  /// The same of a process that is not kept.
  /// @param files  that it may read, too
  [[nodiscard]] Expected<std::string> AskOnce(const std::filesystem::path& video,
                                              const std::vector<std::filesystem::path>& files, std::string_view request,
                                              const AskOptions& options);

 private:
  struct Decoder {
    std::string key;  ///< of its video, with the state of the file
    IsolatedProcess process;
  };

  /// A process that belongs to no video.
  [[nodiscard]] Expected<IsolatedProcess> CopyOrigin();
  /// One that waits for this video.
  [[nodiscard]] std::optional<Decoder> TakeIdle(const std::string& key);
  [[nodiscard]] Expected<Decoder> StartFor(const std::filesystem::path& video, const std::string& key,
                                           const std::vector<std::filesystem::path>& files);
  void Keep(Decoder decoder);

  std::mutex mutex_;
  std::mutex origin_mutex_;
  std::optional<IsolatedProcess> origin_;  ///< std::nullopt: it has ended
  std::list<Decoder> idle_;                ///< most recently used first
};

}  // namespace victorious
