#include "victorious/apps/cli/detection_arguments.h"

#include <vector>

#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/category/network/detector_file.h"

namespace victorious::cli {

void AddDetections(ArgumentParser& parser, DetectionArguments& arguments) {
  parser
      .Add("--detections", arguments.file,
           "What another program found in VIDEO, to be entered as categories DETECTOR/CLASS: placed, joined to objects "
           "and shown as what a search finds. A COCO file, a MOTChallenge text, or a folder of YOLO's labels "
           "(docs/formats/detections.md). Earlier detections of the same detector in this video are replaced")
      .TypeName("FILE");
  parser.Add("--detector", arguments.detector, "The name of what found them (default: the name of the file)")
      .TypeName("NAME");
  parser
      .Add("--classes", arguments.classes,
           "Text file with the names of their classes, one a line, where they have none (MOTChallenge, YOLO)")
      .TypeName("FILE");
  parser
      .Add("--first-frame", arguments.first_frame,
           "The number of the video's first frame in them (default: COCO 0, MOTChallenge 1, YOLO 1, or 0 if there is a "
           "file of frame 0)")
      .Range(0.0, 1e9)
      .TypeName("N");
}

Status CheckDetections(const DetectionArguments& arguments) {
  const bool has_settings = !arguments.detector.empty() || !arguments.classes.empty() || arguments.first_frame;
  if (!arguments.file.empty() || !has_settings) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "--detector, --classes and --first-frame say how --detections is read: give that, too");
}

Expected<DetectionList> ReadDetections(const DetectionArguments& arguments, const std::string& video) {
  DetectionFile file{.path = arguments.file,
                     .detector = arguments.detector,
                     .class_names = {},
                     .first_frame = arguments.first_frame,
                     .video = video};
  if (!arguments.classes.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(file.class_names, ReadClassList(arguments.classes));
  }
  return ReadDetectionList(file);
}

Status WarnOfLaterDetections(const std::string& video, std::int64_t last, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> named, store.VideosNamed(video));
  if (named.empty() || !named.back().frame_count || last < *named.back().frame_count) return {};
  LogWarning(
      "{}: has {} frames, but the last detections are of frame {}, counted from 0: those after its end are left "
      "out",
      OneLine(video), *named.back().frame_count, last);
  return {};
}

}  // namespace victorious::cli
