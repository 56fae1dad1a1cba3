// victorious match SCENE TEMPLATE: the matches of two images after each stage
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/input/image/image_file.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/object/model/photo_model.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious::cli {
namespace {

using nlohmann::ordered_json;

struct MatchArguments {
  std::string scene;
  std::string model;
  std::optional<double> ratio;
  std::string params;
  std::string draw;
  bool json = false;
};

struct Stage {
  const char* name;
  const MatchSet* matches;
};

// The matches that the best fit explains; none without a fit.
MatchSet BestInliers(const StagedMatches& staged) {
  return staged.fits.empty() ? MatchSet() : SelectInliers(staged.cascade.third, staged.fits.front());
}

// @param inliers  of BestInliers()
std::vector<Stage> ListStages(const StagedMatches& staged, const MatchSet& inliers) {
  return {{"ratio", &staged.ratio},
          {"first", &staged.cascade.first},
          {"second", &staged.cascade.second},
          {"third", &staged.cascade.third},
          {"mlesac", &inliers}};
}

ordered_json Report(const FeatureSet& scene, const FeatureView& model, const StagedMatches& staged,
                    const Polygon& outline) {
  const MatchSet inliers = BestInliers(staged);
  const PlanarFit* fit = staged.fits.empty() ? nullptr : &staged.fits.front();
  ordered_json stages = ordered_json::array();
  for (const Stage& stage : ListStages(staged, inliers)) {
    ordered_json matches = ordered_json::array();
    for (const Match& match : *stage.matches) {
      const Keypoint& s = scene.keypoints[match.scene_keypoint];
      const Keypoint& m = model.keypoints[match.template_keypoint];
      matches.push_back({{"scene", {s.x, s.y}},
                         {"template", {m.x, m.y}},
                         {"scale", s.scale_px / m.scale_px},
                         {"ratio", match.ratio}});
    }
    stages.push_back({{"name", stage.name}, {"matches", std::move(matches)}});
  }
  ordered_json json = {
      {"scene_keypoints", scene.size()}, {"template_keypoints", model.size()}, {"stages", std::move(stages)}};
  if (fit == nullptr) {
    json["similarity"] = nullptr;
    json["homography"] = nullptr;
    json["outline"] = nullptr;
    return json;
  }
  const Similarity2& similarity = fit->scene_from_template;
  json["similarity"] = {{"scale", similarity.scale},
                        {"rotation_deg", DegreesFromRadians(similarity.rotation_rad)},
                        {"translation", {similarity.translation.x(), similarity.translation.y()}}};
  const Eigen::Matrix3d& h = fit->scene_from_template_plane;
  json["homography"] = {{h(0, 0), h(0, 1), h(0, 2)}, {h(1, 0), h(1, 1), h(1, 2)}, {h(2, 0), h(2, 1), h(2, 2)}};
  json["outline"] = ordered_json::array();
  for (const Eigen::Vector2d& corner : ProjectPolygon(h, outline)) json["outline"].push_back({corner.x(), corner.y()});
  return json;
}

// Those that the grammar does not keep.
MatchSet RejectedMatches(const StagedMatches& staged) {
  const auto key = [](const Match& match) { return std::pair(match.scene_keypoint, match.template_keypoint); };
  std::set<std::pair<std::uint32_t, std::uint32_t>> kept;
  for (const Match& match : staged.cascade.third) kept.insert(key(match));
  MatchSet rejected;
  for (const Match& match : staged.ratio) {
    if (!kept.contains(key(match))) rejected.push_back(match);
  }
  return rejected;
}

// Draws the scene beside the template: matches rejected by the grammar in cyan, matches kept in red, the outline in
// yellow. Of many matches some, spread evenly over the list; the caption below says how many.
cv::Mat Draw(const cv::Mat& scene_image, const cv::Mat& model_image, const FeatureSet& scene, const FeatureView& model,
             const StagedMatches& staged, const Polygon& outline) {
  constexpr std::size_t kMaxLines = 100;  // of one colour: more would hide the images
  constexpr int kCaptionHeight_px = 36;
  constexpr int kCaptionWidth_px = 340;
  const int height = std::max(scene_image.rows, model_image.rows);
  cv::Mat canvas(height + kCaptionHeight_px, std::max(scene_image.cols + model_image.cols, kCaptionWidth_px), CV_8UC3,
                 cv::Scalar::all(32));
  scene_image.copyTo(canvas(cv::Rect({0, 0}, scene_image.size())));
  model_image.copyTo(canvas(cv::Rect({scene_image.cols, 0}, model_image.size())));
  const auto draw = [&](const MatchSet& matches, const cv::Scalar& colour, std::string_view what, int caption_y) {
    const std::size_t drawn = std::min(matches.size(), kMaxLines);
    for (std::size_t i = 0; i < drawn; ++i) {
      const Match& match = matches[i * matches.size() / drawn];
      const Keypoint& s = scene.keypoints[match.scene_keypoint];
      const Keypoint& m = model.keypoints[match.template_keypoint];
      cv::line(canvas, cv::Point2f(s.x, s.y), cv::Point2f(m.x + static_cast<float>(scene_image.cols), m.y), colour, 1,
               cv::LINE_AA);
    }
    cv::putText(canvas, fmt::format("{} of {} matches that the grammar {}", drawn, matches.size(), what),
                {4, height + caption_y}, cv::FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv::LINE_AA);
  };
  draw(RejectedMatches(staged), {200, 200, 0}, "rejects", 30);
  draw(staged.cascade.third, {80, 80, 255}, "keeps", 14);
  for (const PlanarFit& fit : staged.fits) {
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& corner : ProjectPolygon(fit.scene_from_template_plane, outline))
      corners.emplace_back(cv::Point2d(corner.x(), corner.y()));
    cv::polylines(canvas, corners, true, {0, 255, 255}, 2, cv::LINE_AA);
  }
  return canvas;
}

Status Run(const MatchArguments& arguments, const ArgumentParser& parser) {
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--draw", arguments.draw, FileKind::kImage}}));
  IndexOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (arguments.ratio) options.recognize.match.ratio = *arguments.ratio;
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(CollectFields(options), {{"match.ratio", "--ratio"}}));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto extractor, MakeFeatureExtractor(options.features));
  VICTORIOUS_ASSIGN_OR_RETURN(const Image scene_image, ReadImage(arguments.scene));
  VICTORIOUS_ASSIGN_OR_RETURN(const FeatureSet scene, extractor->Extract(GreyFromBgr(scene_image.bgr)));
  VICTORIOUS_ASSIGN_OR_RETURN(const Image model_image, ReadImage(arguments.model));
  VICTORIOUS_ASSIGN_OR_RETURN(const Photo photo,
                              PreparePhoto(arguments.model, model_image.bgr, model_image.alpha, std::nullopt));
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model, MakePhotoModel("template", std::span(&photo, 1), std::nullopt,
                                                                {.features = options.features}));
  VICTORIOUS_ASSIGN_OR_RETURN(const Recognizer recognizer,
                              Recognizer::Create({std::move(model)}, options.features.engine, options.recognize));
  const StagedMatches staged = recognizer.MatchView(scene, 0, 0);
  const FeatureView features = recognizer.models()[0].ViewFeatures(0);
  if (!arguments.draw.empty()) {
    VICTORIOUS_RETURN_IF_ERROR(
        WriteImage(arguments.draw, Draw(scene_image.bgr, model_image.bgr, scene, features, staged, photo.outline)));
  }
  if (arguments.json) return WriteOutput("", DumpJson(Report(scene, features, staged, photo.outline)) + "\n");

  const MatchSet inliers = BestInliers(staged);
  const PlanarFit* fit = staged.fits.empty() ? nullptr : &staged.fits.front();
  std::string text = fmt::format("keypoints: {} in the scene, {} in the template\n", scene.size(), features.size());
  for (const Stage& stage : ListStages(staged, inliers))
    text += fmt::format("{:<8} {:>6} matches\n", stage.name, stage.matches->size());
  if (fit == nullptr) {
    text += "no pose: template not found\n";
  } else {
    const Similarity2& similarity = fit->scene_from_template;
    text += fmt::format("pose     scale {:.3f}, rotation {:.1f} degrees, template origin at {:.1f},{:.1f}\n",
                        similarity.scale, DegreesFromRadians(similarity.rotation_rad), similarity.translation.x(),
                        similarity.translation.y());
  }
  return WriteOutput("", text);
}

}  // namespace

Action SetUpMatch(ArgumentParser& parser) {
  const auto arguments = std::make_shared<MatchArguments>();
  parser.Add("SCENE", arguments->scene, "The image to search").Required();
  parser.Add("TEMPLATE", arguments->model, "The image of the object; an alpha channel masks the background").Required();
  parser.Add("--ratio", arguments->ratio, "Lowe's ratio test (default 0.8)").TypeName("R");
  AddParams(parser, arguments->params, "index");
  parser
      .Add("--draw", arguments->draw,
           "Draw the matches and the outline into this PNG: of many matches some, as its caption says")
      .TypeName("FILE");
  parser.AddFlag("--json", arguments->json, "Print the matches of every stage as JSON");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
