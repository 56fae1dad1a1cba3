// What the tests of Indexer share.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/jobs/index/indexer.h"

namespace victorious {

inline IndexOptions SearchingEveryFrame() {
  IndexOptions options;
  options.every = 1;
  return options;
}

struct RunSetup {
  IndexOptions options = SearchingEveryFrame();
  Redo redo = Redo::kNever;
  int threads = 2;
  std::optional<std::string> telemetry = {};
};

[[nodiscard]] inline Expected<IndexReport> TryIndex(const std::string& video, std::vector<ObjectModel> models,
                                                    IndexStore& store, const RunSetup& run = {},
                                                    const WarningSink& warn = {}) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Indexer indexer, Indexer::Create(std::move(models), run.options));
  return indexer.Index({.video = video, .telemetry = run.telemetry, .redo = run.redo, .threads = run.threads},
                       CancelToken(), store, warn);
}

inline IndexReport Index(const std::string& video, std::vector<ObjectModel> models, IndexStore& store,
                         const RunSetup& run = {}, const WarningSink& warn = {}) {
  const Expected<IndexReport> report = TryIndex(video, std::move(models), store, run, warn);
  EXPECT_TRUE(report) << report.error().message;
  return report.value_or(IndexReport{});
}

// A commit every 32 kept frames and every two seconds: with all frames kept, and passed on soon, these runs have
// several.
inline RunSetup ManyCommits() {
  RunSetup run;
  run.options.keep.interval_s = 0;
  run.options.follow.restart_interval_frames = 8;
  return run;
}

}  // namespace victorious
