#include "victorious/apps/serve/object_package.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "victorious/base/temporary_folder.h"
#include "victorious/base/without_folders.h"
#include "victorious/show/export/export_gpkg.h"
#include "victorious/show/export/listed_object.h"

namespace victorious {
namespace {

// The names of an index.
struct NamesById {
  std::map<std::int64_t, VideoRecord> videos;
  std::map<std::int64_t, ModelRecord> models;
};

Expected<NamesById> ReadNames(TriageStore& store, VideoNames names) {
  NamesById by_id;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  for (VideoRecord video : videos) {
    if (names == VideoNames::kWithoutFolders) video.name = WithoutFolders(ShownName(video));
    by_id.videos[video.id] = std::move(video);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  for (const ModelRecord& model : models) by_id.models[model.id] = model;
  return by_id;
}

// Tracklets are by video and time.
std::vector<ObjectMoment> MomentsOf(const TriageObject& object, const NamesById& names) {
  std::vector<ObjectMoment> moments;
  for (const TrackletRecord& one : object.moments) {
    if (!moments.empty() && moments.back().video == one.video) {
      moments.back().last_time_s = std::max(moments.back().last_time_s, one.last_time_s);
      moments.back().frames += one.frames;
      continue;
    }
    const auto video = names.videos.find(one.video);
    if (video == names.videos.end()) continue;
    moments.push_back({.video = one.video,
                       .video_name = ShownName(video->second),
                       .first_time_s = one.first_time_s,
                       .last_time_s = one.last_time_s,
                       .frames = one.frames,
                       .start_utc_us = video->second.start_utc_us});
  }
  return moments;
}

ListedObject ListedOf(const TriageObject& object, std::size_t rank, const NamesById& names) {
  ListedObject listed{.object = object.object, .rank = rank, .moments = MomentsOf(object, names)};
  const auto model = names.models.find(object.object.model);
  if (model != names.models.end()) {
    listed.model = model->second.name;
    listed.is_category = model->second.IsCategory();
  }
  for (const ObjectMoment& one : listed.moments) listed.videos.push_back(one.video_name);
  return listed;
}

Status WriteAll(TriageStore& store, const ObjectQuery& query, VideoNames shown, const CancelToken& cancel,
                GeoPackageFile& file) {
  constexpr std::int64_t kPortion = 500;  // objects in memory
  VICTORIOUS_ASSIGN_OR_RETURN(const NamesById names, ReadNames(store, shown));
  ObjectSlice slice{.limit = kPortion};
  std::size_t rank = 0;
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TriageObject> objects, store.Objects(query, slice));
    for (const TriageObject& one : objects) {
      if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "nobody waits for the file any more");
      const DecidedObject decided{.review = one.review, .decisions = one.decisions, .is_disputed = one.is_disputed};
      VICTORIOUS_RETURN_IF_ERROR(file.Add(ListedOf(one, ++rank, names), decided));
    }
    if (std::ssize(objects) < kPortion) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(slice.after, store.FindKey(objects.back().object.id, slice));
    if (!slice.after) return Fail(ErrorCode::kInternal, "an object left the index while it was read at one moment");
  }
}

}  // namespace

Expected<FileSlice> MakeObjectPackage(TriageStore& store, const ObjectQuery& query, VideoNames names,
                                      const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const TemporaryFolder> folder, TemporaryFolder::Make());
  const std::filesystem::path path = folder->path() / "objects.gpkg";
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<GeoPackageFile> file, MakeGeoPackageFile(path));
    VICTORIOUS_RETURN_IF_ERROR(store.AtOneMoment([&] { return WriteAll(store, query, names, cancel, *file); }));
    VICTORIOUS_RETURN_IF_ERROR(file->Finish());
  }
  std::error_code error;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (error) return std::unexpected(ErrorFromErrno(error.value(), "read the file that was made"));
  return FileSlice{.path = path, .length = size, .hold = folder};
}

}  // namespace victorious
