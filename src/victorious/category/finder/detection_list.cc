#include "victorious/category/finder/detection_list.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/folder.h"
#include "victorious/base/one_line.h"
#include "victorious/base/text.h"
#include "victorious/category/network/output_layout.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxFileBytes = 512'000'000;
constexpr std::size_t kMaxJsonBytes = 128'000'000;  // takes some ten times as much memory while it is read
constexpr double kMaxNumber = 1e9;
constexpr std::int64_t kFirstMotFrame = 1;
constexpr std::int64_t kFirstYoloFrame = 1;

std::unexpected<Error> FailAt(const std::string& name, std::size_t line, const std::string& what) {
  return Fail(ErrorCode::kInvalidArgument, fmt::format("{}, line {}: {}", name, line, what));
}

std::string ClassName(std::int64_t number, std::span<const std::string> names) {
  const bool has_name = number >= 0 && number < std::ssize(names);
  return has_name ? names[static_cast<std::size_t>(number)] : fmt::format("class-{}", number);
}

// The numbers of a line; std::nullopt if one is none, or out of any range.
std::optional<std::vector<double>> Numbers(std::string_view line, char separator) {
  std::vector<double> numbers;
  for (const std::string& cell : SplitRow(line, separator)) {
    if (separator == ' ' && cell.empty()) continue;
    const std::optional<double> number = ParseNumber(cell);
    if (!number || std::abs(*number) > kMaxNumber) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

bool IsWhole(double number) { return number == std::floor(number); }

// Counts frames from 0. Error: kInvalidArgument for one before the first.
Status SetFirstFrame(std::int64_t first, const std::string& name, DetectionList& list) {
  if (list.frames.empty()) return {};
  const std::int64_t lowest = list.frames.begin()->first;
  if (lowest < first) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: has boxes of frame {}, but the first frame is {}: give --first-frame {}", name, lowest,
                            first, lowest));
  }
  std::map<std::int64_t, std::vector<ListedBox>> frames;
  for (auto& [frame, boxes] : list.frames) frames[frame - first] = std::move(boxes);
  list.frames = std::move(frames);
  return {};
}

std::string FirstLineOf(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = TrimBlanks(TakeLine(text));
    if (!line.empty()) return std::string(line);
  }
  return {};
}

// A file of labels: NAME_FRAME.txt.
struct LabelFile {
  std::filesystem::path path;
  std::int64_t frame = 0;
};

// The files of labels in a folder, by the name before the frame's number.
Expected<std::map<std::string, std::vector<LabelFile>>> ListLabels(const std::filesystem::path& folder) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> paths, ListFolder(folder));
  std::map<std::string, std::vector<LabelFile>> files;
  for (const std::filesystem::path& path : paths) {
    const std::optional<std::int64_t> frame = FrameOfFileName(path.string());
    if (path.extension() != ".txt" || !frame) continue;
    std::string name = path.stem().string();
    name.erase(name.find_last_not_of("0123456789") + 1);
    files[name].push_back({path, *frame});
  }
  return files;
}

// Those of a video: of several names, the one that is its own.
Expected<std::vector<LabelFile>> LabelsOf(const DetectionFile& file) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto files, ListLabels(file.path));
  const std::string folder = OneLine(file.path.string());
  if (files.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no labels in it: give a folder of NAME_FRAME.txt", folder));
  }
  if (files.size() == 1) return files.begin()->second;
  const std::string stem = std::filesystem::path(file.video).stem().string();
  for (const std::string& name : {stem + "_", stem + "-", stem}) {
    if (const auto own = files.find(name); own != files.end()) return own->second;
  }
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: labels of {} names, none of them {}_FRAME.txt: give a folder of this video's labels alone",
                  folder, files.size(), OneLine(stem)));
}

Expected<DetectionList> ReadYoloFolder(const DetectionFile& file) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<LabelFile> labels, LabelsOf(file));
  DetectionList list{.is_relative = true};
  for (const LabelFile& one : labels) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(one.path, kMaxFileBytes));
    VICTORIOUS_RETURN_IF_ERROR(ParseYoloLabels(text, OneLine(one.path.string()), one.frame, file.class_names, list));
  }
  const bool has_frame_0 = std::ranges::find(labels, 0, &LabelFile::frame) != labels.end();
  const std::int64_t first = file.first_frame.value_or(has_frame_0 ? 0 : kFirstYoloFrame);
  VICTORIOUS_RETURN_IF_ERROR(SetFirstFrame(first, OneLine(file.path.string()), list));
  return list;
}

Expected<DetectionList> ReadOneFile(const DetectionFile& file) {
  const std::string name = OneLine(file.path.string());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(file.path, kMaxFileBytes));
  const std::string_view text = StripByteOrderMark(bytes);
  const std::string first_line = FirstLineOf(text);
  const bool is_json = first_line.starts_with('{') || first_line.starts_with('[');
  if (is_json && bytes.size() > kMaxJsonBytes) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: has more than {} MB: give the boxes of this video alone, or a MOTChallenge text", name,
                            kMaxJsonBytes / 1'000'000));
  }
  if (is_json) {
    VICTORIOUS_ASSIGN_OR_RETURN(DetectionList list, ParseCocoDetections(text, name, file.video, file.class_names));
    VICTORIOUS_RETURN_IF_ERROR(SetFirstFrame(file.first_frame.value_or(0), name, list));
    return list;
  }
  if (!first_line.empty() && !first_line.contains(',')) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: no detections: give a COCO file, a MOTChallenge text, or a folder of YOLO's labels", name));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(DetectionList list, ParseMotDetections(text, name, file.class_names));
  VICTORIOUS_RETURN_IF_ERROR(SetFirstFrame(file.first_frame.value_or(kFirstMotFrame), name, list));
  return list;
}

}  // namespace

Expected<std::size_t> DetectionList::AddClass(const std::string& name) {
  const auto [entry, is_new] = class_numbers.try_emplace(name, classes.size());
  if (!is_new) return entry->second;
  if (classes.size() == kMaxDetectorClasses) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("more than {} classes", kMaxDetectorClasses));
  }
  classes.push_back(name);
  return entry->second;
}

std::optional<std::int64_t> FrameOfFileName(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto end_of_text = std::find_if_not(stem.rbegin(), stem.rend(), is_digit).base();
  return ParseInteger(std::string_view(end_of_text, stem.end()));
}

std::size_t DetectionList::CountBoxes() const {
  return std::transform_reduce(frames.begin(), frames.end(), std::size_t{0}, std::plus{},
                               [](const auto& one) { return one.second.size(); });
}

Expected<DetectionList> ParseMotDetections(std::string_view text, const std::string& name,
                                           std::span<const std::string> class_names) {
  constexpr std::size_t kMinColumns = 6;
  constexpr std::size_t kConfidence = 6;
  constexpr std::size_t kClass = 7;
  constexpr std::size_t kColumnsWithClass = 9;
  DetectionList list;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = TrimBlanks(TakeLine(text));
    if (line.empty()) continue;
    const std::optional<std::vector<double>> row = Numbers(line, ',');
    if (!row || row->size() < kMinColumns) {
      return FailAt(name, number, "must be numbers: frame, track, left, top, width, height, confidence, ...");
    }
    const std::vector<double>& of = *row;
    if (!IsWhole(of[0]) || of[0] < 0) return FailAt(name, number, "the frame must be a whole number, at least 0");
    const bool has_class = of.size() == kColumnsWithClass;
    if (has_class && (!IsWhole(of[kClass]) || of[kClass] < 0)) {
      return FailAt(name, number, "the class, the eighth of nine columns, must be a whole number, at least 0");
    }
    const double confidence = of.size() > kConfidence ? of[kConfidence] : 1;
    if (has_class && confidence == 0) continue;  // of the ground truth: to be ignored
    if (!(of[4] > 0 && of[5] > 0)) continue;
    const std::string only_class = class_names.empty() ? "object" : class_names.front();
    const Expected<std::size_t> of_class =
        list.AddClass(has_class ? ClassName(static_cast<std::int64_t>(of[kClass]), class_names) : only_class);
    if (!of_class) return FailAt(name, number, of_class.error().message);
    ListedBox box{.category = *of_class,
                  .box = {of[2], of[3], of[4], of[5]},
                  .score = confidence == -1 ? 1 : std::clamp(confidence, 0.0, 1.0)};
    if (of[1] >= 0) box.track = static_cast<std::int64_t>(of[1]);
    list.frames[static_cast<std::int64_t>(of[0])].push_back(box);
  }
  return list;
}

Status ParseYoloLabels(std::string_view text, const std::string& name, std::int64_t frame,
                       std::span<const std::string> class_names, DetectionList& list) {
  constexpr std::size_t kBoxColumns = 5;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = TrimBlanks(TakeLine(text));
    if (line.empty()) continue;
    const std::optional<std::vector<double>> row = Numbers(line, ' ');
    if (!row || row->size() < kBoxColumns || row->size() > kBoxColumns + 2) {
      return FailAt(name, number, "must be: class x y width height [confidence] [track]; outlines are not read");
    }
    const std::vector<double>& of = *row;
    if (!IsWhole(of[0]) || of[0] < 0) return FailAt(name, number, "the class must be its number");
    const bool is_in_frame =
        std::ranges::all_of(std::span(of).subspan(1, 4), [](double v) { return v >= 0 && v <= 1; });
    if (!is_in_frame) return FailAt(name, number, "x, y, width and height must be parts of the frame, 0 to 1");
    if (!(of[3] > 0 && of[4] > 0)) continue;
    const Expected<std::size_t> of_class = list.AddClass(ClassName(static_cast<std::int64_t>(of[0]), class_names));
    if (!of_class) return FailAt(name, number, of_class.error().message);
    ListedBox box{.category = *of_class, .box = {of[1] - of[3] / 2, of[2] - of[4] / 2, of[3], of[4]}};
    // A lone sixth number is the confidence, unless it is a whole one above 1.
    const bool is_track = row->size() == kBoxColumns + 1 && IsWhole(of[5]) && of[5] > 1;
    if (row->size() > kBoxColumns && !is_track) box.score = std::clamp(of[5], 0.0, 1.0);
    if (is_track) box.track = static_cast<std::int64_t>(of[5]);
    if (row->size() == kBoxColumns + 2 && of[6] >= 0) box.track = static_cast<std::int64_t>(of[6]);
    list.frames[frame].push_back(box);
  }
  return {};
}

Expected<DetectionList> ReadDetectionList(const DetectionFile& file) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(file.path, ignored);
  VICTORIOUS_ASSIGN_OR_RETURN(DetectionList list, is_folder ? ReadYoloFolder(file) : ReadOneFile(file));
  const std::filesystem::path whole = std::filesystem::absolute(file.path, ignored).lexically_normal();
  const std::filesystem::path named = whole.has_filename() ? whole : whole.parent_path();
  const std::filesystem::path stem = is_folder ? named.filename() : named.stem();
  list.detector = file.detector.empty() ? OneLine(stem.string()) : file.detector;
  return list;
}

}  // namespace victorious
