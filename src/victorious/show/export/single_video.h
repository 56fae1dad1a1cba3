// The video of a format that has room for one.
#pragma once

#include <string_view>

#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"

namespace victorious {

/// The video that matches the filter; nullptr: none does. Error: kInvalidArgument, with their names, if there are more.
/// @param format  its name, for the message
[[nodiscard]] Expected<const VideoRecord*> FindSingleVideo(const ExportRequest& request, std::string_view format);

}  // namespace victorious
