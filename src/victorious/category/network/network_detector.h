// Finds objects in images by a detection network: in the whole image, and in tiles of it, in which small objects have
// the size that they have in the image. The network runs in processes without rights (network_runner.h), one for each
// thread that asks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/category/network/detector_file.h"
#include "victorious/category/network/network_tensor.h"

namespace victorious {

/// How an imported detector searches a video. Parameters of `index`.
struct DetectorOptions {
  bool tiles = true;
  int tile_px = 0;  ///< 0: the size of the network's input
  double tile_overlap = 0.2;
  double min_score = 0;  ///< 0: that of the import
  double interval_s = 0.5;

  void ListFields(FieldList& fields);
};

/// What a network is asked to become a detector. What is not given follows from its layout, or its file.
struct DetectorImport {
  std::optional<DetectorLayout> layout;
  std::optional<cv::Size> input;
  std::optional<ImageFit> fit;
  std::optional<ChannelOrder> channels;
  std::optional<ImageResampling> resampling;
  std::optional<int> border;
  std::optional<std::array<double, 3>> mean;
  std::optional<std::array<double, 3>> deviation;
  std::optional<double> min_score;
  std::optional<double> max_overlap;
};

/// Loads the network in an isolated process, runs it once, and recognises its layout.
/// @param model  with its files, classes and texts; the settings are set
/// Errors: those of the process and of RecogniseLayout; kInvalidArgument for settings out of range, and without a size
/// if the network's file has none.
[[nodiscard]] Expected<DetectorModel> ImportDetector(DetectorModel model, const DetectorImport& import);

/// Thread-safe.
class NetworkDetector {
 public:
  /// Starts a process and loads the network. The thread that calls this outlives the detector.
  /// Errors: those of the process; kInvalidArgument for options out of range.
  [[nodiscard]] static Expected<NetworkDetector> Create(DetectorModel model, const DetectorOptions& options);

  NetworkDetector(NetworkDetector&&) noexcept;
  NetworkDetector& operator=(NetworkDetector&&) noexcept;
  ~NetworkDetector();

  [[nodiscard]] const DetectorModel& model() const;

  /// @param bgr  CV_8UC3
  /// @return by falling score; boxes in px, inside the image
  /// Cost: one run of the network a tile, on all cores, and one for the whole image. Errors: those of the process.
  [[nodiscard]] Expected<std::vector<NetworkBox>> Detect(const cv::Mat& bgr) const;

  /// How many times the network runs for an image of this size.
  [[nodiscard]] std::size_t RunsOf(cv::Size image) const;

 private:
  struct Processes;

  NetworkDetector(DetectorModel model, const DetectorOptions& options);
  [[nodiscard]] std::vector<cv::Rect> PartsOf(cv::Size image) const;

  std::unique_ptr<Processes> processes_;
  DetectorOptions options_;
};

}  // namespace victorious
