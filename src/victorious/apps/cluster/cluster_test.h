// For the tests of cluster/: a scratch database, and its queue as one worker sees it.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "testing/scratch_postgres.h"
#include "victorious/apps/cluster/index_task.h"
#include "victorious/store/open_store.h"
#include "victorious/store/postgres/postgres_segment_store.h"

namespace victorious {

class PostgresClusterTest : public ::testing::Test {
 protected:
  static constexpr const char* kWorker = "host:7";

  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(url_, testing::EmptyPostgresDatabase());
    auto store = OpenStore(url_, StoreMode::kCreate);
    ASSERT_TRUE(store) << store.error().message;
    store_ = *std::move(store);
    auto segments = OpenPostgresSegmentStore(url_, StoreMode::kCreate);
    ASSERT_TRUE(segments) << segments.error().message;
    segments_ = *std::move(segments);
    auto queue = postgres::TaskQueue::Open(url_, {.worker = kWorker, .program = "this", .retry_delay = {}});
    ASSERT_TRUE(queue) << queue.error().message;
    queue_ = *std::move(queue);
  }

  void Submit(const std::string& video, const std::string& program = "this") {
    Submit(IndexTask{.video = video, .options = {}, .program = program}, video);
  }

  void SubmitLive(const std::string& url) {
    Submit(IndexTask{.video = url, .options = {}, .program = "this", .is_live = true}, url);
  }

  void Submit(const IndexTask& task, const std::string& content_id) {
    const auto priority = task.is_live ? postgres::TaskPriority::kLive : postgres::TaskPriority::kBatch;
    const postgres::NewTask queued = ToQueue(task, content_id, priority).value();
    ASSERT_EQ(queue_->Submit(std::span(&queued, 1))->added, 1);
  }

  std::string url_;
  std::unique_ptr<IndexStore> store_;
  std::unique_ptr<SegmentStore> segments_;
  std::unique_ptr<postgres::TaskQueue> queue_;
};

}  // namespace victorious
