// A file that a task needs, named by its content, and the place from which workers fetch it: a folder PLACE with the
// files PLACE/ab/abcdef…, by the hexadecimal digits of their hash. Workers read it as a folder, or over HTTP from any
// web server that shows it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

struct ContentFile {
  std::string path;        ///< absolute, at whoever submitted it
  std::string content_id;  ///< its hash: ContentId (base/file.h)
  std::int64_t bytes = 0;

  bool operator==(const ContentFile&) const = default;
};

/// Whether the values can be those of a file: an absolute path without "..", 32 hexadecimal digits, at least 0 bytes.
[[nodiscard]] bool IsValid(const ContentFile& file);

/// Where it lies below its place.
[[nodiscard]] std::filesystem::path PathInPlace(const ContentFile& file);

/// Reads and hashes a file. Errors: those of ContentId.
[[nodiscard]] Expected<ContentFile> DescribeFile(const std::filesystem::path& file, const CancelToken& cancel);

/// Puts a file into a place: as a link where that is on the same file system, else as a copy. What lies there with the
/// same content stays. Errors: those of the file system.
[[nodiscard]] Status PublishFile(const ContentFile& file, const std::filesystem::path& place,
                                 const CancelToken& cancel);

}  // namespace victorious
