#include "victorious/apps/serve/index_lookup.h"

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/base/json.h"

namespace victorious {

ApiExpected<ListedVideo> FindVideo(IndexView& index, std::string_view id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(id, "video"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index.Lists());
  const VideoRecord* record = lists->Video(number);
  if (record == nullptr) return NotFound(fmt::format("video {} is not in the index", number));
  return ListedVideo{lists, record};
}

ApiExpected<TriageObject> FindObject(IndexView& index, std::string_view id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(id, "object"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TriageObject> found, reader->objects->ObjectsById({&number, 1}));
  if (!found.empty()) return std::move(found.front());
  return NotFound(fmt::format("object {} is not in the index (a search may have joined or removed it)", number));
}

ApiExpected<HttpResponse> SightingsResponse(IndexView& index, SightingFilter filter, QueryReader& query) {
  constexpr std::int64_t kDefaultLimit = 2000;
  VICTORIOUS_ASSIGN_OR_RETURN(filter.from_s, query.Number("from", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(filter.to_s, query.Number("to", 0, 1e9));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto limit, query.Integer("limit", 1, 10'000));
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index.Borrow());
  Json rows = Json::array();
  bool is_truncated = false;
  VICTORIOUS_RETURN_IF_ERROR(reader->sightings->VisitSightings(filter, [&](SightingRecord&& sighting) {
    is_truncated = std::ssize(rows) == limit.value_or(kDefaultLimit);
    if (!is_truncated) rows.push_back(SightingToJson(sighting));
    return !is_truncated;
  }));
  return JsonResponse({{"sightings", std::move(rows)}, {"truncated", is_truncated}});
}

}  // namespace victorious
