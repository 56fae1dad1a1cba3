#include "victorious/input/video/read_address.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "victorious/input/video/demuxer.h"
#include "victorious/input/video/tls_verification.h"

extern "C" {
#include <libavutil/dict.h>
}

namespace victorious {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kReadBytes = std::size_t{1} << 18;

struct AddressCloser {
  void operator()(AVIOContext* context) const { avio_close(context); }
};

// Says for each call of FFmpeg when it is to give up.
class ReadDeadline {
 public:
  explicit ReadDeadline(const AddressOptions& options) : options_(options) { Start(); }

  void Start() {
    deadline_ =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.timeout_s));
  }

  [[nodiscard]] bool IsTimedOut() const { return Clock::now() > deadline_; }
  [[nodiscard]] bool IsStopped() {
    is_stopped_ = is_stopped_ || (options_.is_stopped && options_.is_stopped());
    return is_stopped_;
  }

  [[nodiscard]] AVIOInterruptCB callback() {
    return {[](void* self) {
              auto& deadline = *static_cast<ReadDeadline*>(self);
              return deadline.IsTimedOut() || deadline.IsStopped() ? 1 : 0;
            },
            this};
  }

 private:
  const AddressOptions& options_;
  Clock::time_point deadline_;
  bool is_stopped_ = false;
};

bool IsRefusalOfServer(int result) {
  return result == AVERROR_HTTP_BAD_REQUEST || result == AVERROR_HTTP_UNAUTHORIZED ||
         result == AVERROR_HTTP_FORBIDDEN || result == AVERROR_HTTP_NOT_FOUND || result == AVERROR_HTTP_OTHER_4XX;
}

Error AddressError(const std::string& address, int result, bool is_opened, ReadDeadline& deadline,
                   const AddressOptions& options) {
  if (deadline.IsStopped()) return {ErrorCode::kCancelled, fmt::format("{}: stopped while it was read", address)};
  if (!IsWebAddress(address)) return ErrorFromErrno(AVUNERROR(result), address);
  if (deadline.IsTimedOut()) {
    return {ErrorCode::kUnavailable, fmt::format("{}: nothing came for {:g} s", address, options.timeout_s)};
  }
  if (const std::string fault = TakeTlsFault(); !is_opened && !fault.empty()) {
    return {ErrorCode::kUnavailable, fmt::format("{}: {}", address, fault)};
  }
  const ErrorCode code = is_opened                   ? ErrorCode::kDataLoss
                         : IsRefusalOfServer(result) ? ErrorCode::kNotFound
                                                     : ErrorCode::kUnavailable;
  return {code, fmt::format("{}: {}{}", address, is_opened ? "cut off: " : "", FfmpegErrorText(result))};
}

}  // namespace

bool IsWebAddress(const std::string& address) {
  const std::optional<std::string> scheme = UrlScheme(address);
  return scheme == "http" || scheme == "https";
}

Status ReadAddress(const std::string& address, const AddressOptions& options,
                   const std::function<Status(std::span<const std::byte>)>& sink) {
  PrepareFfmpeg();
  const bool is_of_web = IsWebAddress(address);
  if (is_of_web) VICTORIOUS_RETURN_IF_ERROR(CheckVerifies(UrlScheme(address).value_or(""), address));
  static_cast<void>(TakeTlsFault());  // of another connection
  AVDictionary* settings = nullptr;
  av_dict_set(&settings, "protocol_whitelist", is_of_web ? "http,https,httpproxy,crypto,tcp,tls" : "file", 0);
  ReadDeadline deadline(options);
  const AVIOInterruptCB interrupt = deadline.callback();
  AVIOContext* opened = nullptr;
  const std::string url = is_of_web ? address : "file:" + address;
  int result = avio_open2(&opened, url.c_str(), AVIO_FLAG_READ, &interrupt, &settings);
  av_dict_free(&settings);
  if (result < 0) return std::unexpected(AddressError(address, result, false, deadline, options));
  const std::unique_ptr<AVIOContext, AddressCloser> context(opened);
  const std::int64_t announced = avio_size(context.get());  // negative: not known
  std::int64_t done = 0;
  std::vector<std::byte> buffer(kReadBytes);
  while (announced <= 0 || done < announced) {
    deadline.Start();
    if (deadline.IsStopped()) return std::unexpected(AddressError(address, AVERROR_EXIT, true, deadline, options));
    result = avio_read_partial(context.get(), reinterpret_cast<unsigned char*>(buffer.data()),
                               static_cast<int>(buffer.size()));
    if (result == AVERROR_EOF && announced <= 0) return {};
    if (result < 0) return std::unexpected(AddressError(address, result, true, deadline, options));
    done += result;
    VICTORIOUS_RETURN_IF_ERROR(sink(std::span(buffer).first(static_cast<std::size_t>(result))));
  }
  return {};
}

}  // namespace victorious
