// Which times of a video were searched, and why the others were not. Input: the records of its searches
// (index_store.h). Output: what lists and time lines show.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// A time of a video, presentation times in seconds.
struct TimeInterval {
  double from_s = 0;
  double to_s = 0;

  bool operator==(const TimeInterval&) const = default;
};

/// Why a time of a video is not searched, or not as the options of the search say.
enum class LeftOutReason {
  kNotBegun,   ///< the video was never searched for this model: one that was added later
  kNotYet,     ///< the search has not come so far: it goes on, or was stopped
  kNotWanted,  ///< outside of the time that was to be searched (`index --from --to`)
  kThinned,    ///< SearchPartKind::kThinned
  kDamaged,    ///< SearchPartKind::kDamaged
  kFailed,     ///< SearchPartKind::kFailed
};

/// The texts of the API.
inline constexpr auto kLeftOutReasonTexts =
    std::to_array<EnumText<LeftOutReason>>({{LeftOutReason::kNotBegun, "not_begun"},
                                            {LeftOutReason::kNotYet, "not_yet"},
                                            {LeftOutReason::kNotWanted, "not_wanted"},
                                            {LeftOutReason::kThinned, "thinned"},
                                            {LeftOutReason::kDamaged, "damaged"},
                                            {LeftOutReason::kFailed, "failed"}});

constexpr std::string_view ToText(LeftOutReason reason) { return ToText(kLeftOutReasonTexts, reason); }

struct LeftOutTime {
  double from_s = 0;
  std::optional<double> to_s;  ///< std::nullopt: to the end of the video, whose length is not known
  LeftOutReason reason = LeftOutReason::kNotBegun;
  std::vector<std::int64_t> models;  ///< ids, ascending, of those that it was not searched for; empty: for none of them

  bool operator==(const LeftOutTime&) const = default;
};

/// When and why: "0.30 s to the end: outside of --from and --to".
[[nodiscard]] std::string DescribeLeftOut(const LeftOutTime& one);

/// What the search for one model has covered of a video.
struct SearchCoverage {
  std::vector<TimeInterval> searched;  ///< as the options say
  std::vector<LeftOutTime> left_out;   ///< all else; `models` are empty
  std::int64_t frames = 0;             ///< in what was searched, also if it was thinned
};

/// @param search  null: it has not begun
/// @param parts   of this search, by frame (IndexStore::SearchParts)
[[nodiscard]] SearchCoverage CoverageOf(const VideoRecord& video, const SearchRecord* search,
                                        std::span<const SearchPart> parts);

/// What the searches for all models have covered of a video.
struct VideoCoverage {
  std::vector<TimeInterval> searched;  ///< for every model, as the options say
  std::vector<LeftOutTime> left_out;   ///< all else, by time; what differs between models overlaps
  double searched_s = 0;               ///< length of what was searched for any model, also if it was thinned

  /// True if the whole video was searched for every model, of which there is at least one.
  [[nodiscard]] bool IsWhole() const { return !searched.empty() && left_out.empty(); }
};

/// @param models    all of the index
/// @param searches  of this video, by model
/// @param parts     of this video, by model and frame
[[nodiscard]] VideoCoverage CoverageOf(const VideoRecord& video, std::span<const ModelRecord> models,
                                       std::span<const SearchRecord> searches, std::span<const SearchPart> parts);

}  // namespace victorious
