// Robustness of the filters against one degradation at a time: the two running examples with increasing salt-and-pepper
// noise, blur, compression, occlusion, smaller scale, changed light, or a template of another view.
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "experiments/match_experiments.h"
#include "experiments/match_filters.h"
#include "experiments/match_trial.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/object/model/nearest_view.h"

namespace victorious {
namespace {

constexpr double kSweepRatio = 0.85;

// One step of one degradation.
struct Difficulty {
  std::string name;
  double value;
  std::function<void(Scene&)> change = [](Scene&) {};
  ImageDegradation degradation = {.degrade = {.grain = 1}, .jpeg_quality = 90};
  double hidden = 0;        ///< occluded fraction of the object's box
  double view_off_deg = 0;  ///< azimuth of the template's view relative to the true one
};

std::vector<Difficulty> Difficulties() {
  std::vector<Difficulty> all;
  for (const double percent : {0.0, 2.0, 5.0, 10.0, 15.0}) {
    all.push_back({.name = "salt and pepper (%)", .value = percent});
    all.back().degradation.degrade.noise = percent / 100;
  }
  for (const double sigma : {0.0, 0.7, 1.4, 2.1, 2.8}) {
    all.push_back({.name = "blur (sigma, px)", .value = sigma});
    all.back().degradation.degrade.blur_px = sigma;
  }
  for (const int quality : {90, 60, 30, 15, 8}) {
    all.push_back({.name = "JPEG quality", .value = static_cast<double>(quality)});
    all.back().degradation.jpeg_quality = quality;
  }
  for (const double percent : {0.0, 20.0, 40.0, 60.0, 80.0})
    all.push_back({.name = "hidden (%)", .value = percent, .hidden = percent / 100});
  for (const double size : {1.0, 0.7, 0.5, 0.35, 0.25}) {
    all.push_back({.name = "size", .value = size, .change = [size](Scene& scene) { scene.video.hfov_deg /= size; }});
  }
  for (const double turn : {0.0, 45.0, 90.0, 135.0, 180.0}) {
    all.push_back({.name = "sun turned (degrees)", .value = turn, .change = [turn](Scene& scene) {
                     scene.sun.azimuth_deg += turn;
                   }});
  }
  for (const double off : {0.0, 10.0, 20.0, 30.0, 40.0})
    all.push_back({.name = "template off (degrees of azimuth)", .value = off, .view_off_deg = off});
  return all;
}

// Occludes the left fraction of a box with another part of the same image.
void Occlude(double share, const Box& box, AnnotatedImage& scene) {
  const cv::Rect frame({0, 0}, scene.bgr.size());
  const cv::Rect cover =
      cv::Rect(cv::Point2d(box.x, box.y), cv::Size(static_cast<int>(box.width * share), static_cast<int>(box.height))) &
      frame;
  if (cover.area() == 0) return;
  // Source: the image corner farthest from the object.
  const cv::Point from(box.x + box.width / 2 < frame.width / 2.0 ? frame.width - cover.width : 0,
                       box.y + box.height / 2 < frame.height / 2.0 ? frame.height - cover.height : 0);
  scene.bgr(cv::Rect(from, cover.size())).clone().copyTo(scene.bgr(cover));
  scene.depth_m(cover).setTo(1);  // m, nearer than all surfaces
}

// The scene and the model that all steps share.
struct Example {
  std::string kind;
  std::shared_ptr<const SceneRenderer> town;
  std::shared_ptr<const ObjectModel> model;
};

Expected<MatchTrial> TrialUnder(const Difficulty& difficulty, const Example& example, const MatchSetup& setup) {
  Scene scene = example.town->scene();
  scene.video.blur_px = scene.video.grain = scene.video.noise = 0;
  difficulty.change(scene);
  VICTORIOUS_ASSIGN_OR_RETURN(AnnotatedImage known, example.town->Draw(scene, 0, {}));
  const LabelledObject* const object = known.Find(example.kind);
  if (object == nullptr)
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: must show a {}", known.name, example.kind));
  ViewDirection view = object->view;
  view.azimuth_rad += RadiansFromDegrees(difficulty.view_off_deg);
  Occlude(difficulty.hidden, object->box, known);
  VICTORIOUS_RETURN_IF_ERROR(DegradeImage(difficulty.degradation, scene.seed, known.bgr));
  VICTORIOUS_ASSIGN_OR_RETURN(auto features, ExtractImageFeatures(known, setup.features));
  const std::size_t nearest = NearestView(*example.model, view);
  return MakeTrial(std::make_shared<const AnnotatedImage>(std::move(known)), std::move(features), example.model,
                   nearest);
}

}  // namespace

Expected<Report> RunChapter3Sweeps(const ExperimentSettings& settings) {
  Report report{.title = "Filters under one difficulty at a time, the two running examples pooled, at a ratio of 0.85",
                .columns = {"setting", "difficulty", "value", "filter", "true before", "false before", "true kept %",
                            "false after"}};
  report.plot = {.title = "True matches kept by the cascade, relative to the easiest step",
                 .x = {.label = "step of each difficulty, easiest first"},
                 .y = {.label = "%", .low = 0, .high = 110}};
  VICTORIOUS_ASSIGN_OR_RETURN(Renderer renderer, Renderer::Create({.software = true}));
  for (const MatchSetup& setup : {ThesisSetup(), DefaultSetup()}) {
    std::vector<Example> examples;
    for (const char* kind : {"jeep", "jet"}) {
      VICTORIOUS_ASSIGN_OR_RETURN(
          SceneRenderer town,
          SceneRenderer::Load(settings.scenes / fmt::format("chapter3_{}.json", kind), renderer, settings.Cancel()));
      VICTORIOUS_ASSIGN_OR_RETURN(
          auto model,
          LoadOrBuildModel(settings, town.scene().assets / "models" / fmt::format("{}.glb", kind), setup.cad));
      examples.push_back({kind, std::make_shared<const SceneRenderer>(std::move(town)), std::move(model)});
    }
    std::vector<MatchFilter> filters = MakeMatchFilters(setup.recognize);
    CascadeOptions by_scale = setup.recognize.cascade;
    by_scale.radius = CascadeRadius::kScale;
    filters.push_back(MakeGrammarFilter("cascade, R from scale", by_scale));
    double easiest = 0;
    for (const Difficulty& difficulty : Difficulties()) {
      VICTORIOUS_RETURN_IF_ERROR(settings.CheckCancelled());
      std::vector<MatchTrial> trials;
      for (const Example& example : examples) {
        VICTORIOUS_ASSIGN_OR_RETURN(MatchTrial trial, TrialUnder(difficulty, example, setup));
        trials.push_back(std::move(trial));
      }
      for (const MatchFilter& filter : filters) {
        MatchCount before;
        MatchCount after;
        for (const MatchTrial& trial : trials) {
          const MatchSet matches = trial.Matches(kSweepRatio);
          before += trial.Count(matches);
          after += trial.Count(filter.run(trial, matches));
        }
        report.rows.push_back({setup.name, difficulty.name, difficulty.value, filter.name,
                               static_cast<double>(before.correct), static_cast<double>(before.FalseMatches()),
                               before.correct > 0 ? 100.0 * after.correct / before.correct : 0.0,
                               static_cast<double>(after.FalseMatches())});
        if (filter.kind != MatchFilterKind::kCascade || setup.kind != MatchSetup::Kind::kDefault) continue;
        std::vector<PlotLine>& lines = report.plot.lines;
        if (lines.empty() || lines.back().name != difficulty.name) {
          lines.push_back({.name = difficulty.name, .points = {}});
          easiest = std::max(1, after.correct);
        }
        lines.back().points.push_back({static_cast<double>(lines.back().points.size()), 100 * after.correct / easiest});
      }
      settings.progress(fmt::format("{}: {} {:g}", setup.name, difficulty.name, difficulty.value));
    }
  }
  report.notes = {
      "Each difficulty alone, on images with a sensor noise of 1 and JPEG quality 90. Hidden: the left part of the "
      "object's box is covered by another part of the image. Size: the field of view is widened. Sun: rotated "
      "about the vertical, with its shadows."};
  return report;
}

}  // namespace victorious
