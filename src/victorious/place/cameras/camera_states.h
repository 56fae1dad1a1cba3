// The camera states of a video, for every job: from a telemetry file, from the video itself, or, for a live source,
// from the packets that arrive with its frames.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/base/warning_sink.h"
#include "victorious/geometry/ground.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/video/frame_loop.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/place/calibrate/clock_prior.h"
#include "victorious/place/calibrate/ground_height.h"
#include "victorious/place/cameras/live_cameras.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// The field of view of the parameters, rad; std::nullopt if they leave it to telemetry.
[[nodiscard]] std::optional<double> GivenFieldOfView(const TelemetryOptions& options);

class CameraStates {
 public:
  /// Without telemetry.
  CameraStates() = default;

  /// Reads the telemetry file if one is given, else finds the video's own telemetry or a file beside it
  /// (LoadTelemetry). A live source without a file: as ForLive.
  /// @param info         of the video
  /// @param consequence  what to report if no state covers the video: "nothing will get a place"
  /// Errors: those of a given file, and of the options.
  [[nodiscard]] static Expected<CameraStates> Load(const std::string& video, const VideoInfo& info,
                                                   const std::optional<std::string>& file,
                                                   const TelemetryOptions& options, std::string_view consequence,
                                                   const WarningSink& warn);

  /// Telemetry from the packets of a live source; none if it has no data stream.
  static CameraStates ForLive(const VideoInfo& info, const TelemetryOptions& options);

  /// Sets the field of view of frames for which telemetry has none. With it, At() returns a state for every time.
  void SetFallbackFieldOfView(std::optional<double> hfov_rad) { fallback_hfov_rad_ = hfov_rad; }

  /// Adds an offset to the times of all states, s. Does nothing if there are no states.
  void ShiftClock(double offset_s);

  /// Removes all states and what is known of their clock: the telemetry belongs to another video.
  void Forget();
  [[nodiscard]] bool is_forgotten() const { return is_forgotten_; }

  /// The standard deviation of the clock's offset that the states are to have, s; 0: it is exact. At() then gives what
  /// this means for the camera, by its motion over 2 s.
  void SetClockSigma(double sigma_s) { clock_sigma_s_ = sigma_s; }
  /// What is known of the clock as long as the motion of the image is not compared with it.
  [[nodiscard]] const ClockPrior& clock_prior() const { return clock_prior_; }

  /// Multiplies the focal length of all states of the whole video by exp(log_factor), and sets the standard deviation
  /// of its logarithm, which At() gives with each state. No effect on states without a field of view.
  void CorrectFocalLength(double log_factor, double sigma);

  /// Subtracts an error from the yaw of all states of the whole video.
  void CorrectYaw(double error_rad);

  /// Sets the height of the ground that was estimated from the motion of the image; std::nullopt: none is known.
  void SetGroundHeight(const std::optional<GroundHeight>& ground) { ground_height_ = ground; }
  [[nodiscard]] const std::optional<GroundHeight>& ground_height() const { return ground_height_; }

  /// Height of a camera above the ground that the middle of its image shows, m, or above that below it if its line of
  /// sight meets none. std::nullopt without an attitude, and where the ground is not known, or not in the datum of the
  /// camera, or not below it.
  /// @param camera  of At()
  /// @param given   ground that the user gave, which counts alone; null: the estimate
  [[nodiscard]] std::optional<double> HeightAboveGround(const std::optional<CameraState>& camera,
                                                        const Ground* given) const;

  /// Sets attitudes of a camera without telemetry (place/calibrate/assumed_attitude.h), for ForSearch() only; empty:
  /// none.
  void SetAssumedAttitudes(std::vector<CameraState> states);
  [[nodiscard]] bool has_assumed_attitudes() const { return assumed_.has_value(); }

  /// The state for the search conditions of a frame: At(), or the assumed attitude where that has none.
  [[nodiscard]] std::optional<CameraState> ForSearch(double time_s) const;

  /// The state at a time of the video; std::nullopt if there is none and no fallback field of view.
  [[nodiscard]] std::optional<CameraState> At(double time_s) const;

  /// States of the whole video; null without telemetry, and for a live source without a file.
  [[nodiscard]] const CameraTrajectory* trajectory() const { return trajectory_ ? &*trajectory_ : nullptr; }
  /// True if there is a state at any time.
  [[nodiscard]] bool HasStates() const { return trajectory_ && !trajectory_->states().empty(); }
  /// True if the states are those of photos: each holds at its own time only, and there is no motion between them.
  [[nodiscard]] bool is_of_photos() const { return is_of_photos_; }
  /// The first field of view that telemetry gives, rad.
  [[nodiscard]] std::optional<double> first_hfov_rad() const { return first_hfov_rad_; }
  /// UTC time of the video's first frame, from the first state with a clock. None for photos: the times between them
  /// are not those of their frames.
  [[nodiscard]] std::optional<std::int64_t> start_utc_us() const { return start_utc_us_; }

  /// To be given to the FrameLoop of a live source; null if no telemetry arrives with its frames.
  [[nodiscard]] PacketReceiver* packet_receiver() { return live_ ? &*live_ : nullptr; }
  /// Returns what At() needs for times from `from_s` to `to_s`: there it gives the same, to the last bit.
  [[nodiscard]] CameraStates Between(double from_s, double to_s) const;

  /// Writes all but what belongs to a live source.
  void Pack(ByteWriter& writer) const;
  /// What Pack wrote. `reader` remembers faults.
  static CameraStates Unpack(ByteReader& reader);

  /// Warnings about the telemetry of a live source, one line each.
  [[nodiscard]] std::vector<std::string> LiveWarnings() const;

 private:
  [[nodiscard]] std::optional<ClockError> ClockErrorAt(const CameraState& now) const;

  std::optional<CameraTrajectory> trajectory_;
  std::optional<CameraTrajectory> assumed_;
  std::optional<LiveCameraTrack> live_;
  bool is_of_photos_ = false;
  bool is_forgotten_ = false;
  double max_gap_s_ = 0;  // of trajectory_
  ClockPrior clock_prior_;
  double clock_sigma_s_ = 0;
  double focal_sigma_ = 0;
  std::optional<GroundHeight> ground_height_;
  std::optional<double> fallback_hfov_rad_;
  std::optional<double> first_hfov_rad_;
  std::optional<std::int64_t> start_utc_us_;
};

}  // namespace victorious
