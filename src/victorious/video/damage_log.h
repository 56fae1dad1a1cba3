// Private to video/: what was damaged and where, a line for each kind however often it happens.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

class DamageLog {
 public:
  /// Something wrong at a time: "at 1.20 s: what", then "at 1.20 s, and 4 times more until 5.10 s: what".
  void Add(std::string_view what, double time_s);

  /// A line that stands alone.
  void AddLine(std::string line);

  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  struct Kind {
    std::string what;
    double first_s = 0;
    std::int64_t repeats = 0;
    std::size_t line = 0;
  };

  std::vector<Kind> kinds_;
  std::vector<std::string> lines_;
};

}  // namespace victorious
