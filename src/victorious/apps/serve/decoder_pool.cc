#include "victorious/apps/serve/decoder_pool.h"

#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "victorious/apps/decoder/frame_request.h"
#include "victorious/apps/serve/static_files.h"
#include "victorious/base/folder.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxIdle = 4;
constexpr std::uint64_t kDecoderBytes = std::uint64_t{3} << 29;  // of an image of kMaxServedPixels with 16-bit samples
constexpr unsigned kDecoderSeconds = 900;  // CPU time of all its answers, which are limited by the clock

// A file that was replaced, or a folder that got images, is another video.
std::string DecoderKey(const fs::path& video) {
  std::error_code error;
  if (!fs::is_directory(video, error)) return video.string() + " " + FileEtag(video);
  return fmt::format("{} {}", video.string(), fs::last_write_time(video, error).time_since_epoch().count());
}

// The file; of a folder also the files elsewhere that links in it lead to.
std::vector<fs::path> ReadableFiles(const fs::path& video) {
  std::vector<fs::path> files = {video};
  std::error_code error;
  if (!fs::is_directory(video, error)) return files;
  for (const fs::path& entry : ListFolder(video).value_or(std::vector<fs::path>())) {
    if (fs::is_symlink(entry, error)) files.push_back(entry);
  }
  return files;
}

// Without a group of its own, Ctrl-C in the terminal would end answers that the server still finishes.
Expected<IsolatedProcess> StartOrigin() { return IsolatedProcess::Start(kPage, {.has_own_group = true}); }

// The errors of the process itself do not name the video.
Expected<std::string> AskNamed(IsolatedProcess& process, const fs::path& video, std::string_view request,
                               const AskOptions& options) {
  Expected<std::string> answer = process.Ask(request, options);
  if (answer || process.IsRunning()) return answer;
  return std::unexpected(std::move(answer).error().WithContext(video.string()));
}

}  // namespace

DecoderPool::DecoderPool() {
  // Who asks gets the error.
  if (Expected<IsolatedProcess> started = StartOrigin()) origin_.emplace(*std::move(started));
}

Expected<std::string> DecoderPool::Ask(const fs::path& video, std::string_view request, const AskOptions& options) {
  const std::string key = DecoderKey(video);
  if (std::optional<Decoder> idle = TakeIdle(key)) {
    Expected<std::string> answer = idle->process.Ask(request, options);
    const bool is_running = idle->process.IsRunning();
    Keep(*std::move(idle));
    const bool is_cancelled = !answer && answer.error().code == ErrorCode::kCancelled;
    if (is_running || is_cancelled) return answer;
    // It may have ended while it waited, or at the end of its processor time: another one is asked once.
  }
  VICTORIOUS_ASSIGN_OR_RETURN(Decoder decoder, StartFor(video, key, {}));
  Expected<std::string> answer = AskNamed(decoder.process, video, request, options);
  Keep(std::move(decoder));
  return answer;
}

Expected<std::string> DecoderPool::AskOnce(const fs::path& video, const std::vector<fs::path>& files,
                                           std::string_view request, const AskOptions& options) {
  VICTORIOUS_ASSIGN_OR_RETURN(Decoder decoder, StartFor(video, "", files));
  return AskNamed(decoder.process, video, request, options);
}

Expected<IsolatedProcess> DecoderPool::CopyOrigin() {
  const std::scoped_lock lock(origin_mutex_);
  if (origin_) {
    Expected<IsolatedProcess> copy = origin_->Copy();
    if (copy) return copy;
    origin_.reset();  // somebody has killed it, or the thread that started it has ended
  }
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess started, StartOrigin());
  return origin_.emplace(std::move(started)).Copy();
}

std::optional<DecoderPool::Decoder> DecoderPool::TakeIdle(const std::string& key) {
  const std::scoped_lock lock(mutex_);
  for (auto it = idle_.begin(); it != idle_.end(); ++it) {
    if (it->key != key) continue;
    std::optional<Decoder> found(std::move(*it));
    idle_.erase(it);
    return found;
  }
  return std::nullopt;
}

Expected<DecoderPool::Decoder> DecoderPool::StartFor(const fs::path& video, const std::string& key,
                                                     const std::vector<fs::path>& files) {
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess process, CopyOrigin());
  std::vector<fs::path> readable = ReadableFiles(video);
  readable.insert(readable.end(), files.begin(), files.end());
  process.Confine({.memory_bytes = kDecoderBytes, .processor_s = kDecoderSeconds, .readable = std::move(readable)});
  return Decoder{key, std::move(process)};
}

void DecoderPool::Keep(Decoder decoder) {
  std::list<Decoder> ended;  // they are waited for without the lock
  if (!decoder.process.IsRunning()) return;
  {
    const std::scoped_lock lock(mutex_);
    idle_.push_front(std::move(decoder));
    if (idle_.size() > kMaxIdle) ended.splice(ended.begin(), idle_, std::prev(idle_.end()));
  }
}

}  // namespace victorious
