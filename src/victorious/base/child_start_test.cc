#include "victorious/base/child_start.h"

#include <array>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace victorious {
namespace {

// What a child that starts with `script` writes to its descriptor.
std::string OutputOf(const std::string& script) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
  const auto child = StartChild({.executable = "/bin/sh", .arguments = {"sh", "-c", script}, .descriptor = ends[1]});
  ::close(ends[1]);
  EXPECT_TRUE(child);
  std::string output;
  std::array<char, 256> bytes;
  for (ssize_t got = 0; (got = ::read(ends[0], bytes.data(), bytes.size())) > 0;) {
    output.append(bytes.data(), static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  EXPECT_EQ(::waitpid(*child, nullptr, 0), *child);
  return output;
}

// A listening socket of a server, as Asio opens it, and what other libraries keep open.
TEST(StartChild, InheritsWhatItIsGivenOnly) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);  // NOLINT(android-cloexec-socket): the case that is tested
  ASSERT_GE(::fcntl(socket, F_DUPFD, 200), 200);
  ASSERT_EQ(::dup2(socket, 300), 300);
  EXPECT_EQ(OutputOf("for f in 200 300 3; do test -e /proc/$$/fd/$f && echo $f; done >&3"), "3\n");
  for (const int descriptor : {200, 300, socket}) ::close(descriptor);
}

TEST(StartChild, GivesADescriptorOfAnyNumber) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
  const int saved = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
  ::dup2(ends[1], STDIN_FILENO);  // as in a program that was started without standard input
  const auto child =
      StartChild({.executable = "/bin/sh", .arguments = {"sh", "-c", "echo hello >&3"}, .descriptor = STDIN_FILENO});
  if (saved >= 0) ::dup2(saved, STDIN_FILENO);
  ::close(ends[1]);
  ASSERT_TRUE(child);
  std::array<char, 16> bytes;
  EXPECT_EQ(::read(ends[0], bytes.data(), bytes.size()), 6);
  ::close(ends[0]);
  if (saved >= 0) ::close(saved);
  ::waitpid(*child, nullptr, 0);
}

TEST(StartChild, ProgramThatCannotBeExecutedEndsTheChild) {
  const auto child = StartChild({.executable = "/nowhere/program", .arguments = {"program"}, .descriptor = 0});
  ASSERT_TRUE(child);
  int status = 0;
  ::waitpid(*child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 127);
}

}  // namespace
}  // namespace victorious
