#include "victorious/base/file_writer.h"

#include <array>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "testing/data.h"
#include "victorious/base/file.h"
#include "victorious/base/file_descriptor.h"
#include "victorious/base/folder.h"

namespace victorious {
namespace {

using testing::ScratchFolder;

std::string LongText() {
  std::string text;
  while (text.size() < 5 * kWriterBufferBytes / 2) text += std::to_string(text.size()) + "\n";
  return text;
}

// Pieces of many lengths, some of them longer than the buffer.
Status WritePieces(const std::string& text, std::ostream& out) {
  std::size_t length = 1;
  for (std::size_t at = 0; at < text.size(); at += length, length = length * 3 + 1) out << text.substr(at, length);
  return {};
}

TEST(WriteFileInParts, WritesTheBytesInOrder) {
  const ScratchFolder scratch;
  const std::string text = LongText();
  ASSERT_TRUE(WriteFileInParts(scratch / "pieces", [&](std::ostream& out) { return WritePieces(text, out); }));
  EXPECT_TRUE(ReadFile(scratch / "pieces") == text);
  ASSERT_TRUE(WriteFileInParts(scratch / "bytes", [&](std::ostream& out) -> Status {
    for (const char c : text) out.put(c);
    return {};
  }));
  EXPECT_TRUE(ReadFile(scratch / "bytes") == text);
  ASSERT_TRUE(WriteFileInParts(scratch / "empty", [](std::ostream&) -> Status { return {}; }));
  EXPECT_EQ(ReadFile(scratch / "empty"), "");
}

TEST(WriteFileInParts, AContentThatFailsLeavesTheOldFileAlone) {
  const ScratchFolder scratch;
  ASSERT_TRUE(WriteFileAtomically(scratch / "file", "old"));
  const Status failed = WriteFileInParts(scratch / "file", [](std::ostream& out) -> Status {
    out << LongText();
    return Fail(ErrorCode::kDataLoss, "a damaged row");
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "a damaged row");
  EXPECT_EQ(ReadFile(scratch / "file"), "old");
  EXPECT_EQ(ListFolder(scratch.path())->size(), 1U) << "no temporary file stays";
}

TEST(WriteFileInParts, AFullDeviceStopsTheWriter) {
  std::size_t written = 0;
  const Status failed = WriteFileInParts("/dev/full", [&](std::ostream& out) -> Status {
    for (; out.good() && written < 100 * kWriterBufferBytes; written += 1000) out << std::string(1000, 'x');
    return Fail(ErrorCode::kInternal, "the stream failed");
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kNoSpace);
  EXPECT_THAT(failed.error().message, ::testing::StartsWith("write /dev/full: "));
  EXPECT_LT(written, 2 * kWriterBufferBytes);
}

TEST(WriteInParts, AShortContentThatFailsIsNotWritten) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const FileDescriptor out_of(ends[0]);
  FileDescriptor into(ends[1]);
  EXPECT_FALSE(WriteInParts(into.fd(), "a pipe", [](std::ostream& out) -> Status {
    out << "half";
    return Fail(ErrorCode::kDataLoss, "a damaged row");
  }));
  EXPECT_TRUE(WriteInParts(into.fd(), "a pipe", [](std::ostream& out) -> Status {
    out << "whole";
    return {};
  }));
  into.Close();
  std::array<char, 20> read{};
  EXPECT_EQ(::read(out_of.fd(), read.data(), read.size()), 5);
  EXPECT_STREQ(read.data(), "whole");
}

}  // namespace
}  // namespace victorious
