// Private to recognize/, for ShapeSearch: the search for one model. What it looks like in a place of the frame follows
// from the camera's attitude and height above the ground, or is assumed.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/search/recognize/shape_evidence.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/search/recognize/shape_templates.h"
#include "victorious/search/recognize/upright_part.h"
#include "victorious/search/shape/gradient_cells.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

inline constexpr int kFineHeadingStep_deg = 5;  ///< between fine templates
inline constexpr int kFineHeadings = 2;         ///< on either side of one that is known to some degrees

/// How an upright object looks in one place of the frame.
struct LocalView {
  double off_nadir_rad = 0;
  double lean_rad = 0;
  double pixels_per_m = 1;                  ///< of an object whose centre is `centre_height_m` above the ground
  std::optional<int> sun_azimuth_deg = {};  ///< relative to the line of sight
  int sun_elevation_deg = 0;
};

/// The size of a model's templates in a place, and the scale at which the frame is compared with them.
struct TemplateSize {
  int eighth_octaves = 0;
  double scale = 1;  ///< pixels of the template per pixel of the frame

  bool operator==(const TemplateSize&) const = default;
};

/// A part of the frame in which objects look alike but for their heading.
struct FrameTile {
  cv::Rect part;
  [[nodiscard]] Eigen::Vector2d centre() const { return {part.x + 0.5 * part.width, part.y + 0.5 * part.height}; }
};

[[nodiscard]] std::vector<FrameTile> DivideFrame(const Vertical& vertical, const cv::Size& size);

/// A place that is searched again with fine templates.
struct Place {
  std::size_t model = 0;
  double response = 0;
  Eigen::Vector2d at_px;             ///< of the object's centre, in the frame
  double size_px = 0;                ///< of the object in the frame
  int azimuth_deg = 0;               ///< of the camera, in the model frame
  std::optional<LocalView> assumed;  ///< std::nullopt: it follows from the camera
};

/// A part of the frame at the scale of coarse templates, and its cells.
struct PreparedPart {
  UprightPart part;
  UprightPart half;
  GradientCells half_cells;
  GradientCells cells = {};  ///< as long as they are not needed, none
};

/// The cells of a part, and beyond the frame those of mean background: there the frame's last pixels are repeated, and
/// lines that leave it go on as long straight edges that nobody filmed. Cells just inside the border still average some
/// of these pixels.
[[nodiscard]] GradientCells FilmedCells(const UprightPart& part, const cv::Size& frame,
                                        const std::array<float, kCellOrientations>& mean);

/// Without its cells at full scale. Empty beside the frame.
/// @param object_px  size of the objects searched for, in the frame
/// @param mean       cell of the background, which stands beyond the frame
[[nodiscard]] PreparedPart PreparePart(const FramePyramid& frame, const FrameTile& tile, double object_px,
                                       double lean_rad, const std::array<float, kCellOrientations>& mean);

/// What is assumed where the camera is unknown: objects stand upright in the image, are seen from one of these
/// off-nadir angles, and their bounding boxes have diagonals a quarter of an octave apart, from this one on. Without
/// their size and the sun, smaller ones look too much alike: of 43 to 52 px, six vehicles of `dev_far` are found, and
/// five that are others (docs/adr/0038).
inline constexpr double kSmallestAssumed_px = 64;
inline constexpr std::array kAssumedOffNadirs_deg = {10.0, 30.0, 50.0, 70.0};
[[nodiscard]] std::vector<double> AssumedSizes(const cv::Size& size);

class ModelShapeSearch {
 public:
  /// @param templates  must outlive it
  ModelShapeSearch(std::size_t number, const ObjectModel& model, const ShapeSearch::Templates& templates)
      : model_(number),
        diagonal_m_(templates.diagonal_m(number)),
        centre_height_m_(model.box_m->sizes().z() / 2),
        templates_(templates) {}

  /// The best places of coarse templates in a tile, by the camera. Empty if the model cannot be seen there.
  /// Errors: those of RelitTemplateSource; so of the others.
  [[nodiscard]] Expected<std::vector<Place>> FindPlaces(const FramePyramid& frame, const FrameConditions& conditions,
                                                        const FrameTile& tile) const;

  /// The best places of objects of one size, seen at one off-nadir angle.
  /// @param prepared   of the tile, for `object_px` and the view's lean
  [[nodiscard]] Expected<std::vector<Place>> FindAssumedPlaces(const PreparedPart& prepared, const FrameTile& tile,
                                                               const LocalView& view) const;

  /// The best match of fine templates around a place. Of an assumed view, size, off-nadir angle and lean are varied.
  [[nodiscard]] Expected<std::optional<ShapeMatch>> Refine(const FramePyramid& frame, const FrameConditions& conditions,
                                                           const Place& place) const;

  /// The best match of fine templates, of headings 5 degrees apart.
  /// @param headings  on either side of that of the place
  [[nodiscard]] Expected<std::optional<ShapeMatch>> Match(const FramePyramid& frame, const FrameConditions& conditions,
                                                          const Place& place, int headings) const;

  /// A match of fine templates with what speaks for it, by the camera, and the place and heading of the refined pose.
  /// One that is not expected to reach `min_neg_log10_nfa` (docs/adr/0047) is not compared with larger templates: it is
  /// then below that, too.
  /// std::nullopt where the model has no contours, or the object is too small for them.
  /// Errors: those of RelitTemplateSource.
  [[nodiscard]] Expected<std::optional<ShapeMatch>> Examine(const FramePyramid& frame,
                                                            const FrameConditions& conditions, const ShapeMatch& match,
                                                            double min_neg_log10_nfa) const;

 private:
  struct FittedContours {
    ShapeEvidence evidence;         // without the response
    double in_frame = 1;            // fraction of the contours
    Eigen::Vector2d centre_px;      // of the object's bounding box, in the frame
    double azimuth_change_rad = 0;  // of the direction to the camera, from what was searched
  };

  // A place that may be worth a closer look.
  struct Glance {
    double response = 0;
    Eigen::Vector2d at_px;           // in the frame
    std::size_t heading_number = 0;  // of the best template
  };

  [[nodiscard]] Expected<std::optional<ShapeMatch>> MatchView(const FramePyramid& frame, const LocalView& view,
                                                              const Place& place, const TemplateSize& size,
                                                              int headings) const;
  [[nodiscard]] Expected<double> MeanResponse(const FramePyramid& frame, const LocalView& view,
                                              const ShapeMatch& match) const;
  [[nodiscard]] Expected<std::optional<FittedContours>> FitContours(const FramePyramid& frame, const LocalView& view,
                                                                    double focal_px, const ShapeMatch& match) const;
  [[nodiscard]] std::vector<ShapeBankKey> PlaceKeys(const LocalView& view) const;
  [[nodiscard]] std::vector<Glance> FindGlances(const PreparedPart& prepared, const FrameTile& tile,
                                                const ShapeBank& bank, std::size_t most) const;
  [[nodiscard]] Expected<std::vector<Place>> LookCloser(const PreparedPart& prepared,
                                                        const std::vector<Glance>& glances,
                                                        const ShapeBankKey& key) const;
  [[nodiscard]] Expected<ShapeBank> FineBank(const LocalView& view, int eighth_octaves, int azimuth_deg,
                                             int headings) const;

  std::size_t model_;
  double diagonal_m_;
  double centre_height_m_;
  const ShapeSearch::Templates& templates_;
};

}  // namespace victorious
