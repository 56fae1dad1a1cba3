#include "victorious/place/geolocate/view_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxViews = 24;

bool IsSameView(const PlaceView& a, const PlaceView& b, const ViewDetectionOptions& options) {
  const double ratio = a.px_per_m > b.px_per_m ? a.px_per_m / b.px_per_m : b.px_per_m / a.px_per_m;
  return ratio < options.view_size_ratio &&
         a.to_camera.dot(b.to_camera) > std::cos(RadiansFromDegrees(options.view_angle_deg));
}

}  // namespace

void ViewDetectionOptions::ListFields(FieldList& fields) {
  fields.Add("half_size_px", half_size_px,
             {.min = 1,
              .max = 1e4,
              .unit = "px",
              .reason = "diagonal of an object in a frame at which one view finds half of those that can be found"});
  fields.Add("slope", slope,
             {.min = 0.1, .max = 20, .reason = "exponent of the size in the odds that one view finds an object"});
  fields.Add("ceiling", ceiling,
             {.min = 0.01, .max = 1, .reason = "fraction of objects that many large views find: others are hidden"});
  fields.Add(
      "border_fraction", border_fraction,
      {.min = 0,
       .max = 2,
       .reason = "an object whose middle is nearer to the edge of a frame than this part of its diagonal is found "
                 "less, in proportion"});
  fields.Add("view_angle_deg", view_angle_deg,
             {.min = 0,
              .max = 180,
              .unit = "deg",
              .reason = "views of a place whose directions differ by less, and their sizes, too, are not independent"});
  fields.Add("view_size_ratio", view_size_ratio,
             {.min = 1, .max = 100, .reason = "ratio of sizes from which on views of one direction are independent"});
}

double FindProbability(const ViewDetectionOptions& options, const PlaceView& view, double diagonal_m) {
  const double size_px = diagonal_m * view.px_per_m;
  if (!(size_px > 0)) return 0;
  const double needed_px = options.border_fraction * size_px;
  const double whole = view.border_px < needed_px ? view.border_px / needed_px : 1;
  return whole / (1 + std::pow(options.half_size_px / size_px, options.slope));
}

void PlaceViews::Add(const ViewDetectionOptions& options, const PlaceView& view) {
  if (looks_ < std::numeric_limits<std::uint16_t>::max()) ++looks_;
  const auto same = std::ranges::find_if(views_, [&](const PlaceView& one) { return IsSameView(one, view, options); });
  if (same != views_.end()) {
    same->px_per_m = std::max(same->px_per_m, view.px_per_m);
    same->border_px = std::max(same->border_px, view.border_px);
    return;
  }
  views_.push_back(view);
  if (views_.size() > kMaxViews) views_.erase(std::ranges::min_element(views_, {}, &PlaceView::px_per_m));
}

const PlaceView* PlaceViews::Nearest() const {
  const auto nearest = std::ranges::max_element(views_, {}, &PlaceView::px_per_m);
  return nearest == views_.end() ? nullptr : &*nearest;
}

double FindProbability(const ViewDetectionOptions& options, std::span<const PlaceView> views, double diagonal_m) {
  double missed = 1;
  for (const PlaceView& view : views) missed *= 1 - FindProbability(options, view, diagonal_m);
  return options.ceiling * (1 - missed);
}

}  // namespace victorious
