// Private to video/: collects warnings about damaged input with their times; repetitions of one kind share a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

class DamageLog {
 public:
  /// Logs an event of kind `what` at a video time. The first event gives the line "at 1.20 s: what"; repetitions
  /// rewrite it to "at 1.20 s, and 4 times more until 5.10 s: what".
  void Add(std::string_view what, double time_s);

  /// Appends a line as it is.
  void AddLine(std::string line);

  /// Appends a line that is no damage, to notes() too.
  void AddNote(std::string line);

  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

  /// Those of lines() that are no damage.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

  [[nodiscard]] bool has_damage() const { return lines_.size() > notes_.size(); }

 private:
  struct Kind {
    std::string what;
    double first_s = 0;
    std::int64_t repeats = 0;
    std::size_t line = 0;  ///< index in lines_
  };

  std::vector<Kind> kinds_;
  std::vector<std::string> lines_;
  std::vector<std::string> notes_;
};

}  // namespace victorious
