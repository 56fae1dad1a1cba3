// The fast cascade. Quantities of a single match (scale ratio, rotation, position) are computed once per match, so that
// a pair costs a few additions. A grid of cells of side R limits the pairs to neighbouring cells.
#include "victorious/search/grammar/cascade.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "victorious/geometry/angles.h"
#include "victorious/search/grammar/template_radius.h"

namespace victorious {

void CascadeOptions::ListFields(FieldList& fields) {
  fields.Add("filter", filter, kCascadeFilterTexts,
             {.reason = "filter of the matches before pose estimation: the cascade of three stages; one of its stages "
                        "alone; voting by nearest neighbours as in Video Google; no filter"});
  fields.Add(
      "radius_px", radius_px,
      {.min = 1,
       .max = 1e5,
       .unit = "px",
       .reason =
           "R: matches within this distance in the scene vote for each other; about the object's radius (table 3.1)"});
  fields.Add(
      "scale_distortion", scale_distortion,
      {.min = 1,
       .max = 100,
       .reason =
           "SCALE_FUDGE_FACTOR: the ratio of two keypoints' scales may differ by less than this factor (table 3.1)"});
  fields.Add("distance_distortion", distance_distortion,
             {.min = 1,
              .max = 100,
              .reason = "DIST_SCALE_FUDGE_FACTOR: the ratio of mean scale to distance may differ by less than this "
                        "factor (table 3.1)"});
  fields.Add(
      "first_approval", first_approval,
      {.min = 0,
       .max = 1,
       .reason =
           "DIST_APPROVE_THRESHOLD: the fraction of possible votes that keeps a match in the first stage (table 3.1)"});
  fields.Add(
      "orientation_distortion_rad", orientation_distortion_rad,
      {.min = 0,
       .max = 3.15,
       .unit = "rad",
       .reason = "ANG_FUDGE_FACTOR: the difference of two orientations may differ by less than this (table 3.1)"});
  fields.Add("line_distortion_rad", line_distortion_rad,
             {.min = 0,
              .max = 3.15,
              .unit = "rad",
              .reason = "ANG_ORIENT_FUDGE_FACTOR: the angle from the mean orientation to the connecting line may "
                        "differ by less than this (table 3.1)"});
  fields.Add(
      "second_approval", second_approval,
      {.min = 0,
       .max = 1,
       .reason =
           "ANG_APPROVE_THRESHOLD: the fraction of possible votes that keeps a match in the second stage (table 3.1)"});
  fields.Add("third_approval", third_approval,
             {.min = 0,
              .max = 1,
              .reason = "RE_DIST_APPROVE_THRESHOLD: the fraction of possible votes that keeps a match in the third "
                        "stage (table 3.1)"});
}

namespace {

// The quantities of one match that the pair tests need.
struct MatchNode {
  double x, y;                      // scene, px
  double template_x, template_y;    // template, px
  double scale, template_scale;     // px
  double log_scale_change;          // ln(scene scale / template scale)
  double turn_rad;                  // scene orientation - template orientation
  double radius2;                   // R squared, px^2
  std::uint32_t template_keypoint;  // template keypoint
  std::uint32_t match;              // position in the caller's matches
};

std::vector<MatchNode> MakeNodes(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                                 const MatchSet& matches, const CascadeOptions& options) {
  const bool by_scale = options.radius == CascadeRadius::kScale;
  const double template_radius = by_scale ? options.radius_fraction * TemplateRadius(template_keypoints) : 0;
  std::vector<MatchNode> nodes;
  nodes.reserve(matches.size());
  for (std::uint32_t i = 0; i < matches.size(); ++i) {
    const Keypoint& s = scene[matches[i].scene_keypoint];
    const Keypoint& m = template_keypoints[matches[i].template_keypoint];
    const double scale_change = static_cast<double>(s.scale_px) / m.scale_px;
    const double radius = by_scale ? scale_change * template_radius : options.radius_px;
    nodes.push_back({s.x, s.y, m.x, m.y, s.scale_px, m.scale_px, std::log(scale_change),
                     static_cast<double>(s.orientation_rad) - m.orientation_rad, radius * radius,
                     matches[i].template_keypoint, i});
  }
  return nodes;
}

// Sorts the nodes into square cells of side >= R, so that all nodes within R of a node lie in its cell or its 8
// neighbours.
class Grid {
 public:
  Grid(std::vector<MatchNode>& nodes, double radius) {
    double x1 = -1e300;
    double y1 = -1e300;
    for (const MatchNode& node : nodes) {
      x0_ = std::min(x0_, node.x);
      y0_ = std::min(y0_, node.y);
      x1 = std::max(x1, node.x);
      y1 = std::max(y1, node.y);
    }
    // Bounds the number of cells by a few per node for small R.
    const double min_cell = std::sqrt((x1 - x0_ + 1) * (y1 - y0_ + 1) / (4.0 * static_cast<double>(nodes.size()) + 4));
    cell_ = std::max(radius, min_cell);
    columns_ = static_cast<int>((x1 - x0_) / cell_) + 1;
    rows_ = static_cast<int>((y1 - y0_) / cell_) + 1;
    begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const MatchNode& node : nodes) ++begin_[CellOf(node) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    std::vector<MatchNode> sorted(nodes.size());
    for (const MatchNode& node : nodes) sorted[next[CellOf(node)]++] = node;
    nodes = std::move(sorted);
  }

  // Calls visit(i, j) once for each pair of nodes in neighbouring cells, i < j.
  template <typename Visit>
  void ForEachNear(Visit&& visit) const {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const std::size_t cell =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
        // The own cell and its right neighbour are one contiguous range of nodes; the three cells below are another.
        const std::uint32_t run_end = begin_[cell + (column + 1 < columns_ ? 2 : 1)];
        const std::size_t below = cell + static_cast<std::size_t>(columns_);
        const bool has_below = row + 1 < rows_;
        const std::uint32_t below_begin = has_below ? begin_[below - (column > 0 ? 1 : 0)] : 0;
        const std::uint32_t below_end = has_below ? begin_[below + (column + 1 < columns_ ? 2 : 1)] : 0;
        for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
          for (std::uint32_t j = i + 1; j < run_end; ++j) visit(i, j);
          for (std::uint32_t j = below_begin; j < below_end; ++j) visit(i, j);
        }
      }
    }
  }

  // Calls visit(j) for each node in the cell of a node and in the 8 cells around it, the node itself included.
  template <typename Visit>
  void ForEachAround(const MatchNode& node, Visit&& visit) const {
    const auto cell = static_cast<int>(CellOf(node));
    const int column = cell % columns_;
    for (int row = std::max(0, cell / columns_ - 1); row <= std::min(rows_ - 1, cell / columns_ + 1); ++row) {
      const int first = row * columns_ + std::max(0, column - 1);
      const int last = row * columns_ + std::min(columns_ - 1, column + 1);
      for (std::uint32_t j = begin_[static_cast<std::size_t>(first)]; j < begin_[static_cast<std::size_t>(last) + 1];
           ++j) {
        visit(j);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t CellOf(const MatchNode& node) const {
    const auto column = static_cast<std::size_t>((node.x - x0_) / cell_);
    const auto row = static_cast<std::size_t>((node.y - y0_) / cell_);
    return row * static_cast<std::size_t>(columns_) + column;
  }

  double x0_ = 1e300;
  double y0_ = 1e300;
  double cell_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::uint32_t> begin_;
};

// Predicate on the first two measures: scale ratio, and mean scale over distance.
class ScalesAgree {
 public:
  explicit ScalesAgree(const CascadeOptions& options)
      : log_scale_(std::log(options.scale_distortion)),
        distance2_(options.distance_distortion * options.distance_distortion) {}

  bool operator()(const MatchNode& i, const MatchNode& j, double dx, double dy) const {
    if (!(std::abs(i.log_scale_change - j.log_scale_change) < log_scale_)) return false;
    // (a / b)^2 with a, b = mean scale over distance in the scene and the template, cross-multiplied.
    const double template_dx = j.template_x - i.template_x;
    const double template_dy = j.template_y - i.template_y;
    const double mean_scale = i.scale + j.scale;
    const double template_mean_scale = i.template_scale + j.template_scale;
    const double a = mean_scale * mean_scale * (template_dx * template_dx + template_dy * template_dy);
    const double b = template_mean_scale * template_mean_scale * (dx * dx + dy * dy);
    return a < distance2_ * b && b < distance2_ * a;
  }

 private:
  double log_scale_;
  double distance2_;
};

// Predicate on the last two measures. With t the rotation of each match, theta_a changes by t_j - t_i, and theta_b by
// the rotation of the connecting line minus the mean rotation t_i + (t_j - t_i) / 2. Equals the definition, and is
// stable where the two orientations are opposite.
class AnglesAgree {
 public:
  explicit AnglesAgree(const CascadeOptions& options)
      : orientation_(options.orientation_distortion_rad), line_(options.line_distortion_rad) {}

  bool operator()(const MatchNode& i, const MatchNode& j, double dx, double dy) const {
    const double change = WrapAngle(j.turn_rad - i.turn_rad);
    if (!(std::abs(change) < orientation_)) return false;
    const double template_dx = j.template_x - i.template_x;
    const double template_dy = j.template_y - i.template_y;
    if (template_dx == 0 && template_dy == 0) return false;
    // The angle from the template's line to the scene's.
    const double line_turn = std::atan2(template_dx * dy - template_dy * dx, template_dx * dx + template_dy * dy);
    return std::abs(WrapAngle(line_turn - i.turn_rad - change / 2)) < line_;
  }

 private:
  double orientation_;
  double line_;
};

class AllAgree {
 public:
  explicit AllAgree(const CascadeOptions& options) : scales_(options), angles_(options) {}

  bool operator()(const MatchNode& i, const MatchNode& j, double dx, double dy) const {
    return scales_(i, j, dx, dy) && angles_(i, j, dx, dy);
  }

 private:
  ScalesAgree scales_;
  AnglesAgree angles_;
};

struct Tally {
  std::uint32_t votes = 0;
  std::uint32_t possible = 0;
};

bool IsApproved(const Tally& tally, int min_votes, double approval) {
  return tally.votes >= static_cast<std::uint32_t>(min_votes) && tally.votes > approval * tally.possible;
}

// Calls visit(i, j, dx, dy, distance2) once for each pair of nodes, i < j, at different positions, at least one of them
// within the R of the other.
template <typename Visit>
void ForEachPair(const std::vector<MatchNode>& nodes, const Grid& grid, const Visit& visit) {
  grid.ForEachNear([&](std::uint32_t i, std::uint32_t j) {
    const double dx = nodes[j].x - nodes[i].x;
    const double dy = nodes[j].y - nodes[i].y;
    const double distance2 = dx * dx + dy * dy;
    if (distance2 != 0 && distance2 < std::max(nodes[i].radius2, nodes[j].radius2)) visit(i, j, dx, dy, distance2);
  });
}

template <typename Agree>
std::vector<Tally> CountVotes(const std::vector<MatchNode>& nodes, const Grid& grid, const Agree& agree) {
  std::vector<Tally> tallies(nodes.size());
  ForEachPair(nodes, grid, [&](std::uint32_t i, std::uint32_t j, double dx, double dy, double distance2) {
    const std::uint32_t votes_for_i = distance2 < nodes[i].radius2 ? 1 : 0;
    const std::uint32_t votes_for_j = distance2 < nodes[j].radius2 ? 1 : 0;
    tallies[i].possible += votes_for_i;
    tallies[j].possible += votes_for_j;
    if (!agree(nodes[i], nodes[j], dx, dy)) return;
    tallies[i].votes += votes_for_i;
    tallies[j].votes += votes_for_j;
  });
  return tallies;
}

// As CountVotes, with each template keypoint counted once as a voter.
// @param voters  number of template keypoints
template <typename Agree>
std::vector<Tally> CountDistinctVotes(const std::vector<MatchNode>& nodes, const Grid& grid, std::size_t voters,
                                      const Agree& agree) {
  constexpr std::uint32_t kNoVoter = ~std::uint32_t{0};
  std::vector<std::uint32_t> counted_by(voters, kNoVoter);  // per voter: the last receiver within reach; then voted for
  std::vector<std::uint32_t> voted_for(voters, kNoVoter);
  std::vector<Tally> tallies(nodes.size());
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const MatchNode& receiver = nodes[i];
    grid.ForEachAround(receiver, [&](std::uint32_t j) {
      const MatchNode& voter = nodes[j];
      if (voted_for[voter.template_keypoint] == i) return;
      const double dx = voter.x - receiver.x;
      const double dy = voter.y - receiver.y;
      const double distance2 = dx * dx + dy * dy;
      if (distance2 == 0 || !(distance2 < receiver.radius2)) return;
      if (std::exchange(counted_by[voter.template_keypoint], i) != i) ++tallies[i].possible;
      if (!agree(receiver, voter, dx, dy)) return;
      voted_for[voter.template_keypoint] = i;
      ++tallies[i].votes;
    });
  }
  return tallies;
}

template <typename Agree>
void Stage(std::vector<MatchNode>& nodes, const CascadeOptions& options, double approval, bool distinct,
           std::size_t voters, const Agree& agree) {
  if (nodes.empty()) return;
  const double max_radius2 = std::ranges::max(nodes, {}, &MatchNode::radius2).radius2;
  const Grid grid(nodes, std::sqrt(max_radius2));
  const std::vector<Tally> tallies =
      distinct ? CountDistinctVotes(nodes, grid, voters, agree) : CountVotes(nodes, grid, agree);
  std::vector<MatchNode> kept;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (IsApproved(tallies[i], options.min_votes, approval)) kept.push_back(nodes[i]);
  }
  nodes = std::move(kept);
}

MatchSet SelectMatches(const std::vector<MatchNode>& nodes, const MatchSet& matches) {
  std::vector<std::uint32_t> order;
  order.reserve(nodes.size());
  for (const MatchNode& node : nodes) order.push_back(node.match);
  std::ranges::sort(order);
  MatchSet result;
  result.reserve(order.size());
  for (const std::uint32_t match : order) result.push_back(matches[match]);
  return result;
}

}  // namespace

CascadeResult FilterByGrammar(std::span<const Keypoint> scene, std::span<const Keypoint> template_keypoints,
                              const MatchSet& matches, const CascadeOptions& options) {
  if (options.filter == CascadeFilter::kNeighbours) {
    const MatchSet kept = FilterByNeighbours(scene, template_keypoints, matches, options.neighbours);
    return {kept, kept, kept};
  }
  const auto runs = [&](CascadeFilter stage) {
    return options.filter == CascadeFilter::kCascade || options.filter == stage;
  };
  std::vector<MatchNode> nodes = MakeNodes(scene, template_keypoints, matches, options);
  const auto stage = [&](CascadeFilter filter, double approval, bool distinct, const auto& agree) {
    if (runs(filter) && options.all_measures) {
      Stage(nodes, options, approval, distinct, template_keypoints.size(), AllAgree(options));
    } else if (runs(filter)) {
      Stage(nodes, options, approval, distinct, template_keypoints.size(), agree);
    }
    return SelectMatches(nodes, matches);
  };
  const ScalesAgree scales_agree(options);
  CascadeResult result;
  result.first = stage(CascadeFilter::kFirst, options.first_approval, options.distinct_stages >= 3, scales_agree);
  result.second =
      stage(CascadeFilter::kSecond, options.second_approval, options.distinct_stages >= 2, AnglesAgree(options));
  result.third = stage(CascadeFilter::kThird, options.third_approval, options.distinct_stages >= 1, scales_agree);
  return result;
}

}  // namespace victorious
