#include "victorious/apps/serve/access_log.h"

#include <array>
#include <cerrno>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sodium.h>
#include <sys/file.h>
#include <unistd.h>

#include "victorious/base/json.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

constexpr std::string_view kHead = R"({"format":"victorious access log","version":1})";
constexpr std::string_view kHashField = R"(,"hash":")";
constexpr std::string_view kLineEnd = R"("})";
constexpr std::size_t kHashLetters = std::size_t{2} * crypto_hash_sha256_BYTES;

// Of an entry, without its hash, that follows another one.
std::string HashOf(std::string_view former_hash, std::string_view content) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  const std::string text = fmt::format("{}\n{}", former_hash, content);
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size());
  std::string letters;
  for (const unsigned char byte : digest) letters += fmt::format("{:02x}", byte);
  return letters;
}

// The hash that a line has, if it is the one that it must have.
std::optional<std::string> FollowingHash(std::string_view former_hash, std::string_view line) {
  const std::size_t tail = kHashField.size() + kHashLetters + kLineEnd.size();
  if (line.size() <= tail || !line.ends_with(kLineEnd)) return std::nullopt;
  const std::string_view content = line.substr(0, line.size() - tail);
  const std::string expected = HashOf(former_hash, content);
  if (line.substr(content.size()) != fmt::format("{}{}{}", kHashField, expected, kLineEnd)) return std::nullopt;
  return expected;
}

}  // namespace

bool IsAccessLog(std::string_view first_bytes) {
  constexpr std::string_view kBegin = R"({"format":"victo)";
  return first_bytes.starts_with(kBegin);
}

Expected<AccessLogSummary> VerifyAccessLog(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::unexpected(ErrorFromErrno(errno, path.string()));
  AccessLogSummary summary{.last_hash = HashOf("", kHead)};
  std::string line;
  for (std::int64_t number = 1; std::getline(file, line); ++number) {
    if (file.eof()) {  // without the end of a line
      summary.is_cut_off = true;
      break;
    }
    std::optional<std::string> hash;
    if (number == 1) {
      if (line == kHead) hash = summary.last_hash;
    } else {
      hash = FollowingHash(summary.last_hash, line);
      ++summary.entries;
    }
    if (!hash) {
      return Fail(ErrorCode::kDataLoss,
                  fmt::format("{}: line {} is not the one that was written there: lines were changed, removed or "
                              "added; compare with a copy, and keep this file as it is",
                              path.string(), number));
    }
    summary.last_hash = *hash;
    summary.complete_bytes += line.size() + 1;
  }
  if (file.bad()) return std::unexpected(ErrorFromErrno(EIO, path.string()));
  return summary;
}

Expected<std::unique_ptr<AccessLog>> AccessLog::Open(const std::filesystem::path& path) {
  constexpr mode_t kOnlyOwner = 0600;
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, kOnlyOwner);
  if (descriptor < 0) return std::unexpected(ErrorFromErrno(errno, path.string()));
  FileDescriptor file(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return Fail(ErrorCode::kConflict, fmt::format("{}: another server writes it: give each its own", path.string()));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const AccessLogSummary summary, VerifyAccessLog(path));
  if (summary.is_cut_off && ::ftruncate(descriptor, static_cast<off_t>(summary.complete_bytes)) != 0) {
    return std::unexpected(ErrorFromErrno(errno, path.string()));
  }
  std::unique_ptr<AccessLog> log(new AccessLog(path.string(), std::move(file), summary.last_hash));
  if (summary.complete_bytes == 0) VICTORIOUS_RETURN_IF_ERROR(log->Write(fmt::format("{}\n", kHead)));
  return log;
}

Status AccessLog::Append(const AccessEntry& entry) {
  const Json json = {{"time", FormatUtc(entry.time_utc_us)},
                     {"actor", entry.actor},
                     {"client", entry.client},
                     {"target", entry.target},
                     {"status", entry.status}};
  std::string content = DumpJson(json);
  content.pop_back();  // its bracket follows the hash
  const std::scoped_lock lock(mutex_);
  if (failure_) return std::unexpected(*failure_);
  const std::string hash = HashOf(last_hash_, content);
  VICTORIOUS_RETURN_IF_ERROR(Write(fmt::format("{}{}{}{}\n", content, kHashField, hash, kLineEnd)));
  last_hash_ = hash;
  return {};
}

Status AccessLog::Write(std::string_view line) {
  while (!line.empty()) {
    const ssize_t written = ::write(file_.fd(), line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      // A part of the line may be there: what follows would not belong to it.
      failure_ = ErrorFromErrno(errno, name_);
      return std::unexpected(*failure_);
    }
    line.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

}  // namespace victorious
