#include "experiments/experiment.h"

#include <algorithm>
#include <array>
#include <span>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "experiments/category_experiments.h"
#include "experiments/match_experiments.h"
#include "experiments/place_experiments.h"
#include "experiments/recognition_experiments.h"
#include "experiments/system_experiments.h"
#include "victorious/base/file.h"
#include "victorious/base/program_id.h"

namespace victorious {

Status ExperimentSettings::CheckCancelled() const {
  if (cancel != nullptr && cancel->IsCancelled()) return Fail(ErrorCode::kCancelled, "cancelled: no report written");
  return {};
}

Expected<std::string> ExperimentSettings::CacheKey(const std::string& inputs) const {
  std::string program_id = program;
  if (program_id.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(program_id, ProgramId());
  }
  const std::string key = inputs + " " + program_id;
  return fmt::format("{:016x}", Checksum(std::as_bytes(std::span(key))));
}

const CancelToken& ExperimentSettings::Cancel() const {
  static const CancelToken never;
  return cancel != nullptr ? *cancel : never;
}

std::span<const Experiment> Experiments() {
  static constexpr std::array kExperiments = {
      Experiment{"figure3.1", "Images with shuffled tiles: word scores stay, phrase scores fall", &RunFigure31},
      Experiment{"table3.2", "Matches of a template after each stage of the cascade", &RunTable32},
      Experiment{"figure3.10", "The same matches, drawn after each stage", &RunFigure310},
      Experiment{"table3.3", "True and false matches at six ratios, after each stage", &RunTable33},
      Experiment{"figure3.11", "The same matches, drawn", &RunFigure311},
      Experiment{"figure3.12", "ROC of the cascade's stages over ratios", &RunFigure312},
      Experiment{"table3.4", "A second object: matches before and after the cascade", &RunTable34},
      Experiment{"figure3.13", "The second object's matches, drawn after each stage and MLESAC", &RunFigure313},
      Experiment{"table3.5", "Time of matching, each stage and MLESAC", &RunTable35},
      Experiment{"figure3.14", "Number of matches of each view, as a heat map", &RunFigure314},
      Experiment{"figure3.15", "Number of matches of each view, as 3-D bars", &RunFigure315},
      Experiment{"figure3.16", "Objects detected under adverse conditions, with their templates", &RunFigure316},
      Experiment{"chapter3.filters", "The cascade compared with other filters and settings, on every scene",
                 &RunChapter3Filters},
      Experiment{"chapter3.sweeps", "Filters under noise, blur, compression, occlusion, scale, light and viewpoint",
                 &RunChapter3Sweeps},
      Experiment{"figure3.18", "Detection of CAD models in real images, untextured and textured with the first frame",
                 &RunFigure318},
      Experiment{"figure3.19", "Patches of single visual words", &RunFigure319},
      Experiment{"table3.6", "Area under ROC and time against the number of words in phrases", &RunTable36},
      Experiment{"figure3.20", "ROC of airplanes: words and phrases", &RunFigure320},
      Experiment{"figure3.21", "ROC of cars: words and phrases", &RunFigure321},
      Experiment{"table3.7", "Accuracy of airplanes and cars, the thesis's method and ours", &RunTable37},
      Experiment{"table-steps", "Accuracy of airplanes and cars, from the thesis's method to ours step by step",
                 &RunTableSteps},
      Experiment{"table-twelve", "Accuracy of all categories of the data, trained together", &RunTableTwelve},
      Experiment{"figure4.1", "Cost of recognition in the whole frame and in the tracked region", &RunFigure41},
      Experiment{"figure4.2", "The tracker alone, and with the recogniser", &RunFigure42},
      Experiment{"figure4.3", "The conic frustum of one sighting", &RunFigure43},
      Experiment{"figure4.4", "The intersection of the conic frusta of many sightings", &RunFigure44},
      Experiment{"figure4.5", "The list of objects over time: active and inactive", &RunFigure45},
      Experiment{"figure5.2", "Recall and precision of objects under 29 settings of the parameters", &RunFigure52},
      Experiment{"figure5.3", "Frame detection density over settings, movies and objects", &RunFigure53},
      Experiment{"figure5.4", "Place errors by kind of object", &RunFigure54},
      Experiment{"figure5.5", "Place errors of the helicopter and of all other kinds", &RunFigure55},
      Experiment{"table5.1", "Running time of each step of a frame, and of a whole frame with 25 models", &RunTable51},
      Experiment{"table-boxes", "Localisation of categories: boxes of the supporting phrases against annotated boxes",
                 &RunTableBoxes},
      Experiment{"table-windows", "Several small objects in a frame: sliding windows against the whole frame",
                 &RunTableWindows},
      Experiment{"table-cad", "CAD models as training examples of a category, against a few photos", &RunTableCad},
      Experiment{"figure-calibration", "Calibration of detection scores", &RunFigureCalibration},
      Experiment{"table-features", "Feature engines: repeatability and correct matches at equal counts",
                 &RunTableFeatures},
      Experiment{"table-shortlist", "The shortlist search against the vote search: lost sightings and time",
                 &RunTableShortlist},
      Experiment{"descriptor-cells", "Cells of shortened descriptors for proposals: writes descriptor_cells.inc",
                 &RunDescriptorCells},
      Experiment{"table-object-pose", "Errors of view and distance, by what is known of the camera",
                 &RunTableObjectPose},
      Experiment{"table-cheyenne", "Places from a real flight's stares, against the recorded frame centres",
                 &RunTableCheyenne},
      Experiment{"table-brighton", "Agreement of the places of one object from several photos", &RunTableBrighton},
      Experiment{"table-control-points", "Surveyed points, located with cameras that do not move",
                 &RunTableControlPoints},
  };
  return kExperiments;
}

Expected<const Experiment*> FindExperiment(const std::string& name) {
  const auto all = Experiments();
  const auto experiment = std::ranges::find_if(all, [&](const Experiment& one) { return name == one.name; });
  if (experiment == all.end()) {
    std::vector<std::string_view> names;
    for (const Experiment& one : all) names.emplace_back(one.name);
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no such experiment; must be one of `victorious experiment list`: {}", name,
                            fmt::join(names, ", ")));
  }
  return &*experiment;
}

Expected<Report> RunExperiment(const std::string& name, const ExperimentSettings& settings) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Experiment* const experiment, FindExperiment(name));
  std::error_code error;
  std::filesystem::create_directories(settings.out, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), "make folder " + settings.out.string()));
  VICTORIOUS_ASSIGN_OR_RETURN(Report report, experiment->run(settings));
  report.name = experiment->name;
  VICTORIOUS_RETURN_IF_ERROR(WriteReport(report, settings.out));
  return report;
}

}  // namespace victorious
