// Texts without the folders of the machine: what users get who may not know where its files lie.
#pragma once

#include <string>

namespace victorious {

/// Leaves of each absolute path in a text its last name: "/srv/my videos/a.mp4: damaged" is "a.mp4: damaged". Accepts
/// any bytes; of JSON it returns JSON. What looks like a path but is an address of the API, or of a network, stays.
/// A folder's name may have blanks, so that words between two paths, with nothing but blanks around them, go as well.
[[nodiscard]] std::string WithoutFolders(const std::string& text);

}  // namespace victorious
