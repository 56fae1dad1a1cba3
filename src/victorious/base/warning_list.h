// Warnings about a source. Damaged data may give one per packet or row: the first ones are kept as lines, the others
// are counted.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace victorious {

class WarningList {
 public:
  static constexpr std::size_t kMaxLines = 20;  ///< enough to see the kind of damage

  void Add(std::string line);

  /// As Add, but a line that is already kept is neither added nor counted again. Beyond kMaxLines, repeats are counted.
  void AddOnce(std::string line);

  /// Adds all warnings of another list, each line after `prefix`.
  void Append(std::string_view prefix, const WarningList& other);

  [[nodiscard]] bool empty() const { return lines_.empty(); }

  /// @return the first kMaxLines lines; if there are more, also a line "and N more warnings of this kind"
  [[nodiscard]] std::vector<std::string> Lines() const;

 private:
  std::vector<std::string> lines_;
  std::size_t omitted_ = 0;
};

}  // namespace victorious
