#include "experiments/draw_matches.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "victorious/input/image/image_file.h"
#include "victorious/input/image/montage.h"
#include "victorious/object/model/view_surface.h"

namespace victorious {
namespace {

const cv::Scalar kTrueColour(40, 40, 255);
const cv::Scalar kNearColour(0, 200, 255);
const cv::Scalar kFalseColour(230, 220, 0);

}  // namespace

Expected<cv::Mat> DrawMatches(const MatchTrial& trial, const MatchSet& matches, double scale,
                              const std::string& caption) {
  const cv::Mat scene = PosteriseImage(GreyFromBgr(trial.scene->bgr), scale);
  VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface,
                              DecodeSurface(trial.model->views[trial.view].surface, trial.model->name));
  const cv::Mat object = PosteriseImage(surface.grey, scale);
  cv::Mat canvas(std::max(scene.rows, object.rows), scene.cols + object.cols, CV_8UC3, cv::Scalar::all(0));
  scene.copyTo(canvas(cv::Rect({0, 0}, scene.size())));
  object.copyTo(canvas(cv::Rect({scene.cols, 0}, object.size())));
  // False matches first, so that true ones are drawn on top.
  for (const auto& [truth, colour] :
       {std::pair{MatchLabel::kFalse, kFalseColour}, std::pair{MatchLabel::kNear, kNearColour},
        std::pair{MatchLabel::kTrue, kTrueColour}}) {
    for (const Match& match : matches) {
      const Keypoint& in_scene = trial.features->keypoints[match.scene_keypoint];
      const Keypoint& in_template = trial.Template().keypoints[match.template_keypoint];
      if (trial.truth.Label(in_scene, match.template_keypoint) != truth) continue;
      cv::line(canvas, cv::Point2d(in_scene.x * scale, in_scene.y * scale),
               cv::Point2d(in_template.x * scale + scene.cols, in_template.y * scale), colour);
    }
  }
  constexpr double kFont = 0.4;
  cv::putText(canvas, caption, {4, canvas.rows - 6}, cv::FONT_HERSHEY_SIMPLEX, kFont, cv::Scalar::all(0), 3);
  cv::putText(canvas, caption, {4, canvas.rows - 6}, cv::FONT_HERSHEY_SIMPLEX, kFont, cv::Scalar::all(255), 1);
  return canvas;
}

}  // namespace victorious
