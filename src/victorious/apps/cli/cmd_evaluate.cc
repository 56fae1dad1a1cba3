// victorious evaluate --db DB --truth FILE
#include <memory>
#include <set>

#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/json.h"
#include "victorious/lab/evaluate/reliability.h"
#include "victorious/lab/evaluate/reported.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/lab/evaluate/truth.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

struct EvaluateArguments {
  std::string db;
  std::string truth;
  std::string video;
  std::vector<std::string> models;
  bool scores = false;
  bool rejected = false;
  bool weak = false;
  bool json = false;
};

Status Run(const EvaluateArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TruthRow> truth, ReadTruth(arguments.truth));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments.db, StoreMode::kRead));
  SightingFilter filter;
  if (!arguments.video.empty()) filter.video_name = arguments.video;
  filter.include_rejected = arguments.rejected;
  filter.without_weak = !arguments.weak;
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(*store, filter));
  if (catalogue.videos().size() > 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "the index contains several videos: select that of the truth with --video");
  }
  if (!arguments.models.empty()) {
    const std::set<std::string> keep(arguments.models.begin(), arguments.models.end());
    std::erase_if(truth, [&](const TruthRow& row) { return !keep.contains(row.model); });
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const ReportedContent reported, ReadReported(*store, filter));
  const Score score = ScoreIndex(truth, reported.objects, reported.sightings);
  nlohmann::ordered_json json = ToJson(score);
  std::string text = ToText(score);
  if (arguments.scores) {
    filter.without_weak = false;  // whether their scores are right, all of them say
    VICTORIOUS_ASSIGN_OR_RETURN(const ReportedContent all, ReadReported(*store, filter));
    const std::vector<JudgedObject> judged = JudgeObjects(truth, all.objects, all.sightings);
    const Reliability reliability = MeasureReliability(judged);
    json["reliability"] = ToJson(reliability, judged);
    text += ToText(reliability, judged);
  }
  return WriteOutput("", arguments.json ? DumpJson(json, 1) + "\n" : text);
}

}  // namespace

Action SetUpEvaluate(ArgumentParser& parser) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  AddDb(parser, arguments->db);
  parser.Add("--truth", arguments->truth, "Ground truth (truth.jsonl) of the video").Required().TypeName("FILE");
  parser.Add("--models", arguments->models, "Models that were searched: truth of other models is ignored")
      .SplitAt(',')
      .TypeName("A,B");
  parser.Add("--video", arguments->video, "The video, if the index contains several").TypeName("NAME");
  parser.AddFlag("--scores", arguments->scores, "Also: which objects are right, and whether their scores say so");
  parser.AddFlag("--rejected", arguments->rejected, "Count rejected objects as if they were reported");
  parser.AddFlag(
      "--weak", arguments->weak,
      fmt::format("Count weak finds, too: what scores below {:g}, and no export has by default", kWeakScore));
  parser.AddFlag("--json", arguments->json, "Print JSON");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
