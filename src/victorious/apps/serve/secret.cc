#include "victorious/apps/serve/secret.h"

#include <array>
#include <cstring>

#include <fmt/format.h>
#include <sodium.h>

#include "victorious/base/check.h"

namespace victorious {
namespace {

constexpr unsigned long long kPasses = crypto_pwhash_argon2id_OPSLIMIT_INTERACTIVE;
constexpr std::size_t kMemoryBytes = crypto_pwhash_argon2id_MEMLIMIT_INTERACTIVE;

// Selects the processor's instructions and opens the source of random numbers; may be called again.
bool IsReady() { return sodium_init() >= 0; }

}  // namespace

Status CheckPassword(std::string_view password) {
  if (password.size() >= kMinPasswordBytes && password.size() <= kMaxPasswordBytes) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("the password must have {} to {} bytes: most letters are one each", kMinPasswordBytes,
                          kMaxPasswordBytes));
}

Expected<std::string> HashPassword(std::string_view password) {
  VICTORIOUS_RETURN_IF_ERROR(CheckPassword(password));
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  if (!IsReady() || crypto_pwhash_str_alg(hash.data(), password.data(), password.size(), kPasses, kMemoryBytes,
                                          crypto_pwhash_ALG_ARGON2ID13) != 0) {
    return Fail(ErrorCode::kInternal,
                fmt::format("the password cannot be hashed: {} MiB of memory are needed", kMemoryBytes >> 20));
  }
  return std::string(hash.data());
}

bool IsPassword(std::string_view password, const std::string& hash) {
  if (password.size() > kMaxPasswordBytes || hash.size() >= crypto_pwhash_STRBYTES || !IsReady()) return false;
  return crypto_pwhash_str_verify(hash.c_str(), password.data(), password.size()) == 0;
}

void SpendPasswordTime(std::string_view password) {
  std::array<unsigned char, 32> key{};
  constexpr std::array<unsigned char, crypto_pwhash_SALTBYTES> kSalt{};
  if (password.size() > kMaxPasswordBytes || !IsReady()) return;
  [[maybe_unused]] const int failed = crypto_pwhash(key.data(), key.size(), password.data(), password.size(),
                                                    kSalt.data(), kPasses, kMemoryBytes, crypto_pwhash_ALG_ARGON2ID13);
}

Expected<std::string> MakeSecret() {
  if (!IsReady()) return Fail(ErrorCode::kInternal, "the system gives no random numbers");
  std::array<unsigned char, 32> bytes{};
  randombytes_buf(bytes.data(), bytes.size());
  constexpr int kVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
  std::array<char, sodium_base64_ENCODED_LEN(32, sodium_base64_VARIANT_URLSAFE_NO_PADDING)> text{};
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), kVariant);
  return std::string(text.data());
}

std::string DigestSecret(std::string_view secret) {
  std::array<unsigned char, crypto_generichash_BYTES> digest{};
  const int failed = crypto_generichash(
      digest.data(), digest.size(), reinterpret_cast<const unsigned char*>(secret.data()), secret.size(), nullptr, 0);
  VICTORIOUS_CHECK(failed == 0);
  std::array<char, 2 * crypto_generichash_BYTES + 1> text{};
  sodium_bin2hex(text.data(), text.size(), digest.data(), digest.size());
  return {text.data()};
}

}  // namespace victorious
