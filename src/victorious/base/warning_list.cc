#include "victorious/base/warning_list.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace victorious {

void WarningList::Add(std::string line) {
  if (lines_.size() < kMaxLines) {
    lines_.push_back(std::move(line));
  } else {
    ++omitted_;
  }
}

void WarningList::AddOnce(std::string line) {
  if (std::ranges::find(lines_, line) == lines_.end()) Add(std::move(line));
}

void WarningList::Append(std::string_view prefix, const WarningList& other) {
  for (const std::string& line : other.lines_) Add(fmt::format("{}{}", prefix, line));
  omitted_ += other.omitted_;
}

std::vector<std::string> WarningList::Lines() const {
  std::vector<std::string> lines = lines_;
  if (omitted_ > 0) lines.push_back(fmt::format("and {} more warnings of this kind", omitted_));
  return lines;
}

}  // namespace victorious
