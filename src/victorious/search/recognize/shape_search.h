// recognize/, the search for CAD models by the shape of their edges, for objects of one colour, small or repainted:
// they have few keypoints, or others than the file. Needs the camera's attitude and height above the ground, which
// leave one size and one off-nadir angle for each place of the frame; the heading is searched.
//
// Method: templates are drawn from the model's stored surfaces (search/shape/surface_template.h) in the model's own
// paint and in one grey, and whitened by the statistics of the video's background (search/shape/background_spectrum.h):
// exemplar linear discriminants, as Aubry et al. (CVPR 2014) align CAD models. A response s has standard deviation 1 on
// background.
//   glance  templates of 32 px for all headings, 10 degrees apart, lit from above, over the whole frame: some places
//   coarse  templates of 64 px of the headings near that of a glance, around it: the best places of each model
//   fine    templates of 96 px, 5 degrees apart, in the sun, around each of them
//   examine larger templates, and the pose refined on the edges (shape_evidence.h): what speaks for a match
// Where the camera is assumed, the response s of fine templates decides:
//   -log10 NFA = kDecadesPerResponse (s - kResponseOfOneFalseAlarm)
// The two constants describe the largest responses of frames without the object, chosen in docs/adr/0035. Of matches
// of several models in one place the most significant counts.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/recognize/contour_search.h"
#include "victorious/search/shape/surface_template.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// The response that one place in a frame without the object reaches, for one model, and how fast larger ones become
/// rare (docs/adr/0035).
inline constexpr double kResponseOfOneFalseAlarm = 7.3;
inline constexpr double kResponseOfOneFalseAlarmPlain = 7.4;  ///< of templates in one grey: vehicles of other kinds fit
inline constexpr double kDecadesPerResponse = 1.3;

/// The diagonal of a model's bounding box in its fine and its coarse templates at most, px.
inline constexpr double kFineSize_px = 96;
inline constexpr double kCoarseSize_px = 64;

/// What is gained where only a place and a heading are searched instead of a frame, and the -log10 NFA that a match
/// there must reach: less for one whose size, distance and edges were examined.
inline constexpr double kDecadesOfOnePlace = 2.5;
inline constexpr double kMinDecadesInOnePlace = 1.5;
inline constexpr double kMinDecadesUnexamined = 4;

/// What is lost where the camera is assumed (common_view.h): sizes are known to some per cent only, and no place on the
/// ground contradicts what looks alike.
inline constexpr double kDecadesOfAssumedCamera = 1;

/// A model found by its shape in one frame.
struct ShapeMatch {
  std::size_t model_index = 0;
  ViewDirection to_camera;                              ///< from the object, in the model frame
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();  ///< of the object's bounding box
  double pixels_per_m = 1;
  double lean_rad = 0;  ///< of the vertical, clockwise from the image's up direction
  TemplatePaint paint = TemplatePaint::kPlain;
  double response = 0;
  double neg_log10_nfa = 0;  ///< decades, of one frame and model; by contours with kDecadesOfOtherFrames
  double in_frame = 1;       ///< fraction of its contours, if it is examined
  bool is_examined = false;  ///< its significance is that of all evidence (shape_evidence.h), not of its response alone
};

class FramePyramid;
class ModelShapeSearch;
struct Place;

/// A match by contours as one by shape.
[[nodiscard]] ShapeMatch ShapeMatchOf(const ContourMatch& match, std::size_t model_index, const cv::Size& frame);

/// The sum of the -log10 NFA of the frames of a video in which a model must be found by its contours before it is
/// searched for so in all.
inline constexpr double kDecadesToSearchByContours = 6;
/// In how many frames it must be found.
inline constexpr std::size_t kFramesToSearchByContours = 2;
/// What this adds to the -log10 NFA of each match by contours in the video.
inline constexpr double kDecadesOfOtherFrames = 2;

/// Thread-safe but for AssumeCamera and SearchByContours. Deterministic.
class ShapeSearch {
 public:
  /// Models without stored renderings or a bounding box are not searched for.
  /// @param models     must outlive it, as must
  /// @param surfaces   one a model; null for a model without
  /// @param background cells of frames of the video, at several scales
  ShapeSearch(std::span<const ObjectModel> models, std::span<const std::shared_ptr<const RelitTemplateSource>> surfaces,
              std::span<const GradientCells> background);
  ~ShapeSearch();
  ShapeSearch(const ShapeSearch&) = delete;
  ShapeSearch& operator=(const ShapeSearch&) = delete;

  /// The matches in a frame, by falling significance; with the vertical and the height above the ground, of several
  /// models in one place, too: other frames decide. Without them, unless they are assumed, those by contours
  /// (SearchByContours).
  /// @param grey               CV_8UC1, without impulse noise
  /// @param min_neg_log10_nfa  decades
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<ShapeMatch>> Find(const cv::Mat& grey, const FrameConditions& conditions,
                                                       double min_neg_log10_nfa) const;

  /// The matches in a frame of an unknown camera: of objects that stand upright in the image, of any size and off-nadir
  /// angle. So many views are tested that what looks alike in another size is often more significant than the object.
  /// Cost: some ten times that of Find.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::vector<ShapeMatch>> FindInAnyView(const cv::Mat& grey, double min_neg_log10_nfa) const;

  /// The camera of the frames that come without the vertical or the height above the ground.
  void AssumeCamera(const FrameConditions& conditions) { assumed_ = conditions; }

  /// From now on, frames of an unknown camera are searched by contours for the models that are found so in these frames
  /// (contour_search.h).
  /// @param frames  spread over the video; if it is only one, a match in it suffices
  /// @return true if there is such a model
  /// Errors: those of RelitTemplateSource; kCancelled.
  [[nodiscard]] Expected<bool> SearchByContours(std::span<const cv::Mat> frames, const CancelToken& cancel);

  /// A detection by shape found again in another frame, near where it is expected and from about the same side.
  /// std::nullopt if it is not there. A place and a heading are tested, not all of a frame: kDecadesOfOnePlace is added
  /// to the -log10 NFA. It must reach kMinDecadesInOnePlace; kMinDecadesUnexamined where the camera is assumed. A match
  /// by contours must reach kMinContourNegLog10Nfa in the frame itself; kDecadesOfOtherFrames is added.
  /// @param last      of a model that is searched for
  /// @param shift_px  of the object since then
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::optional<ShapeMatch>> FindAgain(const cv::Mat& grey, const FrameConditions& conditions,
                                                              const Detection& last,
                                                              const Eigen::Vector2d& shift_px) const;

  /// A match as a detection. Its inliers are the keypoints of the model's nearest view where the match puts them:
  /// points to track and to estimate the pose by. They are appended to `features`, with descriptors of zeros.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<Detection> MakeDetection(const ShapeMatch& match, FeatureSet& features) const;

  class Templates;  ///< private to recognize/

 private:
  [[nodiscard]] const FrameConditions* CameraOf(const FrameConditions& conditions) const;
  [[nodiscard]] std::vector<ShapeMatch> KeepApart(std::vector<ShapeMatch> all, bool is_place_of_one) const;
  [[nodiscard]] std::vector<ShapeMatch> FindContours(const cv::Mat& grey, double min_neg_log10_nfa) const;
  [[nodiscard]] ModelShapeSearch SearchFor(std::size_t model) const;
  [[nodiscard]] Expected<std::vector<ShapeMatch>> RefineBest(const FramePyramid& frame,
                                                             const FrameConditions& conditions,
                                                             std::vector<Expected<std::vector<Place>>>& found,
                                                             std::size_t parts, double decades_assumed,
                                                             double min_neg_log10_nfa) const;
  [[nodiscard]] Expected<std::optional<ShapeMatch>> Judge(const FramePyramid& frame, const FrameConditions& conditions,
                                                          ShapeMatch match, double decades_assumed,
                                                          double min_neg_log10_nfa) const;

  std::span<const ObjectModel> models_;
  std::unique_ptr<Templates> templates_;
  std::optional<FrameConditions> assumed_;
  std::vector<std::pair<std::size_t, ContourModel>> contours_;  // by the number of the model
  double decades_of_other_frames_ = 0;                          // of a match by contours
};

/// Cells of a frame at the scales that the background of a search is taken from.
/// @param grey  CV_8UC1, without impulse noise
[[nodiscard]] std::vector<GradientCells> BackgroundCells(const cv::Mat& grey);

}  // namespace victorious
