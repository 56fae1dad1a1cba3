#include "victorious/base/program_id.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "victorious/base/file.h"
#include "victorious/base/version.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

TEST(ProgramId, IsContentIdOfTheExecutable) {
  const std::string own = ProgramId().value();
  EXPECT_EQ(own, ProgramId().value());
  EXPECT_TRUE(own.starts_with(std::string(kVersion) + "-")) << own;
  const std::string bytes = ReadFile("/proc/self/exe").value();
  const fs::path copy = fs::path(::testing::TempDir()) / "program_id_test_copy";
  ASSERT_TRUE(WriteFileAtomically(copy, bytes));
  EXPECT_EQ(ComputeProgramId(copy).value(), own) << "regardless of its folder";
  ASSERT_TRUE(WriteFileAtomically(copy, bytes + "x"));
  EXPECT_NE(ComputeProgramId(copy).value(), own);
  fs::remove(copy);
  EXPECT_EQ(ComputeProgramId(copy).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace victorious
