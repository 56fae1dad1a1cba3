#include "victorious/store/video_coverage.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr double kNever_s = std::numeric_limits<double>::infinity();
constexpr double kRoundingOfTimes_s = 1e-6;

std::optional<LeftOutReason> ReasonOf(SearchPartKind kind) {
  switch (kind) {
    case SearchPartKind::kSearched:
      return std::nullopt;
    case SearchPartKind::kThinned:
      return LeftOutReason::kThinned;
    case SearchPartKind::kDamaged:
      return LeftOutReason::kDamaged;
    case SearchPartKind::kFailed:
      return LeftOutReason::kFailed;
  }
  return std::nullopt;
}

// The parts without gaps of a frame's duration between those whose frames follow each other, and without what others
// say better: a search that an older version made does not know of its damage.
std::vector<SearchPart> Divide(std::span<const SearchPart> parts) {
  std::vector<SearchPart> divided;
  std::vector<SearchPart> exceptions;
  for (const SearchPart& part : parts) {
    (part.kind == SearchPartKind::kSearched ? divided : exceptions).push_back(part);
  }
  for (const SearchPart& exception : exceptions) {
    std::vector<SearchPart> rest;
    for (const SearchPart& part : divided) {
      if (exception.to_s <= part.from_s || exception.from_s >= part.to_s) {
        rest.push_back(part);
        continue;
      }
      SearchPart before = part;
      before.to_frame = exception.from_frame;
      before.to_s = exception.from_s;
      if (before.from_s < before.to_s) rest.push_back(before);
      SearchPart after = part;
      after.from_frame = exception.to_frame;
      after.from_s = exception.to_s;
      if (after.from_s < after.to_s) rest.push_back(after);
    }
    divided = std::move(rest);
  }
  divided.insert(divided.end(), exceptions.begin(), exceptions.end());
  std::ranges::sort(divided, {}, [](const SearchPart& part) { return std::pair(part.from_s, part.to_s); });
  for (std::size_t i = 0; i + 1 < divided.size(); ++i) {
    if (divided[i].to_frame == divided[i + 1].from_frame) divided[i].to_s = divided[i + 1].from_s;
  }
  return divided;
}

// Adds an interval, or prolongs the last one that it touches.
void Add(std::vector<TimeInterval>& intervals, TimeInterval one) {
  if (!intervals.empty() && one.from_s <= intervals.back().to_s + kRoundingOfTimes_s) {
    intervals.back().to_s = std::max(intervals.back().to_s, one.to_s);
  } else {
    intervals.push_back(one);
  }
}

std::vector<TimeInterval> Intersection(std::span<const TimeInterval> a, std::span<const TimeInterval> b) {
  std::vector<TimeInterval> common;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const TimeInterval one = {std::max(a[i].from_s, b[j].from_s), std::min(a[i].to_s, b[j].to_s)};
    if (one.from_s <= one.to_s) common.push_back(one);
    ++(a[i].to_s < b[j].to_s ? i : j);
  }
  return common;
}

// The length of the union.
double LengthOf(std::vector<TimeInterval> intervals) {
  std::ranges::sort(intervals, {}, &TimeInterval::from_s);
  std::vector<TimeInterval> joined;
  for (const TimeInterval& one : intervals) Add(joined, one);
  double length_s = 0;
  for (const TimeInterval& one : joined) length_s += one.to_s - one.from_s;
  return length_s;
}

// Joins those of different models that agree.
std::vector<LeftOutTime> Join(std::vector<LeftOutTime> times) {
  const auto key = [](const LeftOutTime& one) {
    return std::tuple(one.from_s, one.to_s.value_or(kNever_s), one.reason);
  };
  std::ranges::stable_sort(times, {}, key);
  std::vector<LeftOutTime> joined;
  for (LeftOutTime& one : times) {
    if (!joined.empty() && key(joined.back()) == key(one)) {
      joined.back().models.insert(joined.back().models.end(), one.models.begin(), one.models.end());
    } else {
      joined.push_back(std::move(one));
    }
  }
  return joined;
}

std::string_view DescriptionOf(LeftOutReason reason) {
  switch (reason) {
    case LeftOutReason::kNotBegun:
      return "not searched";
    case LeftOutReason::kNotYet:
      return "not searched yet, run `index` again to continue";
    case LeftOutReason::kNotWanted:
      return "outside of --from and --to";
    case LeftOutReason::kThinned:
      return "searched in part only, to keep the pace";
    case LeftOutReason::kDamaged:
      return "no frames, the video is damaged";
    case LeftOutReason::kFailed:
      return "left out, because its search failed";
  }
  return "";
}

}  // namespace

std::string DescribeLeftOut(const LeftOutTime& one) {
  const std::string end = one.to_s ? fmt::format("{:.2f} s", *one.to_s) : "the end";
  return fmt::format("{:.2f} s to {}: {}", one.from_s, end, DescriptionOf(one.reason));
}

SearchCoverage CoverageOf(const VideoRecord& video, const SearchRecord* search, std::span<const SearchPart> parts) {
  SearchCoverage coverage;
  if (search == nullptr) {
    coverage.left_out.push_back(
        {.from_s = 0, .to_s = video.duration_s, .reason = LeftOutReason::kNotBegun, .models = {}});
    return coverage;
  }
  std::optional<double> covered_s;
  const auto leave_out = [&](double from_s, std::optional<double> to_s, LeftOutReason reason) {
    coverage.left_out.push_back({.from_s = from_s, .to_s = to_s, .reason = reason, .models = {}});
  };
  for (const SearchPart& part : Divide(parts)) {
    const std::optional<LeftOutReason> reason = ReasonOf(part.kind);
    if (part.from_s > covered_s.value_or(0) + kRoundingOfTimes_s) {
      leave_out(covered_s.value_or(0), part.from_s, covered_s ? LeftOutReason::kFailed : LeftOutReason::kNotWanted);
    }
    if (reason)
      leave_out(part.from_s, part.to_s, *reason);
    else
      Add(coverage.searched, {part.from_s, part.to_s});
    const bool has_frames = part.kind == SearchPartKind::kSearched || part.kind == SearchPartKind::kThinned;
    coverage.frames += has_frames ? part.to_frame - part.from_frame : 0;
    covered_s = std::max(covered_s.value_or(0), part.to_s);
  }
  const bool is_to_the_end = video.duration_s && covered_s && *covered_s >= *video.duration_s - kRoundingOfTimes_s;
  if (is_to_the_end) return coverage;
  leave_out(covered_s.value_or(0), video.duration_s,
            search->finished ? LeftOutReason::kNotWanted : LeftOutReason::kNotYet);
  return coverage;
}

VideoCoverage CoverageOf(const VideoRecord& video, std::span<const ModelRecord> models,
                         std::span<const SearchRecord> searches, std::span<const SearchPart> parts) {
  VideoCoverage coverage;
  const auto sought = std::ranges::count(models, false, &ModelRecord::IsBoxed);
  std::vector<LeftOutTime> left_out;
  std::vector<TimeInterval> of_any;
  bool is_first = true;
  for (const ModelRecord& model : models) {
    if (model.IsBoxed()) continue;
    const auto search = std::ranges::find(searches, model.id, &SearchRecord::model);
    const auto own = std::ranges::equal_range(parts, model.id, {}, &SearchPart::model);
    SearchCoverage of_one =
        CoverageOf(video, search == searches.end() ? nullptr : &*search, std::span(own.begin(), own.end()));
    for (LeftOutTime& one : of_one.left_out) {
      if (one.reason == LeftOutReason::kThinned) of_any.push_back({one.from_s, one.to_s.value_or(one.from_s)});
      one.models = {model.id};
      left_out.push_back(std::move(one));
    }
    of_any.insert(of_any.end(), of_one.searched.begin(), of_one.searched.end());
    coverage.searched =
        std::exchange(is_first, false) ? of_one.searched : Intersection(coverage.searched, of_one.searched);
  }
  if (sought == 0) left_out = CoverageOf(video, nullptr, {}).left_out;
  coverage.left_out = Join(std::move(left_out));
  for (LeftOutTime& one : coverage.left_out) {
    if (std::ssize(one.models) == sought) one.models.clear();
  }
  coverage.searched_s = LengthOf(std::move(of_any));
  return coverage;
}

}  // namespace victorious
