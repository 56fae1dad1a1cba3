// Passwords, and the secrets of sessions and tokens (libsodium). Input: what a user gives. Output: what may be stored.
//
// A password is stored as its Argon2id hash (RFC 9106) with 64 MiB and 2 passes, about a tenth of a second of one core:
// a stolen index does not give the passwords away. The secret of a session or token is 256 random bits, which nobody
// guesses, so a plain BLAKE2b digest of it is stored.
#pragma once

#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

inline constexpr std::size_t kMinPasswordBytes = 12;
inline constexpr std::size_t kMaxPasswordBytes = 1024;

/// Error: kInvalidArgument unless it has 12 to 1024 bytes.
[[nodiscard]] Status CheckPassword(std::string_view password);

/// Errors: those of CheckPassword; kInternal if there is no memory for it.
[[nodiscard]] Expected<std::string> HashPassword(std::string_view password);

/// True if `hash` is of this password. Takes as long as HashPassword. False for a text that is no hash.
[[nodiscard]] bool IsPassword(std::string_view password, const std::string& hash);

/// As long as IsPassword on a hash, for names without an account: the time does not tell which names exist.
void SpendPasswordTime(std::string_view password);

/// Returns a new secret: 43 characters of A-Z a-z 0-9 - _.
[[nodiscard]] Expected<std::string> MakeSecret();

/// Returns 64 hexadecimal digits.
[[nodiscard]] std::string DigestSecret(std::string_view secret);

}  // namespace victorious
