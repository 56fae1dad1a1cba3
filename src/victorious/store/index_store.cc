#include "victorious/store/index_store.h"

#include <algorithm>
#include <ranges>
#include <system_error>

#include "victorious/base/credentials.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> PathComponents(std::string_view name) {
  const fs::path path = fs::path(name).lexically_normal();
  std::vector<fs::path> parts(path.begin(), path.end());
  if (!parts.empty() && parts.back().empty()) parts.pop_back();  // "folder/" equals "folder"
  return parts;
}

bool IsPathSuffix(const std::vector<fs::path>& whole, const std::vector<fs::path>& end) {
  return !end.empty() && end.size() <= whole.size() && std::equal(end.rbegin(), end.rend(), whole.rbegin());
}

}  // namespace

std::vector<VideoRecord> FindVideosByName(const std::vector<VideoRecord>& videos, std::string_view name) {
  std::vector<VideoRecord> found;
  std::ranges::copy_if(videos, std::back_inserter(found), [&](const VideoRecord& video) { return video.name == name; });
  if (!found.empty()) return found;
  const std::vector<fs::path> end = PathComponents(name);
  std::ranges::copy_if(videos, std::back_inserter(found), [&](const VideoRecord& video) {
    return ShownName(video) == name || IsPathSuffix(PathComponents(video.name), end);
  });
  return found;
}

std::string ShownName(const VideoRecord& video) { return WithoutCredentials(video.name); }

std::string FindVideoFile(const VideoRecord& video) {
  if (video.folder.empty() || video.name.contains("://") || fs::path(video.name).is_absolute()) return video.name;
  const fs::path path = fs::path(video.folder) / video.name;
  std::error_code error;
  return fs::exists(path, error) ? path.string() : video.name;
}

Expected<std::vector<SightingRecord>> IndexStore::Sightings(const SightingFilter& filter) {
  std::vector<SightingRecord> sightings;
  VICTORIOUS_RETURN_IF_ERROR(VisitSightings(filter, [&](SightingRecord&& sighting) {
    sightings.push_back(std::move(sighting));
    return true;
  }));
  return sightings;
}

}  // namespace victorious
