#include "victorious/base/own_file.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

// In a shared library: tests/e2e/test_library.py.
TEST(OwnFile, IsTheProgram) { EXPECT_EQ(OwnFile(), std::filesystem::read_symlink("/proc/self/exe")); }

}  // namespace
}  // namespace victorious
