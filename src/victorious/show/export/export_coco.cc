#include "victorious/show/export/export_coco.h"

#include <cmath>
#include <map>
#include <ostream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file_head.h"
#include "victorious/base/json.h"
#include "victorious/types/json_values.h"

namespace victorious {
namespace {

struct CocoImage {
  std::int64_t video = 0;
  std::int64_t frame = 0;
  double time_s = 0;
};

Json ImageJson(const CocoImage& image, std::size_t id, const VideoRecord& video) {
  return {{"id", id},
          {"file_name", fmt::format("{}/{:06d}.png", ShownName(video), image.frame)},
          {"width", video.width},
          {"height", video.height},
          {"video", ShownName(video)},
          {"frame", image.frame},
          {"time_s", TimeJson(image.time_s)},
          {"video_id", image.video},
          {"frame_index", image.frame},
          {"timestamp", TimeJson(image.time_s)}};
}

Json VideoJson(const VideoRecord& video) {
  Json fps;
  if (video.frame_count && video.duration_s && *video.frame_count > 1 && *video.duration_s > 0) {
    fps = ScoreJson(static_cast<double>(*video.frame_count - 1) / *video.duration_s);
  }
  return {{"id", video.id},
          {"name", ShownName(video)},
          {"width", video.width},
          {"height", video.height},
          {"annotation_fps", fps}};
}

Json CategoriesJson(const std::vector<ModelRecord>& models) {
  Json categories = Json::array();
  for (const ModelRecord& model : models) {
    categories.push_back({{"id", model.id}, {"name", model.name}, {"supercategory", ""}});
  }
  return categories;
}

// The outline, clipped to the image, as COCO's flat list of coordinates.
Json SegmentationJson(const Polygon& polygon) {
  Json flat = Json::array();
  for (const Eigen::Vector2d& corner : polygon) {
    flat.push_back(RoundPixels(corner.x()));
    flat.push_back(RoundPixels(corner.y()));
  }
  return flat.size() < 6 ? Json::array() : Json::array({flat});
}

Json AnnotationJson(const SightingRecord& sighting, const VideoRecord& video, std::size_t id, std::size_t image_id) {
  const Box image = FrameBox(video.width, video.height);
  const Polygon visible = ClipToBox(sighting.outline, image);
  const double area = visible.size() < 3 ? sighting.box.Area() : std::abs(SignedArea(visible));
  return {{"id", id},
          {"image_id", image_id},
          {"category_id", sighting.model},
          {"bbox", BoxJson(sighting.box)},
          {"area", RoundPixels(area)},
          {"segmentation", SegmentationJson(visible)},
          {"iscrowd", 0},
          {"score", ScoreJson(sighting.score)},
          {"track_id", sighting.object}};
}

Status WriteCoco(const ExportRequest& request, std::ostream& out) {
  out << R"({"info":{"description":"sightings of victorious"},"licenses":[],"categories":)"
      << DumpJson(CategoriesJson(request.catalogue.models())) << R"(,"annotations":[)";
  std::vector<CocoImage> images;
  std::map<std::int64_t, std::string> tracks;  // names, by object
  std::size_t annotations = 0;
  VICTORIOUS_RETURN_IF_ERROR(request.store.VisitSightings(request.filter, [&](SightingRecord&& sighting) {
    const VideoRecord* video = request.catalogue.Video(sighting.video);
    const ModelRecord* model = request.catalogue.Model(sighting.model);
    if (video == nullptr || model == nullptr) return true;
    tracks[sighting.object] = fmt::format("{} {}", model->name, sighting.object);
    if (images.empty() || images.back().video != sighting.video || images.back().frame != sighting.frame) {
      images.push_back({sighting.video, sighting.frame, sighting.time_s});
    }
    out << (annotations > 0 ? ",\n" : "\n");
    ++annotations;
    out << DumpJson(AnnotationJson(sighting, *video, annotations, images.size()));
    return out.good();
  }));
  Json videos = Json::array();
  for (const VideoRecord& video : request.catalogue.videos()) videos.push_back(VideoJson(video));
  Json named = Json::array();
  for (const auto& [object, name] : tracks) named.push_back({{"id", object}, {"name", name}});
  out << fmt::format(R"(],"videos":{},"tracks":{},"images":[)", DumpJson(videos), DumpJson(named));
  for (std::size_t i = 0; i < images.size(); ++i) {
    out << (i > 0 ? ",\n" : "\n") << DumpJson(ImageJson(images[i], i + 1, *request.catalogue.Video(images[i].video)));
  }
  out << "]}\n";
  return {};
}

}  // namespace

constinit const ExportFormat kCocoFormat{
    .name = "coco",
    .file = "a COCO annotation file",
    .is_file = [](std::string_view head) { return IsJsonWith(head, {"\"categories\"", "\"annotations\""}); },
    .write = &WriteCoco};

}  // namespace victorious
