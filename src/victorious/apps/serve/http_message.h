// HTTP requests and responses as plain values: what the routes (api.h) read and return. http_server.h converts them to
// and from the wire.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "victorious/base/cancel.h"

namespace victorious {

enum class HttpMethod { kGet, kHead, kPut, kPost, kDelete, kOther };

/// A received request. A header that was not sent is empty.
struct HttpRequest {
  HttpMethod method = HttpMethod::kGet;
  std::string target;  ///< as sent: path and query
  std::string host;
  std::string origin;
  std::string fetch_site;  ///< Sec-Fetch-Site: how the page that sends the request relates to this server
  std::string content_type;
  std::string range;
  std::string if_range;
  std::string if_none_match;
  std::string cookie;
  std::string authorization;
  std::string client;  ///< IP address of the sender
  std::string body;
  std::optional<std::filesystem::path> upload;  ///< the file that holds the body instead (UploadPlan)
};

/// A part of a file, sent without being read into memory.
struct FileSlice {
  std::filesystem::path path;
  std::int64_t offset = 0;                ///< bytes
  std::int64_t length = 0;                ///< bytes
  std::shared_ptr<const void> hold = {};  ///< kept until the part is sent
};

/// Where the body of a request goes that is too large for memory. The file must
/// not be there. Unless the request is answered with status 200, the file is removed,
/// and its folder if it is empty then.
struct UploadPlan {
  std::filesystem::path file;
  std::uint64_t max_bytes = 0;
};

/// A response without an end: what is to be sent, as it comes.
class EventFeed {
 public:
  virtual ~EventFeed() = default;
  /// What has come since the last call; empty: nothing. Does not wait. Called
  /// by one thread at a time.
  [[nodiscard]] virtual std::string Take() = 0;
};

struct HttpResponse;

/// A response that takes long to make. It waits in a queue for one of a few threads, while other requests are answered.
struct SlowResponse {
  std::string client;  ///< whose share of the queue it takes
  /// @param left  the client has left: the response is not needed. Must not throw.
  std::function<HttpResponse(const CancelToken& left)> make;
};

struct HttpResponse {
  int status = 200;
  std::string content_type;  ///< empty: no content
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;                    ///< ignored if `file` is set
  std::optional<FileSlice> file;       ///< the body
  std::shared_ptr<EventFeed> events;   ///< the body, until the client leaves
  std::shared_ptr<SlowResponse> slow;  ///< makes the response; all else is ignored
};

}  // namespace victorious
