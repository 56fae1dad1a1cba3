#include "victorious/base/error.h"

#include <cerrno>
#include <memory>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Error, AddContextPrependsTextAndKeepsTheCode) {
  const Error error =
      Error{ErrorCode::kDataLoss, "block 3: bad checksum"}.WithContext("box.vmodel").WithContext("load");
  EXPECT_EQ(error.code, ErrorCode::kDataLoss);
  EXPECT_EQ(error.message, "load: box.vmodel: block 3: bad checksum");
}

TEST(Error, ErrnoMapsToNearestCode) {
  EXPECT_EQ(ErrorFromErrno(ENOENT, "x").code, ErrorCode::kNotFound);
  EXPECT_EQ(ErrorFromErrno(ENOTDIR, "x").code, ErrorCode::kNotFound);
  EXPECT_EQ(ErrorFromErrno(EEXIST, "x").code, ErrorCode::kAlreadyExists);
  EXPECT_EQ(ErrorFromErrno(EACCES, "x").code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(ErrorFromErrno(EPERM, "x").code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(ErrorFromErrno(EROFS, "x").code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(ErrorFromErrno(ENOSPC, "x").code, ErrorCode::kNoSpace);
  EXPECT_EQ(ErrorFromErrno(EDQUOT, "x").code, ErrorCode::kNoSpace);
  EXPECT_EQ(ErrorFromErrno(EISDIR, "x").code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(ErrorFromErrno(ELOOP, "x").code, ErrorCode::kInvalidArgument) << "a symbolic link to itself";
  EXPECT_EQ(ErrorFromErrno(EIO, "x").code, ErrorCode::kInternal);
}

TEST(Error, ErrnoMessageNamesOperationAndReason) {
  const std::string message = ErrorFromErrno(ENOSPC, "write models/box.vmodel").message;
  EXPECT_THAT(message, StartsWith("write models/box.vmodel: "));
  EXPECT_THAT(message, HasSubstr("space"));
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(Error, ExitStatusIsTwoForBadInputElseOne) {
  const std::set<ErrorCode> bad_input = {ErrorCode::kInvalidArgument, ErrorCode::kNotFound, ErrorCode::kAlreadyExists,
                                         ErrorCode::kDataLoss, ErrorCode::kUnsupported};
  for (const EnumText<ErrorCode>& code : kErrorCodeTexts) {
    EXPECT_EQ(ExitStatus(code.value), bad_input.contains(code.value) ? 2 : 1) << code.text;
  }
}

TEST(Error, NamesAreDistinctSnakeCase) {
  std::set<std::string_view> names;
  std::set<ErrorCode> codes;
  for (const EnumText<ErrorCode>& code : kErrorCodeTexts) {
    EXPECT_THAT(std::string(code.text), ::testing::MatchesRegex("[a-z_]+"));
    names.insert(code.text);
    codes.insert(code.value);
  }
  EXPECT_EQ(names.size(), kErrorCodeTexts.size());
  EXPECT_EQ(codes.size(), kErrorCodeTexts.size());
}

Status ReturnsIfError(const Status& status, bool& went_on) {
  VICTORIOUS_RETURN_IF_ERROR(status);
  went_on = true;
  return {};
}

TEST(Macros, ReturnIfErrorReturnsTheErrorOnly) {
  bool went_on = false;
  const Status failed = ReturnsIfError(Fail(ErrorCode::kNotFound, "no box"), went_on);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(failed.error().message, "no box");
  EXPECT_FALSE(went_on);
  EXPECT_TRUE(ReturnsIfError({}, went_on));
  EXPECT_TRUE(went_on);
}

Expected<std::unique_ptr<int>> MakeNumber(int value, int& calls) {
  ++calls;
  if (value < 0) return Fail(ErrorCode::kInvalidArgument, "negative");
  return std::make_unique<int>(value);
}

Expected<int> Sum(int a, int b, int& calls) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<int> first, MakeNumber(a, calls));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<int> second, MakeNumber(b, calls));
  return *first + *second;
}

TEST(Macros, AssignOrReturnMovesTheValueOutAndEvaluatesOnce) {
  int calls = 0;
  EXPECT_EQ(Sum(2, 3, calls), 5);
  EXPECT_EQ(calls, 2);
}

TEST(Macros, AssignOrReturnStopsAtTheFirstError) {
  int calls = 0;
  const Expected<int> sum = Sum(-1, 3, calls);
  ASSERT_FALSE(sum);
  EXPECT_EQ(sum.error().message, "negative");
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace victorious
