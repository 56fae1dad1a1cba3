#include "victorious/apps/serve/job_runner.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/types.h>

#include "testing/data.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const JobFolders kFolders{.index = "/d/index.db", .models = "/d/models", .copies = "/d"};

TEST(JobArguments, AreThoseOfTheCommands) {
  EXPECT_THAT(*JobArguments({.kind = JobKind::kIndex, .input_json = R"({"video": "/v/a.mp4"})"}, kFolders),
              ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--", "/v/a.mp4"));
  EXPECT_THAT(
      *JobArguments({.kind = JobKind::kIndex, .input_json = R"({"video": "-x", "telemetry": "/t.csv"})"}, kFolders),
      ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--telemetry=/t.csv", "--", "-x"));
  EXPECT_THAT(*JobArguments({.kind = JobKind::kModel,
                             .input_json = R"({"name": "jeep", "files": ["a.jpg", "b.jpg"], "length_m": 4.5})"},
                            kFolders),
              ElementsAre("model", "add", "--models", "/d/models", "--length=4.5", "--", "jeep", "a.jpg", "b.jpg"));
  EXPECT_THAT(
      *JobArguments({.kind = JobKind::kCopy, .input_json = R"({"video": "-x.ts", "copy": "/d/c.mp4"})"}, kFolders),
      ElementsAre("copy", "--force", "--out", "/d/c.mp4", "--", "-x.ts"));
}

TEST(JobArguments, OfTheSample) {
  JobFolders folders = kFolders;
  folders.files = FileRoots({"/d"});
  folders.uploads = "/u";
  folders.sample_scene = "/s/a.json";
  folders.sample_object = "/s/jeep.glb";
  const auto sample = [&](const std::string& input) {
    return JobArguments({.kind = JobKind::kSample, .input_json = input}, folders);
  };
  EXPECT_THAT(*sample(R"({"scene": "/s/a.json", "folder": "/u/1"})"),
              ElementsAre("simulate", "--force", "--out=/u/1", "--", "/s/a.json"));
  EXPECT_FALSE(sample(R"({"scene": "/s/b.json", "folder": "/u/1"})"));
  for (const std::string folder : {"/", "/u", "/u/..", "/u/1/2", "/s/1", ""}) {
    EXPECT_FALSE(sample(R"({"scene": "/s/a.json", "folder": ")" + folder + R"("})")) << folder;
  }
  EXPECT_FALSE(
      JobArguments({.kind = JobKind::kSample, .input_json = R"({"scene": "/s/a.json", "folder": "/u/1"})"}, kFolders));
  const auto model = [&](const std::string& file) {
    return JobArguments({.kind = JobKind::kModel, .input_json = R"({"name": "a", "files": [")" + file + R"("]})"},
                        folders);
  };
  EXPECT_TRUE(model("/s/jeep.glb"));
  EXPECT_FALSE(model("/s/other.glb"));
}

TEST(JobArguments, OfCategories) {
  JobFolders folders = kFolders;
  folders.categories = "/d/kinds.vcat";
  EXPECT_THAT(*JobArguments({.kind = JobKind::kIndex, .input_json = R"({"video": "/v/a.mp4"})"}, folders),
              ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--categories=/d/kinds.vcat", "--",
                          "/v/a.mp4"));
  const JobRecord refine{.kind = JobKind::kRefine,
                         .input_json = R"({"categories": "/d/kinds.vcat", "refine": "/d/categories-1.vcat"})"};
  EXPECT_THAT(*JobArguments(refine, folders), ElementsAre("category", "refine", "--model=/d/kinds.vcat",
                                                          "--db=/d/index.db", "--force", "--out=/d/categories-1.vcat"));
  EXPECT_EQ(MadeFileOf(refine), "/d/categories-1.vcat");
  EXPECT_FALSE(JobArguments({.kind = JobKind::kRefine, .input_json = "{}"}, folders));
}

TEST(JobArguments, OfClipsAndOfModelsFromAFrame) {
  const JobRecord clip{.kind = JobKind::kClip, .input_json = R"({"video": "-v.mp4", "object": 3, "clip": "/d/c.mp4"})"};
  EXPECT_THAT(*JobArguments(clip, kFolders),
              ElementsAre("export", "--format", "video", "--db", "/d/index.db", "--video=-v.mp4", "--object", "3",
                          "--clip", "2", "--force", "--out", "/d/c.mp4"));
  EXPECT_EQ(MadeFileOf(clip), "/d/c.mp4");
  EXPECT_FALSE(MadeFileOf({.kind = JobKind::kIndex, .input_json = R"({"video": "a"})"}));
  EXPECT_THAT(*JobArguments({.kind = JobKind::kClip,
                             .input_json = R"({"video": "v", "object": 3, "clip": "/d/c.mp4", "from_s": 1.5, "to_s": 2,
                                               "telemetry": "/t.csv"})"},
                            kFolders),
              ElementsAre("export", "--format", "video", "--db", "/d/index.db", "--video=v", "--object", "3", "--clip",
                          "2", "--from=1.5", "--to=2", "--telemetry=/t.csv", "--force", "--out", "/d/c.mp4"));
  EXPECT_THAT(*JobArguments({.kind = JobKind::kModel,
                             .input_json = R"({"name": "van", "files": ["f.jpg"], "box": [1, 2.5, 30, 40]})"},
                            kFolders),
              ElementsAre("model", "add", "--models", "/d/models", "--box=1,2.5,30,40", "--", "van", "f.jpg"));
}

TEST(JobArguments, OfBoxedPhotosAndOfASearchFromTheBeginning) {
  EXPECT_THAT(*JobArguments({.kind = JobKind::kModel, .input_json = R"({"name": "van", "files": ["a.jpg", "b.jpg"],
                                               "boxes": [[1, 2, 30, 40], [5, 6, 7, 8]]})"},
                            kFolders),
              ElementsAre("model", "add", "--models", "/d/models", "--box=1,2,30,40", "--box=5,6,7,8", "--", "van",
                          "a.jpg", "b.jpg"));
  EXPECT_FALSE(JobArguments(
      {.kind = JobKind::kModel, .input_json = R"({"name": "van", "files": ["a.jpg"], "boxes": [[1, 2, 3]]})"},
      kFolders));
  EXPECT_THAT(*JobArguments({.kind = JobKind::kIndex, .input_json = R"({"video": "-v.mp4", "redo": true})"}, kFolders),
              ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--redo", "--", "-v.mp4"));
}

TEST(JobArguments, OfLiveSourcesAndFollowedBoxes) {
  EXPECT_THAT(*JobArguments({.kind = JobKind::kLive, .input_json = R"({"video": "rtsp://host/one"})"}, kFolders),
              ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--", "rtsp://host/one"));
  const JobRecord track{.kind = JobKind::kTrack,
                        .input_json = R"({"video": "-v.mp4", "at_s": 1.5, "box": [1, 2.5, 30, 40], "type": "-van"})"};
  EXPECT_THAT(*JobArguments(track, kFolders), ElementsAre("track", "--db", "/d/index.db", "--box=1,2.5,30,40",
                                                          "--at=1.500000", "--type=-van", "--", "-v.mp4"));
  EXPECT_FALSE(MadeFileOf(track));
}

TEST(JobArguments, OfTracksSayWhatIsWrong) {
  const auto message = [](const char* input) {
    return JobArguments({.kind = JobKind::kTrack, .input_json = input}, kFolders).error().message;
  };
  EXPECT_THAT(message(R"({"box": [1, 2, 3, 4], "at_s": 0})"), HasSubstr("video"));
  EXPECT_THAT(message(R"({"video": "v", "box": [1, 2, 3, 4]})"), HasSubstr("at_s"));
  EXPECT_THAT(message(R"({"video": "v", "at_s": 0, "box": [1, 2, 3]})"), HasSubstr("box"));
  EXPECT_THAT(message(R"({"video": "v", "at_s": 0, "box": [1, 2, 3, 4], "type": 5})"), HasSubstr("type"));
}

TEST(JobArguments, InvalidInputsAreErrors) {
  for (const auto& [kind, input] : std::initializer_list<std::pair<JobKind, const char*>>{
           {JobKind::kIndex, "{}"},
           {JobKind::kIndex, "[]"},
           {JobKind::kIndex, "no JSON"},
           {JobKind::kIndex, R"({"video": 3})"},
           {JobKind::kIndex, R"({"video": "a\u0000b"})"},
           {JobKind::kModel, R"({"name": "jeep", "files": ["a\u0000b"]})"},
           {JobKind::kIndex, R"({"video": "a", "telemetry": 3})"},
           {JobKind::kModel, R"({"name": "jeep"})"},
           {JobKind::kModel, R"({"name": "jeep", "files": []})"},
           {JobKind::kModel, R"({"name": "jeep", "files": [3]})"},
           {JobKind::kModel, R"({"name": "jeep", "files": ["a"], "length_m": "x"})"},
           {JobKind::kModel, R"({"name": "jeep", "files": ["a"], "box": [1, 2, 3]})"},
           {JobKind::kClip, R"({"video": "a", "object": 3})"},
           {JobKind::kClip, R"({"video": "a", "clip": "/d/b", "object": "3"})"},
           {JobKind::kClip, R"({"video": "a", "clip": "/d/b", "object": 3, "from_s": "x"})"},
           {JobKind::kCopy, R"({"video": "a"})"},
           {JobKind::kCopy, R"({"copy": "a"})"}}) {
    EXPECT_FALSE(JobArguments({.kind = kind, .input_json = input}, kFolders)) << ToText(kind) << input;
  }
}

TEST(JobArguments, OfLiveSourcesNameTheTrustedCertificates) {
  JobFolders folders = kFolders;
  folders.certificates = "/d/ca.pem";
  EXPECT_THAT(
      *JobArguments({.kind = JobKind::kLive, .input_json = R"({"video": "rtsps://host/one"})"}, folders),
      ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--ca=/d/ca.pem", "--", "rtsps://host/one"));
}

// An index from elsewhere may hold jobs, too.
TEST(JobArguments, NameNoOtherFilesThanTheServerKnows) {
  JobFolders folders = kFolders;
  folders.categories = "/d/kinds.vcat";
  folders.files = FileRoots({"/v", "/given.csv"}, {"/v/server.key"});
  EXPECT_THAT(
      *JobArguments({.kind = JobKind::kIndex, .input_json = R"({"video": "/v/a.mp4", "telemetry": "/given.csv"})"},
                    folders),
      ElementsAre("index", "--models", "/d/models", "--db", "/d/index.db", "--categories=/d/kinds.vcat",
                  "--telemetry=/given.csv", "--files-below=/given.csv", "--files-below=/v", "--", "/v/a.mp4"));
  EXPECT_TRUE(JobArguments({.kind = JobKind::kLive, .input_json = R"({"video": "rtsp://host/one"})"}, folders));
  for (const auto& [kind, input] : std::initializer_list<std::pair<JobKind, const char*>>{
           {JobKind::kIndex, R"({"video": "/etc/passwd"})"},
           {JobKind::kIndex, R"({"video": "/v/../etc/passwd"})"},
           {JobKind::kIndex, R"({"video": "/v/server.key"})"},
           {JobKind::kIndex, R"({"video": "/v/.hidden/a.mp4"})"},
           {JobKind::kIndex, R"({"video": "http://host/a.mp4"})"},
           {JobKind::kIndex, R"({"video": "file:///v/a.mp4"})"},
           {JobKind::kIndex, R"({"video": "/v/a.mp4", "telemetry": "/etc/passwd"})"},
           {JobKind::kLive, R"({"video": "/v/a.mp4"})"},
           {JobKind::kLive, R"({"video": "file:///v/a.mp4"})"},
           {JobKind::kLive, R"({"video": "http://host/"})"},
           {JobKind::kModel, R"({"name": "jeep", "files": ["/v/a.jpg", "/etc/passwd"]})"},
           {JobKind::kCopy, R"({"video": "/etc/passwd", "copy": "/d/c.mp4"})"},
           {JobKind::kCopy, R"({"video": "/v/a.mp4", "copy": "/home/ann/c.mp4"})"},
           {JobKind::kCopy, R"({"video": "/v/a.mp4", "copy": "/d/../home/c.mp4"})"},
           {JobKind::kCopy, R"({"video": "/v/a.mp4", "copy": "/d/.."})"},
           {JobKind::kClip, R"({"video": "/v/a.mp4", "object": 3, "clip": "/etc/c.mp4"})"},
           {JobKind::kClip, R"({"video": "/v/a.mp4", "object": 3, "clip": "/d/c.mp4", "telemetry": "/etc/passwd"})"},
           {JobKind::kTrack, R"({"video": "/etc/x", "box": [1, 2, 3, 4], "at_s": 0})"},
           {JobKind::kRefine, R"({"categories": "/etc/x.vcat", "refine": "/d/r.vcat"})"},
           {JobKind::kRefine, R"({"categories": "/d/kinds.vcat", "refine": "/etc/r.vcat"})"}}) {
    EXPECT_FALSE(JobArguments({.kind = kind, .input_json = input}, folders)) << ToText(kind) << input;
  }
}

TEST(RemoveUnfinishedCopies, RemovesTheTemporaryFilesOfTheCopy) {
  const testing::ScratchFolder folder;
  for (const char* name : {"c.mp4", "c.mp4.tmp-12", "c.mp4.tmp-12-0", "d.mp4.tmp-12", "c.mp4.old"}) {
    std::ofstream(folder / name) << "x";
  }
  RemoveUnfinishedCopies(folder / "c.mp4");
  RemoveUnfinishedCopies(folder / "none" / "c.mp4");
  std::set<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) left.insert(entry.path().filename());
  EXPECT_THAT(left, ElementsAre("c.mp4", "c.mp4.old", "d.mp4.tmp-12"));
}

// Runners whose jobs are shell scripts, in a folder where the scripts can leave files.
class JobRunnerTest : public ::testing::Test {
 protected:
  JobRunnerTest() {
    auto queue = OpenJobQueue(Index());
    EXPECT_TRUE(queue) << queue.error().message;
    queue_ = *std::move(queue);
  }

  [[nodiscard]] std::string Index() const { return folder_ / "index.db"; }
  [[nodiscard]] std::filesystem::path File(const std::string& name) const { return folder_ / name; }

  std::int64_t Submit() {
    return queue_->Submit({.kind = JobKind::kIndex, .input_json = R"({"video": "/v/a.mp4"})", .now_us = 1})->id;
  }

  // @param script  of /bin/sh, in the folder
  std::unique_ptr<JobRunner> StartRunner(const std::string& script) {
    return StartRunner(script, *OpenJobQueue(Index()), JobRunner::Options().lease);
  }

  std::unique_ptr<JobRunner> StartRunner(const std::string& script, std::unique_ptr<JobQueue> queue,
                                         std::chrono::milliseconds lease) {
    JobRunner::Options options{.lease = lease,
                               .renewal = std::chrono::milliseconds(1),
                               .poll = std::chrono::milliseconds(1),
                               .kinds = {JobKind::kIndex}};
    options.command = [script = "cd '" + folder_.path().string() + "'; " + script](const std::vector<std::string>&) {
      return ChildCommand{.executable = "/bin/sh", .arguments = {"sh", "-c", script}};
    };
    return std::make_unique<JobRunner>(std::move(queue), kFolders, [] {}, std::move(options));
  }

  // False if the condition does not come true within a minute.
  template <typename Condition>
  bool WaitUntil(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  bool WaitForState(std::int64_t job, WorkState state) {
    return WaitUntil([&] { return (*queue_->Find(job))->state == state; });
  }

  bool WaitForFile(const std::string& name) {
    return WaitUntil([&] { return std::filesystem::exists(File(name)); });
  }

  // Waits until the process has ended that wrote its id to the file `pid` before it made the file `started`.
  bool WaitForEndOfProcess() {
    pid_t pid = 0;
    std::ifstream(File("pid")) >> pid;
    return pid > 0 && WaitUntil([&] { return ::kill(pid, 0) != 0; });
  }

  testing::ScratchFolder folder_;
  std::unique_ptr<JobQueue> queue_;
};

constexpr char kRunUntilInterrupted[] = "trap 'exit 130' INT; echo $$ >pid; touch started; while :; do :; done";

TEST_F(JobRunnerTest, JobOfAnEndedRunnerIsDoneByTheNext) {
  const std::int64_t job = Submit();
  auto runner = StartRunner(kRunUntilInterrupted);
  ASSERT_TRUE(WaitForFile("started"));
  runner.reset();
  const JobRecord released = **queue_->Find(job);
  EXPECT_EQ(released.state, WorkState::kQueued);
  EXPECT_EQ(released.attempts, 0) << "an attempt that was given back does not count";
  runner = StartRunner("exit 0");
  EXPECT_TRUE(WaitForState(job, WorkState::kDone));
}

TEST_F(JobRunnerTest, CancelledJobIsInterrupted) {
  const std::int64_t job = Submit();
  const auto runner = StartRunner(kRunUntilInterrupted);
  ASSERT_TRUE(WaitForFile("started"));
  ASSERT_TRUE(queue_->Cancel(job, 2, ""));
  EXPECT_TRUE(WaitForState(job, WorkState::kCancelled));
}

TEST_F(JobRunnerTest, FailedJobSaysWhyAndTheNextIsDone) {
  const std::int64_t failing = Submit();
  const std::int64_t good = Submit();
  const auto runner = StartRunner(
      R"([ -e second ] && exit 0; touch second
         echo '{"event":"error","code":"data_loss","message":"/v/a.mp4: damaged"}' >&3; exit 1)");
  EXPECT_TRUE(WaitForState(good, WorkState::kDone));
  const JobRecord failed = **queue_->Find(failing);
  EXPECT_EQ(failed.state, WorkState::kFailed);
  EXPECT_EQ(failed.progress.message, "/v/a.mp4: damaged");
}

TEST_F(JobRunnerTest, ProcessOfALostJobIsKilled) {
  const std::int64_t job = Submit();
  const auto runner = StartRunner("trap '' INT; echo $$ >pid; touch started; while :; do :; done");
  ASSERT_TRUE(WaitForFile("started"));
  const std::int64_t after_the_lease = std::numeric_limits<std::int64_t>::max() / 2;
  const auto kinds = std::to_array({JobKind::kIndex});
  const auto taken = queue_->Claim("other", kinds, after_the_lease, 1'000'000);
  ASSERT_TRUE(taken && *taken);
  EXPECT_TRUE(WaitForEndOfProcess());
  EXPECT_EQ((**queue_->Find(job)).worker, "other");
}

// A queue whose database goes away after the claim.
class UnreachableQueue final : public JobQueue {
 public:
  explicit UnreachableQueue(std::unique_ptr<JobQueue> queue) : queue_(std::move(queue)) {}

  Expected<JobRecord> Submit(const NewJob&) override { return Away(); }
  Expected<SubmittedJob> SubmitOnce(const NewJob&) override { return Away(); }
  Expected<std::optional<JobRecord>> Claim(const std::string& worker, std::span<const JobKind> kinds,
                                           std::int64_t now_us, std::int64_t lease_us) override {
    if (std::exchange(is_claimed_, true)) return Away();
    return queue_->Claim(worker, kinds, now_us, lease_us);
  }
  Expected<bool> Renew(std::int64_t, const std::string&, std::int64_t, std::int64_t, const JobProgress&) override {
    return Away();
  }
  Status Complete(std::int64_t, const std::string&, const std::string&, std::int64_t) override { return Away(); }
  Status Fail(std::int64_t, const std::string&, const std::string&, std::int64_t) override { return Away(); }
  Status EndCancelled(std::int64_t, const std::string&, std::int64_t) override { return Away(); }
  Status Release(std::int64_t, const std::string&) override { return Away(); }
  Expected<JobRecord> Cancel(std::int64_t, std::int64_t, const std::string&) override { return Away(); }
  Expected<JobRecord> Retry(std::int64_t, std::int64_t, const std::string&) override { return Away(); }
  Status Remove(std::int64_t, std::int64_t, const std::string&) override { return Away(); }
  Expected<std::optional<JobRecord>> Find(std::int64_t) override { return Away(); }
  Expected<std::vector<JobRecord>> List(std::int64_t) override { return Away(); }
  Expected<std::int64_t> CountOpen() override { return Away(); }

 private:
  static std::unexpected<Error> Away() {
    return std::unexpected(Error{ErrorCode::kUnavailable, "the server does not answer"});
  }

  std::unique_ptr<JobQueue> queue_;
  bool is_claimed_ = false;
};

// Another server takes the job once its lease has run out, and removes what the process was writing.
TEST_F(JobRunnerTest, ProcessIsKilledWhenItsLeaseCannotBeRenewed) {
  Submit();
  const auto runner = StartRunner("trap '' INT; echo $$ >pid; touch started; while :; do :; done",
                                  std::make_unique<UnreachableQueue>(*OpenJobQueue(Index())), std::chrono::seconds(1));
  ASSERT_TRUE(WaitForFile("started"));
  EXPECT_TRUE(WaitForEndOfProcess());
}

TEST(ApplyEvent, KeepsTheLastCountAndTheLastMessage) {
  JobProgress progress;
  EXPECT_TRUE(ApplyEvent(
      ProgressEvent{.label = "udp://a", .done = 12, .total = 40, .unit = "frames", .elapsed_s = 3.5, .behind_s = 0.5},
      progress));
  EXPECT_EQ(progress.behind_s, 0.5);
  EXPECT_EQ(progress.done, 12);
  EXPECT_EQ(progress.total, 40);
  EXPECT_EQ(progress.unit, "frames");
  EXPECT_TRUE(
      ApplyEvent(ProgressEvent{.label = "views", .done = 7, .total = {}, .unit = "views", .elapsed_s = 1}, progress));
  EXPECT_EQ(progress.done, 7);
  EXPECT_FALSE(progress.total);
  EXPECT_FALSE(progress.behind_s);
  EXPECT_TRUE(ApplyEvent(InfoEvent{"12 sightings"}, progress));
  EXPECT_EQ(progress.message, "12 sightings");
  EXPECT_TRUE(ApplyEvent(WarningEvent{"no telemetry"}, progress));
  EXPECT_EQ(progress.message, "no telemetry");
  EXPECT_TRUE(ApplyEvent(ErrorEvent{{ErrorCode::kDataLoss, "x.mp4: not a video"}}, progress));
  EXPECT_EQ(progress.message, "x.mp4: not a video");
  EXPECT_FALSE(ApplyEvent(VideoLeftEvent{"x.mp4"}, progress)) << "an InfoEvent says so to people";
  EXPECT_EQ(progress.message, "x.mp4: not a video");
  EXPECT_EQ(progress.done, 7);
}

}  // namespace
}  // namespace victorious
