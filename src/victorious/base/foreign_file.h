// Names files of kinds that users have and that nothing here reads, for the line that refuses them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace victorious {

/// What a file is by its first bytes, and what to do with it: "a STEP file: CAD solids are not read: export it as
/// glTF". std::nullopt for all others.
[[nodiscard]] std::optional<std::string> DescribeForeignFile(std::span<const std::byte> bytes);

}  // namespace victorious
