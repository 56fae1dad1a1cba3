// Why a connection to a server was not opened. libpq gives no code for it, only a text, whose words are in the language
// of the server: lc_messages, which a client may not set. With PQERRORS_VERBOSE the text holds the code of the server,
// the SQLSTATE, in all languages; what libpq itself found wrong has none.
#pragma once

#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious::postgres {

/// Runs of blanks and line ends become one space: libpq and the server write several lines, a message has one.
[[nodiscard]] std::string CollapseBlanks(std::string_view text);

/// The first of several lines, likewise.
[[nodiscard]] std::string FirstLine(std::string_view text);

struct ConnectionFailure {
  std::string sqlstate;  ///< five digits and capitals (PostgreSQL's manual, appendix A); empty: libpq found the fault
  std::string text;      ///< one line, without the code
};

/// @param message  PQerrorMessage, with PQERRORS_VERBOSE
[[nodiscard]] ConnectionFailure ParseConnectionFailure(std::string_view message);

/// The error, with what would be right: kUnavailable for a server that has no room or starts; kNotFound for a database
/// that is not there; kInvalidArgument for parameters that the server does not know; else kPermissionDenied.
/// @param name  of the database, for the message
[[nodiscard]] Error ErrorFromFailure(const std::string& name, const ConnectionFailure& failure);

}  // namespace victorious::postgres
