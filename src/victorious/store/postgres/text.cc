#include "victorious/store/postgres/text.h"

#include <cstddef>
#include <cstdint>

namespace victorious::postgres {
namespace {

// U+10FF00 + byte in UTF-8: F4 8F BC 80 to F4 8F BF BF.
constexpr std::string_view kReserved = "\xF4\x8F";
constexpr unsigned kFirstThird = 0xBC;

unsigned At(std::string_view text, std::size_t position) {
  return position < text.size() ? static_cast<unsigned char>(text[position]) : 0U;
}

bool IsContinuation(unsigned byte) { return byte >= 0x80 && byte <= 0xBF; }

// True if the four bytes at `position` are one of the characters that stand for a byte.
bool IsReserved(std::string_view text, std::size_t position) {
  return text.substr(position).starts_with(kReserved) && At(text, position + 2) >= kFirstThird &&
         IsContinuation(At(text, position + 2)) && IsContinuation(At(text, position + 3));
}

// The length of the valid UTF-8 character at `position` (Unicode 15, table 3-7); 0 if there is none.
std::size_t CharacterLength(std::string_view text, std::size_t position) {
  const unsigned first = At(text, position);
  const unsigned second = At(text, position + 1);
  if (first < 0x80) return 1;
  if (first < 0xC2 || first > 0xF4 || !IsContinuation(second)) return 0;
  if (first < 0xE0) return 2;
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F)) return 0;  // overlong; a surrogate
  if ((first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) return 0;  // overlong; beyond U+10FFFF
  if (!IsContinuation(At(text, position + 2))) return 0;
  if (first < 0xF0) return 3;
  return IsContinuation(At(text, position + 3)) ? 4 : 0;
}

}  // namespace

std::string EncodeText(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = bytes[i] == '\0' || IsReserved(bytes, i) ? 0 : CharacterLength(bytes, i);
    if (length > 0) {
      text += bytes.substr(i, length);
      i += length;
    } else {
      const unsigned byte = At(bytes, i);
      text += kReserved;
      text += static_cast<char>(kFirstThird + (byte >> 6));
      text += static_cast<char>(0x80 + (byte & 0x3F));
      ++i;
    }
  }
  return text;
}

std::string DecodeText(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    if (IsReserved(text, i)) {
      bytes += static_cast<char>(((At(text, i + 2) - kFirstThird) << 6) + (At(text, i + 3) & 0x3F));
      i += 4;
    } else {
      bytes += text[i];
      ++i;
    }
  }
  return bytes;
}

}  // namespace victorious::postgres
