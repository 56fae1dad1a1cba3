// The isolated process of isolated_process_test.cc: functions that misbehave, and functions that try what is forbidden.
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "victorious/base/isolated_main.h"
#include "victorious/base/text.h"

namespace victorious {
namespace {

Expected<std::string> Echo(std::string_view request) { return std::string(request); }

Expected<std::string> Count(std::string_view /*request*/) {
  static int count = 0;
  return std::to_string(++count);
}

Expected<std::string> Refuse(std::string_view /*request*/) {
  return Fail(ErrorCode::kUnsupported, "too round: square is right");
}

Expected<std::string> Shout(std::string_view /*request*/) {
  return Fail(ErrorCode::kDataLoss, "two\nlines " + std::string(100'000, 'x'));
}

Expected<std::string> Raise(std::string_view request) {
  std::raise(static_cast<int>(ParseInteger(request).value()));
  return "survived";
}

Expected<std::string> Spin(std::string_view /*request*/) {
  for (const volatile bool forever = true; forever;) {
  }
  return "";
}

Expected<std::string> Sleep(std::string_view /*request*/) {
  while (true) ::pause();
}

Expected<std::string> Allocate(std::string_view request) {
  return std::string(static_cast<std::size_t>(ParseInteger(request).value()), 'x');
}

Expected<std::string> Lie(std::string_view /*request*/) {
  constexpr std::string_view kNoMessage = "0123456789abcdef0123456789abcdef";
  return ::write(3, kNoMessage.data(), kNoMessage.size()) > 0 ? "" : "cannot write";
}

Expected<std::string> Leave(std::string_view /*request*/) { ::_exit(0); }

// "allowed", or the error.
std::string Outcome(long result) {
  if (result >= 0) return "allowed";
  return errno == EPERM || errno == EACCES || errno == ENOSYS ? "refused" : "error " + std::to_string(errno);
}

Expected<std::string> Read(std::string_view request) {
  return Outcome(::open(std::string(request).c_str(), O_RDONLY | O_CLOEXEC));
}

Expected<std::string> Write(std::string_view request) {
  return Outcome(::open(std::string(request).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
}

Expected<std::string> Remove(std::string_view request) { return Outcome(::unlink(std::string(request).c_str())); }

Expected<std::string> Connect(std::string_view /*request*/) { return Outcome(::socket(AF_INET, SOCK_STREAM, 0)); }

Expected<std::string> Fork(std::string_view /*request*/) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  if (child > 0) ::waitpid(child, nullptr, 0);
  return Outcome(child);
}

Expected<std::string> Execute(std::string_view /*request*/) {
  std::string program = "/bin/true";
  std::array<char*, 2> argv = {program.data(), nullptr};
  return Outcome(::execv(program.c_str(), argv.data()));
}

Expected<std::string> KillParent(std::string_view /*request*/) { return Outcome(::kill(::getppid(), 0)); }

Expected<std::string> StartThread(std::string_view /*request*/) {
  std::string said;
  std::thread([&] { said = "allowed"; }).join();
  return said;
}

// Its open descriptors, in order.
Expected<std::string> ListDescriptors(std::string_view /*request*/) {
  constexpr int kMost = 4096;
  std::string list;
  for (int descriptor = 0; descriptor < kMost; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) >= 0) list += std::to_string(descriptor) + " ";
  }
  return list;
}

const std::array<IsolatedFunction, 19> kFunctions = {{{"echo", &Echo},
                                                      {"count", &Count},
                                                      {"refuse", &Refuse},
                                                      {"shout", &Shout},
                                                      {"raise", &Raise},
                                                      {"spin", &Spin},
                                                      {"sleep", &Sleep},
                                                      {"allocate", &Allocate},
                                                      {"lie", &Lie},
                                                      {"leave", &Leave},
                                                      {"read", &Read},
                                                      {"write", &Write},
                                                      {"remove", &Remove},
                                                      {"connect", &Connect},
                                                      {"fork", &Fork},
                                                      {"execute", &Execute},
                                                      {"kill", &KillParent},
                                                      {"thread", &StartThread},
                                                      {"descriptors", &ListDescriptors}}};

}  // namespace
}  // namespace victorious

int main(int argc, char** argv) { return victorious::RunIsolatedFunction(argc, argv, victorious::kFunctions); }
