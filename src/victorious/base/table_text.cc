#include "victorious/base/table_text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "victorious/base/text.h"

namespace victorious {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

void AppendUtf8(char32_t code, std::string& text) {
  const auto append = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) {
    append(code);
  } else if (code < 0x800) {
    append(0xC0 | code >> 6);
    append(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    append(0xE0 | code >> 12);
    append(0x80 | (code >> 6 & 0x3F));
    append(0x80 | (code & 0x3F));
  } else {
    append(0xF0 | code >> 18);
    append(0x80 | (code >> 12 & 0x3F));
    append(0x80 | (code >> 6 & 0x3F));
    append(0x80 | (code & 0x3F));
  }
}

std::string Utf8FromUtf16(std::string_view bytes, bool big_endian) {
  const auto unit = [&](std::size_t at) -> char32_t {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const auto second = static_cast<unsigned char>(bytes[at + 1]);
    return big_endian ? first << 8 | second : second << 8 | first;
  };
  std::string text;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    const char32_t code = unit(at);
    if (code < 0xD800 || code > 0xDFFF) {
      AppendUtf8(code, text);
      continue;
    }
    const char32_t low = at + 3 < bytes.size() ? unit(at + 2) : 0;
    if (code < 0xDC00 && low >= 0xDC00 && low <= 0xDFFF) {
      AppendUtf8(0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00), text);
      at += 2;
    } else {
      AppendUtf8(kReplacement, text);
    }
  }
  return text;
}

char SeparatorOf(std::string_view header) {
  char best = ',';
  std::size_t most = SplitRow(header, best).size();
  for (const char separator : {';', '\t'}) {
    const std::size_t cells = SplitRow(header, separator).size();
    if (cells <= most) continue;
    most = cells;
    best = separator;
  }
  return best;
}

// "12,5" as "12.5"; any other cell as it is.
std::string WithDecimalPoint(std::string cell) {
  const std::size_t comma = cell.find(',');
  if (comma == std::string::npos) return cell;
  std::string pointed = cell;
  pointed[comma] = '.';
  return ParseNumber(pointed) ? pointed : cell;
}

std::string Quoted(const std::string& cell) {
  if (cell.find_first_of(",\"") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) {
    if (c == '"') quoted += c;
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string Utf8FromText(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE")) return Utf8FromUtf16(bytes.substr(2), false);
  if (bytes.starts_with("\xFE\xFF")) return Utf8FromUtf16(bytes.substr(2), true);
  constexpr std::size_t kLetters = 4;
  if (bytes.size() >= 2 * kLetters) {
    const auto is_zero = [&](std::size_t i) { return bytes[i] == '\0'; };
    bool little = true;
    bool big = true;
    for (std::size_t i = 0; i < 2 * kLetters; i += 2) {
      little = little && !is_zero(i) && is_zero(i + 1);
      big = big && is_zero(i) && !is_zero(i + 1);
    }
    if (little || big) return Utf8FromUtf16(bytes, big);
  }
  return std::string(StripByteOrderMark(bytes));
}

std::string CommaSeparated(std::string_view bytes) {
  const std::string text = Utf8FromText(bytes);
  std::string_view rest = text;
  std::string_view header = rest;
  header = TakeLine(header);
  constexpr std::string_view kSeparatorLine = "sep=";
  const bool has_separator_line = LowerCase(header.substr(0, kSeparatorLine.size())) == kSeparatorLine;
  if (has_separator_line) {
    static_cast<void>(TakeLine(rest));
    header = rest;
    header = TakeLine(header);
  }
  const char separator = SeparatorOf(header);
  std::string table(has_separator_line ? "\n" : "");
  if (separator == ',') return table.append(rest);
  while (!rest.empty()) {
    bool first = true;
    for (std::string& cell : SplitRow(TakeLine(rest), separator)) {
      if (!first) table += ',';
      first = false;
      table += Quoted(WithDecimalPoint(std::move(cell)));
    }
    table += '\n';
  }
  return table;
}

}  // namespace victorious
