// victorious sheet --db DB --out PNG [--json]: draws the found objects on a contact sheet
#include <cstdint>
#include <memory>
#include <ranges>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/stored_video.h"
#include "victorious/show/contact_sheet.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

// Checks the videos of the objects shown.
Status CheckContents(const SightingFilter& filter, int max_tiles, const Catalogue& catalogue, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects(filter));
  std::set<std::int64_t> checked;
  for (const ObjectRecord& object : objects | std::views::take(max_tiles)) {
    for (const std::int64_t id : object.videos) {
      const VideoRecord* video = catalogue.Video(id);
      if (video == nullptr || !checked.insert(id).second) continue;
      VICTORIOUS_RETURN_IF_ERROR(OpenStoredVideo(*video, {}, Interrupt()));
    }
  }
  return {};
}

}  // namespace

Action SetUpSheet(ArgumentParser& parser) {
  struct Arguments {
    std::string db;
    std::string out;
    ContactSheetOptions options;
    FilterArguments filter;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  AddDb(parser, arguments->db, "The index, whose videos must still be at their paths");
  parser.Add("--out", arguments->out, "The output image (.png, .jpg)").Required().TypeName("FILE");
  parser.Add("--most", arguments->options.max_tiles, "Largest number of objects to show, best first").TypeName("N");
  parser
      .Add("--moments", arguments->options.moments,
           "Number of moments at which each object is cut out, spread over its sightings (default 3)")
      .TypeName("N");
  parser.Add("--columns", arguments->options.columns, "Images per row").TypeName("N");
  arguments->filter.AddTo(parser);
  parser.AddFlag("--json", arguments->json, "Print one JSON object: the image and its size");
  AddForce(parser);
  return [=]() -> Status {
    VICTORIOUS_RETURN_IF_ERROR(
        CheckFlags(CollectFields(arguments->options),
                   {{"max_tiles", "--most"}, {"columns", "--columns"}, {"moments", "--moments"}}));
    VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments->filter.Filter());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments->db, StoreMode::kRead));
    VICTORIOUS_RETURN_IF_ERROR(CheckObject(filter, *store));
    VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(*store, filter));
    std::vector<std::string> videos;
    for (const VideoRecord& video : catalogue.videos()) videos.push_back(FindVideoFile(video));
    VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments->out, FileKind::kImage}}, videos));
    VICTORIOUS_RETURN_IF_ERROR(CheckDrawnImage(arguments->out));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string nothing, ExplainNothingFound(filter, *store));
    if (!nothing.empty()) return Fail(ErrorCode::kInvalidArgument, nothing);
    VICTORIOUS_RETURN_IF_ERROR(CheckContents(filter, arguments->options.max_tiles, catalogue, *store));
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat sheet, DrawContactSheet(filter, arguments->options, *store));
    VICTORIOUS_RETURN_IF_ERROR(WriteImage(arguments->out, sheet));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string below, ExplainScores(filter, *store));
    if (!below.empty()) LogInfo(OneLine(below));
    if (!arguments->json) return {};
    const nlohmann::ordered_json line = {{"image", arguments->out}, {"width", sheet.cols}, {"height", sheet.rows}};
    return WriteOutput("", DumpJson(line) + "\n");
  };
}

}  // namespace victorious::cli
