#include "victorious/apps/cluster/content_cache.h"

#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "testing/data.h"
#include "testing/loopback_server.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::LoopbackServer;
using testing::ScratchFolder;

// Files of a machine that submits; removed once they are published, as on another machine.
class ContentCacheTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kLimit = 10'000;

  ContentFile Publish(const std::string& name, const std::string& bytes) {
    const fs::path path = scratch_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    const ContentFile file = DescribeFile(path, CancelToken()).value();
    EXPECT_TRUE(PublishFile(file, Place(), CancelToken()));
    fs::remove(path);
    return file;
  }

  [[nodiscard]] std::string Place() const { return scratch_ / "content"; }
  [[nodiscard]] fs::path Published(const ContentFile& file) const { return Place() / PathInPlace(file); }
  [[nodiscard]] fs::path Cache(const std::string& name) const { return scratch_ / "cache" / name; }

  Expected<TaskFiles> Provide(const std::vector<ContentFile>& files, const std::string& place = "",
                              std::int64_t max_bytes = kLimit) {
    const auto cache = ContentCache::Open(
        {.place = place.empty() ? Place() : place, .folder = scratch_ / "cache", .max_bytes = max_bytes});
    EXPECT_TRUE(cache) << cache.error().message;
    return cache->Provide(files, [] { return false; });
  }

  // The message, which names the file, and is one line.
  Error Refusal(const ContentFile& file, const std::string& place = "", std::int64_t max_bytes = kLimit) {
    const auto of_tasks = [&] { return std::distance(fs::directory_iterator(Cache("tasks")), {}); };
    const std::ptrdiff_t before = fs::exists(Cache("tasks")) ? of_tasks() : 0;
    const auto provided = Provide({file}, place, max_bytes);
    if (provided) return {ErrorCode::kInternal, "none"};
    EXPECT_EQ(provided.error().message.find('\n'), std::string::npos);
    EXPECT_EQ(of_tasks(), before) << "nothing is left";
    return provided.error();
  }

  ScratchFolder scratch_;
};

TEST_F(ContentCacheTest, FilesLieAtTheirPathsBelowTheRoot) {
  const ContentFile video = Publish("videos/a.mp4", "video");
  const ContentFile empty = Publish("videos/a.srt", "");
  std::string root;
  {
    const auto files = Provide({video, empty});
    ASSERT_TRUE(files) << files.error().message;
    root = files->root();
    EXPECT_EQ(ReadFile(root + video.path).value(), "video");
    EXPECT_EQ(ReadFile(root + empty.path).value(), "");
  }
  EXPECT_FALSE(fs::exists(root));
  fs::remove_all(Place() + "/" + PathInPlace(video).parent_path().string());
  EXPECT_EQ(ReadFile(Provide({video})->root() + video.path).value(), "video") << "from the cache";
}

TEST_F(ContentCacheTest, LocalFilesAreNotFetched) {
  ContentFile here = Publish("here.mp4", "here");
  std::ofstream(here.path, std::ios::binary) << "here";
  fs::remove(Published(here));
  EXPECT_EQ(Provide({here})->root(), "");
  const ContentFile other = Publish("other.mp4", "other");
  const auto both = Provide({here, other});
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(ReadFile(both->root() + here.path).value(), "here");
  EXPECT_EQ(ReadFile(both->root() + other.path).value(), "other");
  std::ofstream(here.path, std::ios::binary) << "another size";
  EXPECT_THAT(Refusal(here).message, HasSubstr("here.mp4"));
}

TEST_F(ContentCacheTest, WrongContentIsRefused) {
  const ContentFile file = Publish("a.mp4", "content");
  std::ofstream(Published(file), std::ios::binary) << "Content";
  const Error wrong = Refusal(file);
  EXPECT_EQ(wrong.code, ErrorCode::kDataLoss);
  EXPECT_THAT(wrong.message, HasSubstr("a.mp4: "));
  EXPECT_THAT(wrong.message, HasSubstr(Published(file).string() + ": not the content that was submitted"));
  std::ofstream(Published(file), std::ios::binary) << "cont";
  EXPECT_THAT(Refusal(file).message, HasSubstr("4 of the 7 bytes"));
  std::ofstream(Published(file), std::ios::binary) << "content and more";
  EXPECT_THAT(Refusal(file).message, HasSubstr("more than the 7 bytes"));
  fs::remove(Published(file));
  EXPECT_EQ(Refusal(file).code, ErrorCode::kNotFound);
  EXPECT_TRUE(fs::is_empty(Cache("files")));
}

TEST_F(ContentCacheTest, PublishedAgainItIsMended) {
  const ContentFile file = Publish("a.mp4", "content");
  std::ofstream(Published(file), std::ios::binary) << "Content";
  Publish("a.mp4", "content");
  EXPECT_TRUE(Provide({file}));
}

TEST_F(ContentCacheTest, FetchesOverHttp) {
  const ContentFile file = Publish("a.mp4", std::string(5000, 'x'));
  const std::string head = "HTTP/1.0 200 OK\r\nContent-Length: 5000\r\n\r\n";
  LoopbackServer server;
  server.Serve(head + std::string(4000, 'x'), 0);
  const Error cut_off = Refusal(file, server.Url("http"));
  EXPECT_EQ(cut_off.code, ErrorCode::kDataLoss);
  EXPECT_THAT(cut_off.message, HasSubstr(PathInPlace(file).string()));
  server.Serve(head + std::string(5000, 'x'), 60);
  const auto fetched = Provide({file}, server.Url("http"));
  ASSERT_TRUE(fetched) << fetched.error().message;
  EXPECT_EQ(ReadFile(fetched->root() + file.path)->size(), 5000U);
  const ContentFile other = Publish("b.mp4", "b");
  const std::string closed = [] { return LoopbackServer().Url("http"); }();
  EXPECT_EQ(Refusal(other, closed).code, ErrorCode::kUnavailable);
}

TEST_F(ContentCacheTest, RemovesTheLeastRecentlyUsed) {
  std::vector<ContentFile> files;
  for (const char byte : {'a', 'b', 'c'}) files.push_back(Publish(std::string(1, byte), std::string(4000, byte)));
  const auto cached = [&](const ContentFile& file) { return Cache("files") / file.content_id; };
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(Provide({files[static_cast<std::size_t>(i)]}));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ASSERT_TRUE(Provide({files[0]})) << "used again";
  ASSERT_TRUE(Provide({files[2]}));
  EXPECT_TRUE(fs::exists(cached(files[0])));
  EXPECT_FALSE(fs::exists(cached(files[1])));
  EXPECT_TRUE(fs::exists(cached(files[2])));
}

TEST_F(ContentCacheTest, FilesThatTasksReadStay) {
  const ContentFile one = Publish("one", std::string(6000, '1'));
  const ContentFile other = Publish("other", std::string(6000, '2'));
  {
    const auto reading = Provide({one});
    ASSERT_TRUE(reading);
    const auto full = Provide({other});
    ASSERT_FALSE(full);
    EXPECT_EQ(full.error().code, ErrorCode::kUnavailable) << "later there may be room";
    EXPECT_THAT(full.error().message, HasSubstr("--cache-size"));
    EXPECT_EQ(ReadFile(reading->root() + one.path)->size(), 6000U);
  }
  EXPECT_TRUE(Provide({other}));
  const Error too_large = Refusal(Publish("large", std::string(11'000, '3')));
  EXPECT_EQ(too_large.code, ErrorCode::kNoSpace);
  EXPECT_THAT(too_large.message, HasSubstr("--cache-size"));
}

TEST_F(ContentCacheTest, RemovesTheFilesOfKilledWorkers) {
  const ContentFile one = Publish("one", std::string(6000, '1'));
  ASSERT_TRUE(Provide({one}));
  fs::create_directories(Cache("tasks/1-0"));
  std::ofstream(Cache("tasks/1-0.lock"));
  fs::create_hard_link(Cache("files") / one.content_id, Cache("tasks/1-0/one"));
  std::ofstream(Cache("files") / (std::string(32, '0') + ".part")) << std::string(6000, '0');
  const auto provided = Provide({Publish("other", std::string(6000, '2'))});
  ASSERT_TRUE(provided) << provided.error().message;
  EXPECT_FALSE(fs::exists(Cache("tasks/1-0")));
}

TEST_F(ContentCacheTest, WorkersFetchAFileOnce) {
  const ContentFile file = Publish("a.mp4", std::string(5000, 'x'));
  LoopbackServer server;  // answers once
  server.Serve("HTTP/1.0 200 OK\r\nContent-Length: 5000\r\n\r\n" + std::string(5000, 'x'), 60);
  std::vector<std::jthread> workers;
  for (int i = 0; i < 4; ++i) {
    workers.emplace_back([&] {
      const auto files = Provide({file}, server.Url("http"));
      ASSERT_TRUE(files) << files.error().message;
      EXPECT_EQ(ReadFile(files->root() + file.path)->size(), 5000U);
    });
  }
}

TEST_F(ContentCacheTest, StopsWhileItWaits) {
  const ContentFile file = Publish("a.mp4", "content");
  LoopbackServer silent;
  silent.Serve("", 60);
  const auto cache =
      ContentCache::Open({.place = silent.Url("http"), .folder = scratch_ / "cache", .max_bytes = kLimit});
  int asked = 0;
  const auto stopped = cache->Provide(std::vector{file}, [&] { return ++asked > 3; });
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST_F(ContentCacheTest, PlacesThatCannotBeUsed) {
  const auto refusal = [&](const std::string& place) {
    return ContentCache::Open({.place = place, .folder = scratch_ / "cache"}).error();
  };
  EXPECT_EQ(refusal(scratch_ / "none").code, ErrorCode::kNotFound);
  const Error with_password = refusal("https://ann:secret@host/content");
  EXPECT_EQ(with_password.code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(with_password.message.find("secret"), std::string::npos);
}

TEST(ContentFile, OnlyPathsThatStayBelowTheRootAreValid) {
  const std::string id(32, 'a');
  EXPECT_TRUE(IsValid({"/videos/a.mp4", id, 5}));
  for (const char* path : {"", "a.mp4", "/", "/videos/", "/videos/../../etc/passwd", "/./a"}) {
    EXPECT_FALSE(IsValid({path, id, 5})) << path;
  }
  EXPECT_FALSE(IsValid({"/a", "../" + id.substr(3), 5}));
  EXPECT_FALSE(IsValid({"/a", id.substr(1), 5}));
  EXPECT_FALSE(IsValid({"/a", id, -1}));
}

}  // namespace
}  // namespace victorious
