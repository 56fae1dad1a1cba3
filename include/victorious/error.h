// The one exception of the library. What a function documents after "Errors" it throws as an Error with that code;
// apart from std::bad_alloc it throws nothing else. No detection, too few matches and an unknown place are results, not
// errors.
#pragma once

#include <stdexcept>
#include <string>

#include <victorious/export.h>

namespace libvictorious {

/// The closed set of reasons. More may follow after the last one.
enum class ErrorCode {
  kInvalidArgument,   ///< an unusable value, file or parameter: the caller must change it
  kNotFound,          ///< the named item does not exist
  kAlreadyExists,     ///< the name is taken
  kDataLoss,          ///< external data that is corrupt, truncated or of another program
  kUnsupported,       ///< well-formed, but of a kind or version that the library does not read
  kPermissionDenied,  ///< a read-only folder or file
  kNoSpace,           ///< a full disk
  kConflict,          ///< another process does the same work: try again later
  kCancelled,         ///< a callback of the caller ended the operation
  kInternal,          ///< a library or the system failed for a reason that the input does not explain
  kUnavailable,       ///< what is needed, as a database, does not answer or is locked by others: try again later
};

/// what() is one line in UTF-8: what is wrong, where, and what would be right.
class LIBVICTORIOUS_EXPORT Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message);
  Error(const Error& other);
  Error& operator=(const Error& other);
  ~Error() override;

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

/// The code's name as the command line and the server write it: "not_found".
LIBVICTORIOUS_EXPORT const char* Name(ErrorCode code) noexcept;

}  // namespace libvictorious
