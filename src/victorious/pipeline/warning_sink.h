// Where the jobs tell what a person should know, and that does not stop them.
#pragma once

#include <functional>
#include <string>

namespace victorious {

/// Called with one line at a time: what of a video, its telemetry or a list was damaged or left out, and where.
using WarningSink = std::function<void(const std::string& warning)>;

}  // namespace victorious
