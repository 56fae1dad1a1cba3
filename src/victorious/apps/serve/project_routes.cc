#include "victorious/apps/serve/project_routes.h"

#include <filesystem>
#include <utility>

#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/file_response.h"
#include "victorious/base/json.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

// As the page shows it: of a database all that its readers may see, of a file its name without its folder.
std::string NameOfIndex(const std::string& index) {
  return IsDatabaseUrl(index) ? StoreName(index) : std::filesystem::path(index).filename().string();
}

}  // namespace

ApiExpected<HttpResponse> ProjectRoutes::Get(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectCounts counts, reader->objects->Count({}));
  const bool may_decide = call.caller.May(Role::kAnalyst);
  const bool has_jobs = live_.has_jobs() && may_decide;
  Json project = ProjectToJson(NameOfIndex(options_.index), *lists, counts, index_.can_review() && may_decide,
                               !options_.models.empty(), has_jobs, options_.categories, options_.base_map);
  project["has_targets"] = inputs_.HasModels() || !options_.categories.empty();
  project["has_sample"] = has_jobs && inputs_.HasSample(*lists);
  return JsonResponse(project);
}

ApiExpected<HttpResponse> ProjectRoutes::BaseMapFile(const ApiCall& call) {
  if (options_.base_map.file.empty()) return NotFound("this server has no base map: `victorious serve --tiles FILE`");
  return SendFile(call.request, options_.base_map.file, options_.base_map.file);
}

}  // namespace victorious
