#include "victorious/store/postgres/connection_error.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/store/postgres/connection.h"

namespace victorious::postgres {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Error ErrorOf(const std::string& message) {
  return ErrorFromFailure("postgresql://me@host/videos", ParseConnectionFailure(message));
}

TEST(ConnectionFailure, HasTheCodeInEveryLanguage) {
  const ConnectionFailure english = ParseConnectionFailure(
      "connection to server on socket \"/run/.s.PGSQL.5432\" failed: FATAL:  3D000: database "
      "\"none\" does not exist\nLOCATION:  InitPostgres, postinit.c:919\n");
  EXPECT_EQ(english.sqlstate, "3D000");
  EXPECT_EQ(english.text,
            "connection to server on socket \"/run/.s.PGSQL.5432\" failed: FATAL: database \"none\" does not exist");
  const ConnectionFailure french = ParseConnectionFailure(
      "la connexion au serveur a échoué : FATAL:  28P01: authentification par mot de passe échouée\n");
  EXPECT_EQ(french.sqlstate, "28P01");
  const ConnectionFailure unset =
      ParseConnectionFailure("connection to server failed: fe_sendauth: no password supplied");
  EXPECT_EQ(unset.sqlstate, "");
  EXPECT_EQ(unset.text, "connection to server failed: fe_sendauth: no password supplied");
  for (const char* text : {"", ":  ", ":  3D0", ":  3D000", ":  3d000: x", ": 3D000: x"}) {
    EXPECT_EQ(ParseConnectionFailure(text).sqlstate, "") << text;
  }
}

TEST(ConnectionFailure, FollowsTheCodeAndNotTheWords) {
  EXPECT_EQ(ErrorOf("x: FATAL:  53300: zu viele Verbindungen\n").code, ErrorCode::kUnavailable);
  EXPECT_THAT(ErrorOf("x: FATAL:  53300: zu viele Verbindungen\n").message, HasSubstr("max_connections"));
  EXPECT_EQ(ErrorOf("x: FATAL:  3D000: Datenbank >>none<< existiert nicht\n").code, ErrorCode::kNotFound);
  EXPECT_EQ(ErrorOf("x: FATAL:  57P03: das Datenbanksystem startet\n").code, ErrorCode::kUnavailable);
  EXPECT_EQ(ErrorOf("x: FATAL:  42501: keine Berechtigung\n").code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(ErrorOf("x: FATAL:  22023: ungültiger Wert\n").code, ErrorCode::kInvalidArgument);
  // A role may be called as the words of another error.
  const Error refused = ErrorOf("x: FATAL:  28P01: password failed for \"database that does not exist\"\n");
  EXPECT_EQ(refused.code, ErrorCode::kPermissionDenied);
  EXPECT_THAT(refused.message, HasSubstr("correct the role and its password"));
  EXPECT_THAT(ErrorOf("x: fe_sendauth: no password supplied\n").message, HasSubstr("PGPASSWORD"));
}

// No part of a password is printed, whether the address can be read or not (RFC 3986, 3.2.1).
TEST(ConnectionUrl, PasswordsWithReservedCharactersStaySecret) {
  for (const char* const password : {"p@ss/w%rd", "pa/ss", "p@ss", "pa%ss", "pass%4"}) {
    const std::string url = std::string("postgresql://user:") + password + "@nohost.invalid/db";
    const auto connection = Connection::Open(url, true, "", std::nullopt);
    ASSERT_FALSE(connection) << password;
    EXPECT_EQ(connection.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(connection.error().message, HasSubstr("%2F"));
    EXPECT_THAT(connection.error().message, Not(HasSubstr(password))) << password;
    EXPECT_EQ(TakePassword(url).name, "postgresql://user@nohost.invalid/db");
  }
}

}  // namespace
}  // namespace victorious::postgres
