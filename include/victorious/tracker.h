// Boxes that a person or another program drew, followed from frame to frame without a model.
//
//   Tracker tracker;
//   tracker.Step(first_image);
//   tracker.Start({x, y, width, height});
//   for (each next image) for (const TrackStep& one : tracker.Step(image)) Use(one);
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <victorious/export.h>
#include <victorious/image.h>

namespace libvictorious {

enum class TrackLoss { kNone, kLostPoints, kLeftFrame, kOccluded, kUnconfirmed };

struct TrackStep {
  std::size_t target = 0;             ///< in the order of Start, from 0
  TrackLoss loss = TrackLoss::kNone;  ///< kNone if and only if the object is seen
  Box box;                            ///< px, clipped to the frame; empty if not seen
  double confidence = 0;              ///< 0 to 1; 1: as usual for this object
  bool tentative = false;             ///< found again by its appearance, and not confirmed since

  [[nodiscard]] bool seen() const noexcept { return loss == TrackLoss::kNone; }
};

struct TrackerSettings {
  std::string params;  ///< JSON object of parameters (group `box` of `victorious params track`); empty: the defaults
};

/// Follows any number of boxes, also after an occlusion. The same frames give the same boxes. Used by one thread at a
/// time; can be moved, not copied.
class LIBVICTORIOUS_EXPORT Tracker {
 public:
  /// Error: kInvalidArgument for parameters that are none, or out of range.
  explicit Tracker(const TrackerSettings& settings = {});
  Tracker(Tracker&& other) noexcept;
  Tracker& operator=(Tracker&& other) noexcept;
  ~Tracker();

  /// Makes an image the current frame, and follows every target into it. Frames come in order of time, or all in
  /// reverse order, and have one size and format. Returns one result a target. Cost on one core: 3 ms and 10 ms a
  /// target at 640 x 480, twice that while it is lost.
  /// Error: kInvalidArgument for a view that describes no image, or one of another size or number of channels.
  std::vector<TrackStep> Step(const ImageView& image);

  /// Starts a target in the current frame. Errors: kInvalidArgument for a side below 4 px, less than half of it inside
  /// the frame, or no frame before.
  TrackStep Start(const Box& box);

  /// The next frame is of another video: all targets are lost, and are searched for there by their appearance.
  void ChangeVideo();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace libvictorious
