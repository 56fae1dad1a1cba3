// Everything that make_assets makes, by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/assets_asset.h"

namespace victorious::assets {

Asset Jeep();
Asset Tank();
Asset Helicopter();
Asset Jet();
Asset FireEngine();
Asset Tanker();
Asset Ambulance();
Asset Bus();
Asset ContainerTruck();
Asset PoliceCar();
Asset Pickup();
Asset Excavator();
Asset BoatTrailer();
Asset PropellerPlane();

struct Entry {
  std::string path;  ///< below the folder of assets
  std::function<Asset()> make;
};
const std::vector<Entry>& Catalogue();

}  // namespace victorious::assets
