#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/one_line.h"
#include "victorious/category/finder/detection_list.h"

namespace victorious {
namespace {

using nlohmann::json;

constexpr double kMaxPixels = 1e6;
constexpr std::int64_t kMaxFrame = 1'000'000'000;

std::optional<std::int64_t> WholeNumber(const json& object, const char* key) {
  constexpr double kMaxExact = 9e15;
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (std::abs(value) > kMaxExact || value != std::floor(value)) return std::nullopt;
  return static_cast<std::int64_t>(value);
}

std::string TextOf(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// The list of a key; empty where there is none.
const json& ListOf(const json& file, const char* key) {
  static const json kNone = json::array();
  const auto found = file.find(key);
  return found != file.end() && found->is_array() ? *found : kNone;
}

std::optional<std::int64_t> FrameOfImage(const json& image) {
  for (const char* key : {"frame_index", "frame_id"}) {
    if (const auto frame = WholeNumber(image, key)) return frame;
  }
  return FrameOfFileName(TextOf(image, "file_name"));
}

std::string FileNameOf(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// Which of a file's videos is meant: its only one, or that of the same name. std::nullopt: images belong to none.
Expected<std::optional<std::int64_t>> VideoOf(const json& file, const std::string& name, const std::string& video) {
  std::set<std::int64_t> shown;
  for (const json& image : ListOf(file, "images")) {
    if (!image.is_object()) continue;
    if (const auto id = WholeNumber(image, "video_id")) shown.insert(*id);
  }
  if (shown.size() < 2) return std::nullopt;
  for (const json& one : ListOf(file, "videos")) {
    if (!one.is_object()) continue;
    const auto id = WholeNumber(one, "id");
    for (const char* key : {"name", "file_name"}) {
      if (id && shown.contains(*id) && FileNameOf(TextOf(one, key)) == FileNameOf(video)) return id;
    }
  }
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: has boxes of {} videos, none of them named {}: give a file of this video alone", name,
                          shown.size(), OneLine(FileNameOf(video))));
}

// The frames of the images, by id; std::nullopt for those of other videos.
Expected<std::map<std::int64_t, std::optional<std::int64_t>>> FramesOf(const json& file, const std::string& name,
                                                                       std::optional<std::int64_t> video) {
  std::map<std::int64_t, std::optional<std::int64_t>> frames;
  for (const json& image : ListOf(file, "images")) {
    const auto id = image.is_object() ? WholeNumber(image, "id") : std::nullopt;
    if (!id) return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: an image without a whole `id`", name));
    frames[*id] = std::nullopt;
    if (video && WholeNumber(image, "video_id") != video) continue;
    const std::optional<std::int64_t> frame = FrameOfImage(image);
    if (!frame || *frame < 0 || *frame > kMaxFrame) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: image {}: which frame it is cannot be told: give it a `frame_index`, or a file_name "
                              "that ends in the frame's number",
                              name, *id));
    }
    frames[*id] = *frame;
  }
  return frames;
}

std::optional<Box> BoxOf(const json& annotation) {
  const auto found = annotation.find("bbox");
  if (found == annotation.end() || !found->is_array() || found->size() != 4) return std::nullopt;
  const auto is_valid = [](const json& one) { return one.is_number() && std::abs(one.get<double>()) <= kMaxPixels; };
  if (!std::ranges::all_of(*found, is_valid)) return std::nullopt;
  const auto at = [&](std::size_t i) { return (*found)[i].get<double>(); };
  return Box{at(0), at(1), at(2), at(3)};
}

std::optional<std::int64_t> TrackOf(const json& annotation) {
  if (const auto track = WholeNumber(annotation, "track_id")) return track;
  const auto attributes = annotation.find("attributes");
  if (attributes == annotation.end() || !attributes->is_object()) return std::nullopt;
  return WholeNumber(*attributes, "track_id");
}

// Takes boxes into a list, with the names of their categories.
class BoxTaker {
 public:
  /// @param class_names  of categories without a name, by id
  BoxTaker(const json& categories, std::span<const std::string> class_names, DetectionList& list) : list_(list) {
    for (std::size_t id = 0; id < class_names.size(); ++id) names_[static_cast<std::int64_t>(id)] = class_names[id];
    for (const json& one : categories) {
      const auto id = one.is_object() ? WholeNumber(one, "id") : std::nullopt;
      if (id) names_[*id] = OneLine(TextOf(one, "name"));
    }
  }

  Status Take(const json& annotation, const Box& box, std::int64_t frame) {
    if (!(box.width > 0 && box.height > 0)) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t category, CategoryOf(annotation));
    const auto score = annotation.find("score");
    const bool has_score = score != annotation.end() && score->is_number();
    list_.frames[frame].push_back({.category = category,
                                   .box = box,
                                   .score = has_score ? std::clamp(score->get<double>(), 0.0, 1.0) : 1,
                                   .track = TrackOf(annotation)});
    return {};
  }

 private:
  Expected<std::size_t> CategoryOf(const json& annotation) {
    if (!annotation.contains("category_id")) return list_.AddClass("object");
    const std::optional<std::int64_t> id = WholeNumber(annotation, "category_id");
    if (!id) return Fail(ErrorCode::kInvalidArgument, "its `category_id` must be a whole number");
    std::string& name = names_[*id];
    if (name.empty()) name = fmt::format("class-{}", *id);
    return list_.AddClass(name);
  }

  std::map<std::int64_t, std::string> names_;
  DetectionList& list_;
};

}  // namespace

Expected<DetectionList> ParseCocoDetections(std::string_view text, const std::string& name, const std::string& video,
                                            std::span<const std::string> class_names) {
  const Expected<json> file = ParseStrictJson(text);
  if (!file) return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", name, file.error().message));
  const bool is_results = file->is_array();
  const json& annotations = is_results ? *file : ListOf(*file, "annotations");
  if (!is_results && !file->contains("annotations")) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: no `annotations`: give a COCO file with `images`, `annotations` and `categories`, or a "
                    "list of results",
                    name));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> of_video, VideoOf(*file, name, video));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto frames, FramesOf(*file, name, of_video));
  DetectionList list;
  BoxTaker taker(ListOf(*file, "categories"), class_names, list);
  const auto fail = [&](std::size_t number, const std::string& what) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: annotation {}: {}", name, number, what));
  };
  for (std::size_t i = 0; i < annotations.size(); ++i) {
    const json& one = annotations[i];
    const auto image = one.is_object() ? WholeNumber(one, "image_id") : std::nullopt;
    const auto box = one.is_object() ? BoxOf(one) : std::nullopt;
    if (!image || !box) return fail(i, "must have a whole `image_id` and a `bbox` of four numbers");
    std::optional<std::int64_t> frame = image;
    if (is_results && (*image < 0 || *image > kMaxFrame))
      return fail(i, fmt::format("image_id {} is no frame", *image));
    if (!is_results) {
      const auto found = frames.find(*image);
      if (found == frames.end()) return fail(i, fmt::format("there is no image {}", *image));
      frame = found->second;
    }
    if (!frame) continue;
    if (const Status taken = taker.Take(one, *box, *frame); !taken) return fail(i, taken.error().message);
  }
  return list;
}

}  // namespace victorious
