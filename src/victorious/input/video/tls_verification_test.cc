#include "victorious/input/video/tls_verification.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/loopback_server.h"
#include "victorious/input/video/trusted_certificates.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(TlsVerification, CanBeTurnedOn) {
  EXPECT_TRUE(VerifyCertificates());
  EXPECT_TRUE(CheckVerifies("rtsps", "rtsps://host/camera"));
}

TEST(TlsVerification, CertificatesAreThoseOfAFile) {
  const testing::ScratchFolder folder;
  EXPECT_EQ(TrustCertificates(folder / "absent.pem").error().code, ErrorCode::kNotFound);
  std::ofstream(folder / "key.pem") << "-----BEGIN PRIVATE KEY-----\nMIG\n-----END PRIVATE KEY-----\n";
  const Status refused = TrustCertificates(folder / "key.pem");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("--ca"), HasSubstr("key.pem")));
  EXPECT_TRUE(TrustedCertificates().empty());
}

// What answers without TLS learns nothing, and the error says what is wrong.
TEST(TlsVerification, ServersWithoutTlsAreErrors) {
  for (const char* scheme : {"rtsps", "https", "rtmps"}) {
    testing::LoopbackServer server;
    server.Serve("RTSP/1.0 200 OK\r\n\r\n", 0);
    const auto reader = VideoReader::Open(server.Url(scheme), {.open_timeout_s = 60});
    ASSERT_FALSE(reader) << scheme;
    EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(reader.error().message, HasSubstr("no encrypted connection")) << scheme;
  }
}

// The next source is not blamed for what another one did.
TEST(TlsVerification, FaultsAreForgotten) {
  testing::LoopbackServer server;
  server.Serve("no TLS", 0);
  EXPECT_FALSE(VideoReader::Open(server.Url("rtsps"), {.open_timeout_s = 60}));
  EXPECT_EQ(TakeTlsFault(), "");
}

}  // namespace
}  // namespace victorious
