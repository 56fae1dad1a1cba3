// Text in XML, of the exports that write it.
#pragma once

#include <string>
#include <string_view>

namespace victorious {

/// The text as XML 1.0 holds it, in content and in attributes of either quote, on one line. What is no character of XML
/// is left out or replaced by U+FFFD, and so are bytes that are not UTF-8.
[[nodiscard]] std::string EscapedXml(std::string_view text);

}  // namespace victorious
