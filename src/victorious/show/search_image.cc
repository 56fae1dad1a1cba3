#include "victorious/show/search_image.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace victorious {
namespace {

// A segment ends where the object is missing from kept frames for longer than this.
constexpr double kMaxGapS = 2.5;

// Number of strongest features of the example: keeps the search of an hour of video within seconds for any image.
constexpr int kMaxExampleFeatures = 500;

struct Hit {
  std::int64_t video;
  std::int64_t place;  // index among the kept frames
  VideoSegment moment;
};

// Makes the recogniser of the example with the feature options of the video's kept features.
Expected<Recognizer> MakeRecognizer(const Photo& example, const VideoRecord& video, const RecognizeOptions& options) {
  PhotoModelOptions model_options;
  if (auto status = SetFromJsonText(video.features_json, CollectFields(model_options.features)); !status) {
    return std::unexpected(std::move(status).error().WithContext(video.name + ": features kept in the index"));
  }
  int& max_features = model_options.features.max_features;
  max_features = max_features == 0 ? kMaxExampleFeatures : std::min(max_features, kMaxExampleFeatures);
  VICTORIOUS_ASSIGN_OR_RETURN(ObjectModel model,
                              MakePhotoModel("example", std::span(&example, 1), std::nullopt, model_options));
  return Recognizer::Create({std::move(model)}, model_options.features.engine, options);
}

Expected<std::optional<Hit>> BestHit(const Recognizer& recognizer, const KeptFrame& frame, std::int64_t place) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Detection> detections, recognizer.Recognize(frame.features));
  if (detections.empty()) return std::nullopt;
  const Detection& best = detections.front();
  return Hit{frame.video,
             place,
             {.video = {},
              .frame = frame.frame,
              .time_s = frame.time_s,
              .box = best.box,
              .score = best.score,
              .matches = static_cast<int>(best.fit.inliers.size()),
              .first_time_s = frame.time_s,
              .last_time_s = frame.time_s,
              .frames = 1}};
}

// Merges consecutive hits of one video. Hits are sorted by video and time.
std::vector<Hit> MergeHits(std::vector<Hit> hits) {
  std::vector<Hit> moments;
  for (Hit& hit : hits) {
    const bool continues =
        !moments.empty() && moments.back().video == hit.video &&
        (hit.place == moments.back().place + 1 || hit.moment.time_s - moments.back().moment.last_time_s <= kMaxGapS);
    if (!continues) {
      moments.push_back(std::move(hit));
      continue;
    }
    moments.back().place = hit.place;
    VideoSegment& moment = moments.back().moment;
    if (hit.moment.score > moment.score || (hit.moment.score == moment.score && hit.moment.matches > moment.matches)) {
      const VideoSegment before = std::exchange(moment, hit.moment);
      moment.first_time_s = before.first_time_s;
      moment.frames = before.frames;
    }
    moment.last_time_s = hit.moment.last_time_s;
    moment.frames += 1;
  }
  return moments;
}

}  // namespace

Expected<ImageSearch> SearchByImage(const Photo& example, const SightingFilter& filter, const RecognizeOptions& options,
                                    IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<VideoRecord> videos, store.Videos());
  if (filter.video_name) videos = FindVideosByName(videos, *filter.video_name);
  struct SearchedVideo {
    std::string name;
    const Recognizer* recognizer;
  };
  std::map<std::int64_t, SearchedVideo> by_id;
  std::map<std::string, Recognizer> recognizers;  // by the feature options
  for (const VideoRecord& video : videos) {
    if (video.features_json.empty()) continue;
    auto recognizer = recognizers.find(video.features_json);
    if (recognizer == recognizers.end()) {
      VICTORIOUS_ASSIGN_OR_RETURN(Recognizer made, MakeRecognizer(example, video, options));
      recognizer = recognizers.emplace(video.features_json, std::move(made)).first;
    }
    by_id.emplace(video.id, SearchedVideo{ShownName(video), &recognizer->second});
  }

  // Read in the store's order, searched in parallel, in chunks of 256 frames.
  constexpr std::size_t kChunk = 256;
  std::vector<KeptFrame> chunk;
  std::vector<Hit> hits;
  std::int64_t searched = 0;
  std::set<std::int64_t> searched_videos;
  const auto search_chunk = [&]() -> Status {
    std::vector<Expected<std::optional<Hit>>> found(chunk.size());
    oneapi::tbb::parallel_for(std::size_t{0}, chunk.size(), [&](std::size_t i) {
      found[i] = BestHit(*by_id.at(chunk[i].video).recognizer, chunk[i], searched + static_cast<std::int64_t>(i));
    });
    for (Expected<std::optional<Hit>>& hit : found) {
      if (!hit) return std::unexpected(std::move(hit).error());
      if (*hit) hits.push_back(**std::move(hit));
    }
    searched += static_cast<std::int64_t>(chunk.size());
    chunk.clear();
    return {};
  };
  Status searched_chunk;
  VICTORIOUS_RETURN_IF_ERROR(store.VisitKeptFrames(filter, [&](KeptFrame&& frame) {
    if (!by_id.contains(frame.video)) return true;  // added by another process in the meantime
    searched_videos.insert(frame.video);
    chunk.push_back(std::move(frame));
    if (chunk.size() == kChunk) searched_chunk = search_chunk();
    return searched_chunk.has_value();
  }));
  VICTORIOUS_RETURN_IF_ERROR(searched_chunk);
  VICTORIOUS_RETURN_IF_ERROR(search_chunk());
  if (searched == 0) {
    return Fail(ErrorCode::kInvalidArgument,
                "the index has no kept features to search: index a video first, without --keep-features none (with "
                "--redo one that was indexed so), or widen --video, --from, --to");
  }

  ImageSearch result{.searched_frames = searched, .searched_videos = static_cast<std::int64_t>(searched_videos.size())};
  for (Hit& hit : MergeHits(std::move(hits))) {
    hit.moment.video = by_id.at(hit.video).name;
    result.segments.push_back(std::move(hit.moment));
  }
  std::ranges::stable_sort(result.segments, [](const VideoSegment& a, const VideoSegment& b) {
    return a.score != b.score ? a.score > b.score : a.matches > b.matches;
  });
  return result;
}

}  // namespace victorious
