#include "victorious/base/isolated_process.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "testing/data.h"
#include "victorious/base/sandbox.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kRefused = "refused";
constexpr std::string_view kAllowed = "allowed";

std::filesystem::path TestProgram() {
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename("base_isolated");
}

Expected<IsolatedProcess> StartFunction(std::string_view function, const IsolationLimits& limits = {}) {
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess process, IsolatedProcess::Start(function, {.program = TestProgram()}));
  process.Confine(limits);
  return process;
}

Expected<std::string> AskOnce(std::string_view function, std::string_view request = "",
                              const IsolationLimits& limits = {}, const AskOptions& options = {}) {
  VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess process, StartFunction(function, limits));
  return process.Ask(request, options);
}

TEST(IsolatedProcess, ReturnsResultsOfAnySize) {
  EXPECT_EQ(AskOnce("echo"), "");
  const std::string large(std::size_t{20} << 20, 'x');  // NOLINT(bugprone-string-constructor)
  EXPECT_EQ(AskOnce("echo", large), large);
}

TEST(IsolatedProcess, AnswersSeveralRequests) {
  auto process = StartFunction("count");
  ASSERT_TRUE(process) << process.error().message;
  EXPECT_EQ(process->Ask("", {}), "1");
  EXPECT_EQ(process->Ask("", {}), "2");
  EXPECT_TRUE(process->IsRunning());
}

// Each copy is a process of its own, with limits of its own, and the first one stays as it is.
TEST(IsolatedProcess, CopiesItself) {
  auto origin = IsolatedProcess::Start("count", {.program = TestProgram()});
  ASSERT_TRUE(origin);
  std::vector<IsolatedProcess> copies;
  for (int i = 0; i < 3; ++i) {
    auto copy = origin->Copy();
    ASSERT_TRUE(copy) << copy.error().message;
    copy->Confine({});
    EXPECT_EQ(copy->Ask("", {}), "1");
    copies.push_back(*std::move(copy));
  }
  EXPECT_EQ(copies[1].Ask("", {}), "2");
  copies.erase(copies.begin());
  EXPECT_EQ(copies[0].Ask("", {}), "3");
  origin->Confine({});
  EXPECT_EQ(origin->Ask("", {}), "1");
  EXPECT_FALSE(origin->Copy()) << "it is confined";
  EXPECT_FALSE(origin->IsRunning());
  EXPECT_EQ(copies[1].Ask("", {}), "2");
}

TEST(IsolatedProcess, CrashOfACopyIsAnErrorOfTheCopy) {
  auto origin = IsolatedProcess::Start("raise", {.program = TestProgram()});
  ASSERT_TRUE(origin);
  auto copy = origin->Copy();
  ASSERT_TRUE(copy);
  copy->Confine({});
  for (const int signal : {SIGABRT, SIGSEGV}) {
    EXPECT_EQ(copy->Ask(std::to_string(signal), {}).error().message, "damaged: its decoder crashed");
    copy = origin->Copy();
    ASSERT_TRUE(copy);
    copy->Confine({});
  }
  auto other = IsolatedProcess::Start("descriptors", {.program = TestProgram()});
  ASSERT_TRUE(other);
  auto one = other->Copy();
  auto two = other->Copy();
  ASSERT_TRUE(one && two);
  two->Confine({});
  EXPECT_EQ(two->Ask("", {}), "0 1 2 3 ") << "the socket of another copy is not among them";
}

TEST(IsolatedProcess, ReturnsErrorsAndGoesOn) {
  auto process = StartFunction("refuse");
  ASSERT_TRUE(process);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(process->Ask("", {}).error(), (Error{ErrorCode::kUnsupported, "too round: square is right"}));
  }
}

TEST(IsolatedProcess, ErrorIsOneShortLine) {
  const auto result = AskOnce("shout");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().message, "two?lines " + std::string(1990, 'x'));
}

TEST(IsolatedProcess, CrashIsAnError) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE}) {
    const auto result = AskOnce("raise", std::to_string(signal));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error(), (Error{ErrorCode::kDataLoss, "damaged: its decoder crashed"}));
  }
}

TEST(IsolatedProcess, ProcessorTimeIsBounded) {
  const auto result = AskOnce("spin", "", {.processor_s = 1});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(result.error().message, HasSubstr("1 s of processor time"));
}

// One that waits uses no processor time.
TEST(IsolatedProcess, WallClockTimeIsBounded) {
  const auto result = AskOnce("sleep", "", {}, {.patience = std::chrono::milliseconds(100)});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(result.error().message, HasSubstr("more than 0.1 s to read"));
}

TEST(IsolatedProcess, CancelEndsIt) {
  CancelToken cancel;
  cancel.CancelAtPoll(2);
  auto process = StartFunction("sleep");
  ASSERT_TRUE(process);
  const auto result = process->Ask("", {.cancel = &cancel});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
  EXPECT_FALSE(process->IsRunning());
}

TEST(IsolatedProcess, ResultThatIsNoneIsAnError) {
  for (const char* function : {"lie", "leave"}) {
    const auto result = AskOnce(function);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kDataLoss) << result.error().message;
  }
  const auto too_long = AskOnce("echo", "12345", {}, {.max_answer_bytes = 4});
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, ErrorCode::kDataLoss);
}

TEST(IsolatedProcess, ProgramThatIsNotThereIsAnError) {
  for (const int wait_ms : {0, 200}) {  // it ends after the limits come, or before
    auto process = IsolatedProcess::Start("echo", {.program = "/nowhere/victorious-decoder"});
    ASSERT_TRUE(process);
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    process->Confine({});
    EXPECT_THAT(process->Ask("", {}).error().message, HasSubstr("cannot be executed"));
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(IsolatedProcess, MemoryIsBounded) {
  const auto result = AskOnce("allocate", std::to_string(200 << 20), {.memory_bytes = 100 << 20});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(result.error().message, HasSubstr("100 MiB"));
}
#endif

// Also those that other libraries opened without O_CLOEXEC.
TEST(IsolatedProcess, InheritsNoDescriptors) {
  const int file = ::open("/dev/null", O_RDONLY);  // NOLINT(android-cloexec-open): the case that is tested
  ASSERT_GE(file, 0);
  EXPECT_EQ(AskOnce("descriptors"), "0 1 2 3 ");
  ::close(file);
}

TEST(Sandbox, RefusesSystemCalls) {
  if (!FindSandboxSupport().has_seccomp) GTEST_SKIP() << "SKIPPED: this kernel has no seccomp";
  const testing::ScratchFolder folder;
  std::ofstream(folder.path() / "own") << "x";
  const std::string own = (folder.path() / "own").string();
  for (const char* function : {"connect", "fork", "execute", "kill"})
    EXPECT_EQ(AskOnce(function), kRefused) << function;
  const IsolationLimits limits{.readable = {folder.path()}};
  EXPECT_EQ(AskOnce("write", own, limits), kRefused);
  EXPECT_EQ(AskOnce("write", own + "2", limits), kRefused);
  EXPECT_EQ(AskOnce("remove", own, limits), kRefused);
  EXPECT_TRUE(std::filesystem::exists(own));
  EXPECT_EQ(AskOnce("thread"), kAllowed) << "decoders may use threads";
}

TEST(Sandbox, RefusesOtherFiles) {
  if (FindSandboxSupport().landlock_version == 0) GTEST_SKIP() << "SKIPPED: this kernel has no Landlock";
  const testing::ScratchFolder folder;
  std::ofstream(folder.path() / "own") << "x";
  std::ofstream(folder.path() / "other") << "x";
  std::filesystem::create_symlink(folder.path() / "other", folder.path() / "link");
  const IsolationLimits file{.readable = {folder.path() / "own"}};
  EXPECT_EQ(AskOnce("read", (folder.path() / "own").string(), file), kAllowed);
  EXPECT_EQ(AskOnce("read", (folder.path() / "other").string(), file), kRefused);
  EXPECT_EQ(AskOnce("read", (folder.path() / "link").string(), file), kRefused);
  EXPECT_EQ(AskOnce("read", "/etc/passwd", file), kRefused);
  EXPECT_EQ(AskOnce("read", "/etc/passwd"), kRefused);
  const IsolationLimits whole{.readable = {folder.path(), folder.path() / "absent"}};
  EXPECT_EQ(AskOnce("read", (folder.path() / "other").string(), whole), kAllowed);
  EXPECT_EQ(AskOnce("read", "/etc/passwd", whole), kRefused);
}

TEST(Sandbox, DescriptionSaysWhatIsAbsent) {
  EXPECT_EQ(DescribeSandbox({.has_seccomp = true, .landlock_version = 1}), "seccomp, Landlock");
  EXPECT_THAT(DescribeSandbox({.has_seccomp = true}), HasSubstr("no Landlock"));
  EXPECT_THAT(DescribeSandbox({.landlock_version = 1}), HasSubstr("no seccomp"));
  EXPECT_THAT(DescribeSandbox({}), HasSubstr("neither"));
}

}  // namespace
}  // namespace victorious
