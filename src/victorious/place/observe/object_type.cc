#include "victorious/place/observe/object_type.h"

#include <algorithm>
#include <array>
#include <ranges>
#include <string>

#include "victorious/base/text.h"

namespace victorious {
namespace {

// Typical lengths, and half of their spread.
constexpr std::array kTypes = {
    ObjectType{"vehicle", false, 5.5, 0.4},
    ObjectType{"car", false, 4.4, 0.12},
    ObjectType{"van", false, 5.5, 0.15},
    ObjectType{"pickup", false, 5.3, 0.1},
    ObjectType{"truck", false, 9, 0.35},
    ObjectType{"bus", false, 11, 0.2},
    ObjectType{"trailer", false, 8, 0.45},
    ObjectType{"tank", false, 8, 0.2},
    ObjectType{"motorcycle", false, 2.1, 0.12},
    ObjectType{"bicycle", false, 1.75, 0.08},
    ObjectType{"person", false, 1.2, 0.4},  // tall from the side, short from above
    ObjectType{"helicopter", false, 14, 0.3, true},
    ObjectType{"airplane", false, 15, 0.7, true},
    ObjectType{"boat", false, 8, 0.6},
    ObjectType{"train", false, 0, 0},
    ObjectType{"ship", false, 0, 0},
    ObjectType{"animal", false, 0, 0},
    ObjectType{"building", true, 0, 0},
    ObjectType{"tower", true, 0, 0},
    ObjectType{"tree", true, 0, 0},
    ObjectType{"landmark", true, 0, 0},
};

}  // namespace

const ObjectType* FindObjectType(std::string_view word) {
  const ObjectType* found = nullptr;
  for (const auto part : std::views::split(word, '/')) {
    const std::string name = LowerCase(std::string_view(part.begin(), part.end()));
    const auto* type = std::ranges::find(kTypes, name, &ObjectType::name);
    if (type != kTypes.end()) found = type;
  }
  return found;
}

std::span<const ObjectType> ObjectTypes() { return kTypes; }

}  // namespace victorious
