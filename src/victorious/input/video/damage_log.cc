#include "victorious/input/video/damage_log.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace victorious {

void DamageLog::Add(std::string_view what, double time_s) {
  const auto kind = std::ranges::find(kinds_, what, &Kind::what);
  if (kind == kinds_.end()) {
    kinds_.push_back({.what = std::string(what), .first_s = time_s, .line = lines_.size()});
    lines_.push_back(fmt::format("at {:.2f} s: {}", time_s, what));
    return;
  }
  ++kind->repeats;
  lines_[kind->line] = fmt::format("at {:.2f} s, and {} {} more until {:.2f} s: {}", kind->first_s, kind->repeats,
                                   kind->repeats == 1 ? "time" : "times", time_s, what);
}

void DamageLog::AddLine(std::string line) { lines_.push_back(std::move(line)); }

void DamageLog::AddNote(std::string line) {
  notes_.push_back(line);
  AddLine(std::move(line));
}

}  // namespace victorious
