// list_objects INDEX: opens an index (a SQLite file, or the URL of a PostgreSQL database) and prints one line per
// object, best first: rank, model, score, number of frames, and place with its 90 % error radius, if it has one.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/error.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

Status PrintObjects(const std::string& index) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(index, StoreMode::kRead));
  const SightingFilter all;
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(*store, all));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects, ListObjects(*store, catalogue, all));
  for (const ListedObject& listed : objects) {
    const ObjectRecord& object = listed.object;
    fmt::print("{} {} {:.3f} {}", listed.rank, listed.model, object.score, object.frames);
    if (object.place) {
      fmt::print(" {:.6f},{:.6f} +-{:.1f} m", DegreesFromRadians(object.place->point.latitude_rad),
                 DegreesFromRadians(object.place->point.longitude_rad), object.place->ce90_m);
    }
    fmt::print("\n");
  }
  return {};
}

}  // namespace
}  // namespace victorious

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: list_objects INDEX\n");
    return 2;
  }
  if (const victorious::Status printed = victorious::PrintObjects(argv[1]); !printed) {
    fmt::print(stderr, "list_objects: {}\n", printed.error().message);
    return victorious::ExitStatus(printed.error().code);
  }
  return 0;
}
