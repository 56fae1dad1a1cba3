#include "victorious/base/file_lock.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "testing/data.h"

namespace victorious {
namespace {

TEST(FileLock, IsHeldByOne) {
  const testing::ScratchFolder folder;
  const auto path = folder / "lock";
  {
    const auto held = FileLock::Try(path);
    ASSERT_TRUE(held.value());
    EXPECT_FALSE(FileLock::Try(path).value());
  }
  EXPECT_TRUE(FileLock::Try(path).value());
}

TEST(FileLock, WaitsForTheOther) {
  const testing::ScratchFolder folder;
  const auto path = folder / "lock";
  std::optional<FileLock> held = FileLock::Try(path).value();
  std::atomic<bool> is_released = false;
  std::thread other([&] {
    const auto lock = FileLock::Wait(path);
    EXPECT_TRUE(lock);
    EXPECT_TRUE(is_released);
    EXPECT_FALSE(FileLock::Try(path).value());
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::filesystem::remove(path);  // as its owner does: the lock of the other one is that of the new file
  is_released = true;
  held.reset();
  other.join();
}

TEST(FileLock, NamesWhatCannotBeOpened) {
  const testing::ScratchFolder folder;
  const auto lock = FileLock::Try(folder / "none/lock");
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().code, ErrorCode::kNotFound);
  EXPECT_NE(lock.error().message.find("none/lock"), std::string::npos);
}

}  // namespace
}  // namespace victorious
