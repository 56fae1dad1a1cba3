#include "tools/assets_catalogue.h"

namespace victorious::assets {

const std::vector<Entry>& Catalogue() {
  static const std::vector<Entry> kCatalogue = {
      {"models/jeep", Jeep},
      {"models/tank", Tank},
      {"models/helicopter", Helicopter},
      {"models/jet", Jet},
  };
  return kCatalogue;
}

}  // namespace victorious::assets
