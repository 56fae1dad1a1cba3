// The routes of objects: the list, its counts and its GeoPackage, tiles of the map, one object with its sightings and
// review.
// Thread-safe.
#pragma once

#include <semaphore>

#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/apps/serve/video_files.h"

namespace victorious {

class ObjectRoutes {
 public:
  ObjectRoutes(IndexView& index, VideoFiles& videos) : index_(index), videos_(videos) {}

  ApiExpected<HttpResponse> List(const ApiCall& call);
  ApiExpected<HttpResponse> Counts(const ApiCall& call);
  ApiExpected<HttpResponse> Package(const ApiCall& call);
  ApiExpected<HttpResponse> Tile(const ApiCall& call);
  ApiExpected<HttpResponse> Get(const ApiCall& call);
  ApiExpected<HttpResponse> Sightings(const ApiCall& call);
  ApiExpected<HttpResponse> Thumbnail(const ApiCall& call);
  ApiExpected<HttpResponse> Decisions(const ApiCall& call);
  ApiExpected<HttpResponse> PutReview(const ApiCall& call);
  ApiExpected<HttpResponse> Regroup(const ApiCall& call);

 private:
  IndexView& index_;
  VideoFiles& videos_;
  std::counting_semaphore<> packages_{1};     // each keeps a reader and a thread for long
  std::counting_semaphore<> regroupings_{1};  // each makes all objects anew
};

}  // namespace victorious
