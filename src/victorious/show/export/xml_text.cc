#include "victorious/show/export/xml_text.h"

#include "victorious/base/json.h"

namespace victorious {

std::string EscapedXml(std::string_view text) {
  std::string escaped;
  const std::string valid = ReplaceInvalidUtf8(text);
  for (std::size_t i = 0; i < valid.size(); ++i) {
    const char c = valid[i];
    const std::string_view rest = std::string_view(valid).substr(i, 3);
    if (rest == "\xEF\xBF\xBE" || rest == "\xEF\xBF\xBF") {  // U+FFFE and U+FFFF are no characters
      escaped += "\xEF\xBF\xBD";
      i += 2;
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '\'') {
      escaped += "&apos;";
    } else if (c == '\t') {
      escaped += "&#9;";
    } else if (c == '\n') {
      escaped += "&#10;";
    } else if (static_cast<unsigned char>(c) >= 0x20) {  // the other control bytes are no characters
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace victorious
