#include "assets/make/catalogue.h"

#include "assets/make/town.h"

namespace victorious::assets {

const std::vector<Entry>& Catalogue() {
  static const std::vector<Entry> kCatalogue = [] {
    std::vector<Entry> entries = {
        {"models/jeep", Jeep},
        {"models/tank", Tank},
        {"models/helicopter", Helicopter},
        {"models/jet", Jet},
        {"models/fire_engine", FireEngine},
        {"models/tanker", Tanker},
        {"models/ambulance", Ambulance},
        {"models/bus", Bus},
        {"models/container_truck", ContainerTruck},
        {"models/police_car", PoliceCar},
        {"models/pickup", Pickup},
        {"models/excavator", Excavator},
        {"models/boat_trailer", BoatTrailer},
        {"models/propeller_plane", PropellerPlane},
    };
    for (const std::vector<Entry>* more : {&Buildings(), &Props()})
      entries.insert(entries.end(), more->begin(), more->end());
    return entries;
  }();
  return kCatalogue;
}

}  // namespace victorious::assets
