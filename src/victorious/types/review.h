// What people say of objects.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "victorious/base/enum_text.h"

namespace victorious {

/// What a person says of an object.
enum class Verdict {
  kAccepted,  ///< it is the object that was searched for
  kRejected,  ///< it is not
};

/// The texts in the index and in the API.
inline constexpr auto kVerdictTexts =
    std::to_array<EnumText<Verdict>>({{Verdict::kAccepted, "accepted"}, {Verdict::kRejected, "rejected"}});

constexpr std::string_view ToText(Verdict verdict) { return ToText(kVerdictTexts, verdict); }

/// The review of an object by one person.
struct Review {
  std::optional<Verdict> verdict;  ///< std::nullopt: undecided
  std::string note;
  std::int64_t updated_utc_us = 0;  ///< microseconds since 1970
  std::string reviewer;             ///< who says so; empty: nobody gave a name

  /// True if it says nothing: the same as no review.
  [[nodiscard]] bool IsEmpty() const { return !verdict && note.empty(); }
};

/// A review with the id that its object has at present.
struct ReviewedObject {
  std::int64_t object = 0;
  Review review;
};

}  // namespace victorious
