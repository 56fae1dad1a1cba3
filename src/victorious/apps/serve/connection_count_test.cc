#include "victorious/apps/serve/connection_count.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(ClientNetwork, IsTheAddressOrItsNetwork) {
  EXPECT_EQ(ClientNetwork("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(ClientNetwork("::ffff:192.0.2.7"), "192.0.2.7") << "of a socket for both";
  EXPECT_EQ(ClientNetwork("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::");
  EXPECT_EQ(ClientNetwork("2001:db8:1:2::9"), "2001:db8:1:2::");
  EXPECT_EQ(ClientNetwork("fe80::1%eth0"), "fe80::");
  EXPECT_EQ(ClientNetwork(""), "");
}

TEST(ConnectionCount, EachClientHasItsOwn) {
  ConnectionCount count(2);
  EXPECT_TRUE(count.Begin("2001:db8::1"));
  EXPECT_TRUE(count.Begin("2001:db8::2"));
  EXPECT_FALSE(count.Begin("2001:db8::3"));
  EXPECT_TRUE(count.Begin("192.0.2.7"));
  count.End("2001:db8::1");
  EXPECT_TRUE(count.Begin("2001:db8::3"));
  EXPECT_FALSE(count.Begin("2001:db8::1"));
  count.End("192.0.2.9");
}

}  // namespace
}  // namespace victorious
