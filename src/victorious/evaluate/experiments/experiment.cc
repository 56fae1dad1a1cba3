#include "victorious/evaluate/experiments/experiment.h"

#include <algorithm>
#include <array>
#include <span>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/file.h"
#include "victorious/base/program_id.h"
#include "victorious/evaluate/experiments/category_experiments.h"
#include "victorious/evaluate/experiments/match_experiments.h"
#include "victorious/evaluate/experiments/place_experiments.h"
#include "victorious/evaluate/experiments/recognition_experiments.h"
#include "victorious/evaluate/experiments/system_experiments.h"

namespace victorious {

Status ExperimentSettings::CheckCancelled() const {
  if (cancel != nullptr && cancel->IsCancelled()) return Fail(ErrorCode::kCancelled, "cancelled: nothing was written");
  return {};
}

Expected<std::string> ExperimentSettings::KeptAs(const std::string& made_of) const {
  std::string made_by = program;
  if (made_by.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(made_by, ProgramId());
  }
  const std::string key = made_of + " " + made_by;
  return fmt::format("{:016x}", Checksum(std::as_bytes(std::span(key))));
}

const CancelToken& ExperimentSettings::Cancel() const {
  static const CancelToken never;
  return cancel != nullptr ? *cancel : never;
}

std::span<const Experiment> Experiments() {
  static constexpr std::array kExperiments = {
      Experiment{"figure3.1", "A picture and its shuffled tiles: words cannot tell, phrases can", &RunFigure31},
      Experiment{"table3.2", "What each stage of the cascade leaves of a template's matches", &RunTable32},
      Experiment{"figure3.10", "The same matches, drawn stage by stage", &RunFigure310},
      Experiment{"table3.3", "True and false matches at six ratios, stage by stage", &RunTable33},
      Experiment{"figure3.11", "The same matches, drawn", &RunFigure311},
      Experiment{"figure3.12", "ROC of the cascade's stages over ratios", &RunFigure312},
      Experiment{"table3.4", "A second object: matches before and after the cascade", &RunTable34},
      Experiment{"figure3.13", "Its matches, drawn stage by stage with MLESAC", &RunFigure313},
      Experiment{"table3.5", "Time of matching, each stage and MLESAC", &RunTable35},
      Experiment{"figure3.14", "Which of all views has the most matches, as a heat map", &RunFigure314},
      Experiment{"figure3.15", "The same as bars in space", &RunFigure315},
      Experiment{"figure3.16", "Objects found under adverse conditions, with their templates", &RunFigure316},
      Experiment{"chapter3.filters", "The cascade beside other filters and settings, over every scene",
                 &RunChapter3Filters},
      Experiment{"chapter3.sweeps", "Filters under noise, blur, compression, occlusion, scale, light and viewpoint",
                 &RunChapter3Sweeps},
      Experiment{"figure3.18", "Real pictures against CAD models, plain and painted with the first frame",
                 &RunFigure318},
      Experiment{"figure3.19", "Patches that became one visual word", &RunFigure319},
      Experiment{"table3.6", "Area under ROC and time over the number of words in phrases", &RunTable36},
      Experiment{"figure3.20", "ROC of airplanes: words and phrases", &RunFigure320},
      Experiment{"figure3.21", "ROC of cars: words and phrases", &RunFigure321},
      Experiment{"table3.7", "Accuracy of airplanes and cars, the thesis's method and ours", &RunTable37},
      Experiment{"table-steps", "The same, from the thesis's method to ours, one step at a time", &RunTableSteps},
      Experiment{"table-twelve", "Accuracy of all categories of the data given, trained together", &RunTableTwelve},
      Experiment{"figure4.1", "What a tracker saves the recogniser: whole frame and tracked region", &RunFigure41},
      Experiment{"figure4.2", "The tracker alone, and with the recogniser", &RunFigure42},
      Experiment{"figure4.3", "The conic frustum of one sighting", &RunFigure43},
      Experiment{"figure4.4", "What is common to the conic frusta of many sightings", &RunFigure44},
      Experiment{"figure4.5", "The list of objects over time: active and inactive", &RunFigure45},
      Experiment{"figure5.2", "Recall and precision of objects under 29 settings of the parameters", &RunFigure52},
      Experiment{"figure5.3", "Frame detection density over settings, movies and objects", &RunFigure53},
      Experiment{"figure5.4", "Errors of place by kind of object", &RunFigure54},
      Experiment{"figure5.5", "Errors of place: the helicopter and all other kinds", &RunFigure55},
      Experiment{"table-boxes", "Where categories are: boxes of the supporting phrases beside drawn ones",
                 &RunTableBoxes},
      Experiment{"table-windows", "Things small in a frame, and several: windows beside the whole frame",
                 &RunTableWindows},
      Experiment{"table-cad", "CAD models as examples of their kind, beside a few photos", &RunTableCad},
      Experiment{"figure-calibration", "Whether scores of detections are probabilities", &RunFigureCalibration},
      Experiment{"table-stance", "Errors of view and distance, by how the camera is known", &RunTableStance},
      Experiment{"table-cheyenne", "Places by a real flight's stares, beside the recorded frame centres",
                 &RunTableCheyenne},
      Experiment{"table-brighton", "One thing in several photos: whether it comes out at one place", &RunTableBrighton},
      Experiment{"table-control-points", "Surveyed points, placed by cameras that do not move", &RunTableControlPoints},
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
                fmt::format("{}: no such experiment; `victorious experiment list` tells of each: {}", name,
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
