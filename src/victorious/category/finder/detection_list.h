// What another program found in a video, read from its file, one frame's boxes after the other:
//   COCO           `images` with their frames, `annotations`, `categories`; or a list of results, whose image_id is the
//                  frame's number
//   MOTChallenge   lines "frame, track, left, top, width, height, confidence, ..."; a ninth column makes the eighth a
//                  class
//   YOLO           a folder of NAME_FRAME.txt, with lines "class x y width height [confidence] [track]" in parts of the
//                  frame
// docs/formats/detections.md has each in full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"

namespace victorious {

struct ListedBox {
  std::size_t category = 0;  ///< index into DetectionList::classes
  Box box;                   ///< px; of a list with `is_relative`, parts of the frame's width and height
  double score = 1;          ///< 0 to 1
  std::optional<std::int64_t> track;
};

struct DetectionList {
  std::string detector;              ///< what found them, a name
  std::vector<std::string> classes;  ///< unique, each of a box
  std::map<std::int64_t, std::vector<ListedBox>> frames;
  bool is_relative = false;
  std::map<std::string, std::size_t> class_numbers = {};  ///< of `classes`

  [[nodiscard]] std::size_t CountBoxes() const;
  /// The index of a class in `classes`; it is added where it is new.
  /// Error: kInvalidArgument for more than kMaxDetectorClasses.
  [[nodiscard]] Expected<std::size_t> AddClass(const std::string& name);
};

/// The whole number at the end of a file's name, before its ending: 12 of "frame_000012.png". std::nullopt without one.
[[nodiscard]] std::optional<std::int64_t> FrameOfFileName(const std::string& name);

struct DetectionFile {
  std::filesystem::path path;               ///< a file, or a folder of YOLO's labels
  std::string detector;                     ///< empty: the name of the file without its ending
  std::vector<std::string> class_names;     ///< by number, where the file has no names
  std::optional<std::int64_t> first_frame;  ///< number of the video's first frame in the file; std::nullopt: that of
                                            ///< its format
  std::string video;                        ///< whose boxes are read where a file has those of several
};

/// Reads the boxes of one video; none is a result, too. A frame's number is at least 0; scores that are no probability
/// become 0 or 1; boxes without area are left out.
/// Errors: kInvalidArgument that names the file and the line or the annotation; those of ReadFile and ListFolder.
[[nodiscard]] Expected<DetectionList> ReadDetectionList(const DetectionFile& file);

/// The formats, for any bytes; `name` is used in errors. Frames are as the file has them.
[[nodiscard]] Expected<DetectionList> ParseCocoDetections(std::string_view text, const std::string& name,
                                                          const std::string& video,
                                                          std::span<const std::string> class_names);
[[nodiscard]] Expected<DetectionList> ParseMotDetections(std::string_view text, const std::string& name,
                                                         std::span<const std::string> class_names);
/// @param list  receives the boxes of one file, of the frame `frame`
[[nodiscard]] Status ParseYoloLabels(std::string_view text, const std::string& name, std::int64_t frame,
                                     std::span<const std::string> class_names, DetectionList& list);

}  // namespace victorious
