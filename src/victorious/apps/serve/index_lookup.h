// What several routes look up in the index.
#pragma once

#include <memory>
#include <string_view>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/http_message.h"
#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/request_target.h"

namespace victorious {

/// A video of the index, and the lists that hold it.
struct ListedVideo {
  std::shared_ptr<const IndexLists> lists;
  const VideoRecord* record = nullptr;
};

/// The video of an id in an address. Error: kNotFound.
[[nodiscard]] ApiExpected<ListedVideo> FindVideo(IndexView& index, std::string_view id);

/// The object of an id in an address. Error: kNotFound.
[[nodiscard]] ApiExpected<TriageObject> FindObject(IndexView& index, std::string_view id);

/// The sightings that a filter and the query let through. Error: kInvalidArgument for another parameter.
[[nodiscard]] ApiExpected<HttpResponse> SightingsResponse(IndexView& index, SightingFilter filter, QueryReader& query);

}  // namespace victorious
