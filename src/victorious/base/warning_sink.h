// Receiver of warnings: problems that a user should know of and that do not stop a job.
#pragma once

#include <functional>
#include <string>

namespace victorious {

/// Called with one line per warning: what of a video, its telemetry or a list was damaged or skipped, and where.
using WarningSink = std::function<void(const std::string& warning)>;

}  // namespace victorious
