// tools/: the assets of the town: buildings, trees, cars and street furniture.
#pragma once

#include <vector>

#include "assets/make/catalogue.h"

namespace victorious::assets {

const std::vector<Entry>& Buildings();
const std::vector<Entry>& Props();

}  // namespace victorious::assets
