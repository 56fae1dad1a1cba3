#include "victorious/apps/serve/byte_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::Contains;
using ::testing::Pair;

TEST(ByteRange, OneRangeIsCutToTheFile) {
  const struct {
    const char* header;
    std::int64_t first, last;
  } cases[] = {{"bytes=0-99", 0, 99},        {"bytes=0-0", 0, 0},
               {"bytes=100-", 100, 999},     {"bytes=999-", 999, 999},
               {"bytes=900-5000", 900, 999}, {"bytes=-1", 999, 999},
               {"bytes=-5000", 0, 999},      {"bytes=5-99999999999999999999999", 5, 999}};
  for (const auto& one : cases) {
    const ByteRange range = ParseByteRange(one.header, 1000);
    EXPECT_EQ(range.kind, RangeKind::kPart) << one.header;
    EXPECT_EQ(range.first, one.first) << one.header;
    EXPECT_EQ(range.last, one.last) << one.header;
  }
}

TEST(ByteRange, BeyondTheEndIsUnsatisfiable) {
  for (const char* header : {"bytes=1000-", "bytes=1000-1001", "bytes=-0", "bytes=99999999999999999999999-"}) {
    EXPECT_EQ(ParseByteRange(header, 1000).kind, RangeKind::kUnsatisfiable) << header;
  }
  EXPECT_EQ(ParseByteRange("bytes=0-", 0).kind, RangeKind::kUnsatisfiable);
  EXPECT_EQ(ParseByteRange("bytes=-5", 0).kind, RangeKind::kUnsatisfiable);
}

TEST(ByteRange, MalformedAndSeveralRangesSendEverything) {
  for (const char* header : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=9-3", "bytes=0-1,5-6", "items=0-1",
                             "bytes= 0-1", "bytes=+1-2", "bytes=0x1-2"}) {
    EXPECT_EQ(ParseByteRange(header, 1000).kind, RangeKind::kWhole) << header;
  }
}

TEST(FileResponse, HasStatusAndHeadersOfTheRange) {
  const auto respond = [](HttpRequest request) { return FileResponse(request, "a.mp4", 1000, "video/mp4", "\"e\""); };
  const HttpResponse whole = respond({});
  EXPECT_EQ(whole.status, 200);
  EXPECT_EQ(whole.file->length, 1000);
  EXPECT_THAT(whole.headers, Contains(Pair("Accept-Ranges", "bytes")));
  const HttpResponse part = respond({.range = "bytes=10-19"});
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.file->offset, 10);
  EXPECT_EQ(part.file->length, 10);
  EXPECT_THAT(part.headers, Contains(Pair("Content-Range", "bytes 10-19/1000")));
  const HttpResponse none = respond({.range = "bytes=1000-"});
  EXPECT_EQ(none.status, 416);
  EXPECT_FALSE(none.file);
  EXPECT_THAT(none.headers, Contains(Pair("Content-Range", "bytes */1000")));
  EXPECT_EQ(respond({.if_none_match = "\"e\""}).status, 304);
  EXPECT_EQ(respond({.range = "bytes=10-19", .if_range = "\"old\""}).status, 200) << "the file has changed since";
  EXPECT_EQ(respond({.range = "bytes=10-19", .if_range = "\"e\""}).status, 206);
}

}  // namespace
}  // namespace victorious
