// What is installed beside the program to try it with.
#pragma once

#include <optional>

#include "victorious/apps/serve/api_options.h"

namespace victorious::cli {

/// The demo's scene and a CAD file of one of its objects, in the repository or where they are installed beside the
/// program; std::nullopt: they are in neither.
[[nodiscard]] std::optional<SampleFiles> FindSample();

}  // namespace victorious::cli
