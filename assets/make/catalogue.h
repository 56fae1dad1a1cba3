// tools/: the models and town assets that make_assets writes, by path.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "assets/make/asset.h"

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
  std::string path;  ///< relative to the assets folder, without extension
  std::function<Asset()> make;
};
const std::vector<Entry>& Catalogue();

}  // namespace victorious::assets
