#include "victorious/apps/serve/secret.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::StartsWith;

TEST(SecretTest, PasswordIsKnownByItsHash) {
  const std::string password = "correct horse battery";
  const auto hash = HashPassword(password);
  ASSERT_TRUE(hash) << hash.error().message;
  EXPECT_THAT(*hash, StartsWith("$argon2id$"));
  EXPECT_TRUE(IsPassword(password, *hash));
  EXPECT_FALSE(IsPassword("correct horse batterx", *hash));
  EXPECT_FALSE(IsPassword("", *hash));
  EXPECT_NE(*HashPassword(password), *hash) << "each hash has its own salt";
}

TEST(SecretTest, BrokenHashesAreNoPassword) {
  for (const std::string hash : {"", "x", "$argon2id$", "$argon2id$v=19$m=99999999999,t=2,p=1$a$b"}) {
    EXPECT_FALSE(IsPassword("correct horse battery", hash)) << hash;
  }
  EXPECT_FALSE(IsPassword("a", std::string(1000, '$')));
  EXPECT_FALSE(IsPassword(std::string(2000, 'a'), "$argon2id$"));
}

TEST(SecretTest, PasswordsHaveALength) {
  EXPECT_FALSE(CheckPassword("eleven char"));
  EXPECT_TRUE(CheckPassword("twelve chars"));
  EXPECT_TRUE(CheckPassword(std::string(1024, 'a')));
  EXPECT_EQ(CheckPassword(std::string(1025, 'a')).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(HashPassword("short").error().code, ErrorCode::kInvalidArgument);
}

TEST(SecretTest, SecretsAreNewAndTheirDigestsFixed) {
  std::set<std::string> secrets;
  for (int i = 0; i < 100; ++i) secrets.insert(*MakeSecret());
  EXPECT_EQ(secrets.size(), 100U);
  for (const std::string& secret : secrets) {
    EXPECT_EQ(secret.size(), 43U);
    EXPECT_EQ(secret.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
              std::string::npos);
  }
  // BLAKE2b with 32 bytes of "abc".
  EXPECT_EQ(DigestSecret("abc"), "bddd813c634239723171ef3fee98579b94964e3bb1cb3e427262c8c068d52319");
  EXPECT_NE(DigestSecret("abd"), DigestSecret("abc"));
}

}  // namespace
}  // namespace victorious
