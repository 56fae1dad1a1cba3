#include "victorious/search/pose/pose_proposal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "victorious/base/binomial.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/robust/similarity_estimator.h"
#include "victorious/geometry/similarity.h"
#include "victorious/kernels/vote_agreement.h"
#include "victorious/search/pose/match_pairs.h"
#include "victorious/search/pose/rank_nfa.h"
#include "victorious/search/pose/vote_poses.h"
#include "victorious/search/pose/vote_windows.h"

namespace victorious {
namespace {

constexpr double kCell_px = 16;  // of KeypointDensity
// Bounds of the density relative to the mean: few keypoints say little about it.
constexpr double kMinDensity = 0.3;
constexpr double kMaxDensity = 5.0;
// The fraction of scene keypoints whose scale agrees with a pose within kVoteScaleFactor.
constexpr double kScaleAgreement = 0.35;
constexpr double kMinTurn_rad = 0.3;  // a narrower interval of orientations counts as this wide
constexpr double kMinExpectedVotes = 1e-3;
constexpr VoteOptions kVoteOptions;  // as the vote search by default
constexpr std::size_t kMinFitted = 3;
constexpr std::size_t kMinInliers = 4;
constexpr int kMaxProposalSeeds = 12;
// A vote this near to a seed is no seed of its own: fraction of the object's length, and difference of the log scale.
constexpr float kSeedDistance = 0.1F;
constexpr float kSeedLogScale = 0.3F;
// Windows in inlier radii: those before the first test widen the seed's own similarity, which one keypoint determines
// only roughly; the tested ones are those of VotePoses.
constexpr double kWideWindows[] = {3.0, 2.0};
constexpr double kTestedWindows[] = {1.0, 0.5, 0.25};
constexpr int kRefits = 2;
constexpr auto kSeparationScales = static_cast<float>(kVoteOptions.min_separation_scales);

constexpr auto kCircle_rad = static_cast<float>(2 * kPi);
constexpr auto kTurn_rad = static_cast<float>(kVoteOptions.turn_rad);

// The matches as votes, by rising log_scale: their keypoints, and the centres that they vote for. Padded for kernels.
struct Votes {
  std::vector<float> log_scale;
  std::vector<float> turn_rad;
  std::vector<float> centre_x;
  std::vector<float> centre_y;
  std::vector<float> template_x;
  std::vector<float> template_y;
  std::vector<float> scene_x;
  std::vector<float> scene_y;
  std::vector<std::uint32_t> match;

  explicit Votes(std::size_t count) : match(count) {
    for (std::vector<float>* const values :
         {&log_scale, &turn_rad, &centre_x, &centre_y, &template_x, &template_y, &scene_x, &scene_y}) {
      values->resize(count + kernels::kVotePadding);
    }
  }

  [[nodiscard]] std::size_t size() const { return match.size(); }
  [[nodiscard]] std::span<const float> log_scales() const { return std::span(log_scale).first(size()); }
};

struct Seed {
  double log_likelihood;
  std::size_t vote;
};

struct Inlier {
  float error2_px2;
  std::size_t vote;
};

// The chance that two keypoints of allowed orientation agree in rotation.
double TurnChance(double max_turn_rad) { return std::min(1.0, kTurn_rad / std::max(kMinTurn_rad, max_turn_rad)); }

class Proposer {
 public:
  Proposer(const FeatureSet& scene, const KeypointDensity& density, std::span<const Keypoint> model,
           std::span<const RankedMatch> matches, const Polygon& outline, double max_turn_rad,
           const std::optional<UprightPrior>& upright)
      : scene_(scene),
        density_(density),
        model_(model),
        matches_(matches),
        max_turn_rad_(max_turn_rad),
        upright_(upright),
        votes_(matches.size()) {
    const Box bounds = BoundingBox(outline);
    centre_ = {bounds.x + bounds.width / 2, bounds.y + bounds.height / 2};
    length_px_ = static_cast<float>(std::hypot(bounds.width, bounds.height));
    size_px_ = std::sqrt(std::abs(SignedArea(outline)));
    area_px2_ = std::max(1.0, scene.SearchedBox().Area());
    turn_chance_ = TurnChance(max_turn_rad);
    CollectVotes();
    near_.resize(votes_.size() + kernels::kVotePadding);
    near_error2_px2_.resize(near_.size());
  }

  std::optional<PoseProposal> Propose() {
    std::optional<PoseProposal> best;
    std::vector<std::uint8_t> used(votes_.size());
    int seeds_left = kMaxProposalSeeds;
    for (const Seed& seed : SortedSeeds()) {
      if (used[seed.vote] != 0 || !IsAllowed(seed.vote)) continue;
      if (seeds_left-- == 0) break;
      MarkNear(seed.vote, used);
      std::optional<PoseProposal> proposal = ProposeFrom(seed.vote);
      if (proposal && (!best || proposal->neg_log10_nfa > best->neg_log10_nfa)) best = std::move(proposal);
    }
    return best;
  }

 private:
  [[nodiscard]] bool IsAllowed(std::size_t vote) const {
    return !upright_ || upright_->IsAllowed({votes_.centre_x[vote], votes_.centre_y[vote]}, votes_.turn_rad[vote]);
  }

  void CollectVotes() {
    std::vector<std::uint64_t> order;  // ratio of scales (the bits of a positive float rise with its value), match
    order.reserve(matches_.size());
    for (std::uint32_t i = 0; i < matches_.size(); ++i) {
      const float scale =
          scene_.keypoints[matches_[i].scene_keypoint].scale_px / model_[matches_[i].template_keypoint].scale_px;
      order.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(scale)} << 32 | i);
    }
    std::ranges::sort(order);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto i = static_cast<std::uint32_t>(order[k]);
      const Keypoint& s = scene_.keypoints[matches_[i].scene_keypoint];
      const Keypoint& m = model_[matches_[i].template_keypoint];
      const float scale = s.scale_px / m.scale_px;
      float turn_rad = s.orientation_rad - m.orientation_rad;
      if (turn_rad > kCircle_rad / 2) turn_rad -= kCircle_rad;
      if (turn_rad < -kCircle_rad / 2) turn_rad += kCircle_rad;
      const float c = scale * std::cos(turn_rad);
      const float d = scale * std::sin(turn_rad);
      const float x = static_cast<float>(centre_.x()) - m.x;
      const float y = static_cast<float>(centre_.y()) - m.y;
      votes_.log_scale[k] = std::log(scale);
      votes_.turn_rad[k] = turn_rad;
      votes_.centre_x[k] = s.x + c * x - d * y;
      votes_.centre_y[k] = s.y + d * x + c * y;
      votes_.template_x[k] = m.x;
      votes_.template_y[k] = m.y;
      votes_.scene_x[k] = s.x;
      votes_.scene_y[k] = s.y;
      votes_.match[k] = i;
    }
  }

  // Votes that at least kVoteOptions.min_votes support, by falling log-likelihood ratio.
  [[nodiscard]] std::vector<Seed> SortedSeeds() const {
    const std::vector<kernels::VoteWindow> windows =
        ComputeVoteWindows(votes_.log_scales(), static_cast<float>(std::log(kVoteScaleFactor)),
                           static_cast<float>(kCentreFraction) * length_px_);
    std::vector<std::int32_t> counts(votes_.size());
    kernels::CountAgreeingVotes({votes_.centre_x.data(), votes_.centre_y.data(), votes_.turn_rad.data()}, windows,
                                kTurn_rad, counts);
    std::vector<Seed> seeds;
    for (std::size_t i = 0; i < votes_.size(); ++i) {
      const int count = counts[i];
      if (count < kVoteOptions.min_votes) continue;
      const double chance = std::min(1.0, kPi * windows[i].reach2_px2 / area_px2_) * turn_chance_;
      const double expected = std::max(kMinExpectedVotes, (windows[i].end - windows[i].begin) * chance);
      if (count <= expected) continue;
      seeds.push_back({count * std::log(count / expected) - (count - expected), i});
    }
    std::ranges::sort(seeds, [](const Seed& a, const Seed& b) {
      return a.log_likelihood != b.log_likelihood ? a.log_likelihood > b.log_likelihood : a.vote < b.vote;
    });
    return seeds;
  }

  void MarkNear(std::size_t seed, std::vector<std::uint8_t>& used) const {
    const float seed_x = votes_.centre_x[seed];
    const float seed_y = votes_.centre_y[seed];
    const float seed_log_scale = votes_.log_scale[seed];
    const float reach = kSeedDistance * length_px_ * std::exp(seed_log_scale);
    for (std::size_t j = 0; j < votes_.size(); ++j) {
      const float dx = votes_.centre_x[j] - seed_x;
      const float dy = votes_.centre_y[j] - seed_y;
      const float difference = std::abs(votes_.log_scale[j] - seed_log_scale);
      used[j] |= static_cast<std::uint8_t>(static_cast<int>(dx * dx + dy * dy < reach * reach) &
                                           static_cast<int>(difference < kSeedLogScale));  // no branches: vectorised
    }
  }

  [[nodiscard]] std::optional<PoseProposal> ProposeFrom(std::size_t seed) {
    Similarity2 map{std::exp(static_cast<double>(votes_.log_scale[seed])), votes_.turn_rad[seed],
                    Eigen::Vector2d::Zero()};
    map.translation = Eigen::Vector2d(votes_.scene_x[seed], votes_.scene_y[seed]) -
                      map.Linear() * Eigen::Vector2d(votes_.template_x[seed], votes_.template_y[seed]);
    for (const double factor : kWideWindows) {
      if (!Refit(factor, map)) return std::nullopt;
    }
    std::optional<PoseProposal> best;
    for (const double factor : kTestedWindows) {
      for (int round = 0; round < kRefits; ++round) {
        if (!Refit(factor, map)) return best;
      }
      const std::span<const Inlier> inliers = GatherInliers(map, factor * RadiusPx(map));
      if (inliers.size() < kMinInliers) return best;
      PoseProposal proposal = Test(map, inliers, factor * RadiusPx(map));
      if (!best || proposal.neg_log10_nfa > best->neg_log10_nfa) best = std::move(proposal);
    }
    return best;
  }

  [[nodiscard]] PoseProposal Test(const Similarity2& map, std::span<const Inlier> inliers, double radius_px) const {
    const Eigen::Vector2d centre = map.Apply(centre_);
    const double density =
        std::clamp(density_.Around(centre.x(), centre.y(), 0.5 * length_px_ * map.scale), kMinDensity, kMaxDensity);
    PoseProposal proposal{
        .neg_log10_nfa = 0,
        .centre_px = centre,
        .size_px = size_px_ * map.scale,
        .inliers = {},
        .agreeing_fraction = std::min(1.0, kPi * radius_px * radius_px / area_px2_) * kScaleAgreement * density,
        .log10_pose_count = Log10PoseCount(map, radius_px, size_px_, scene_),
        .template_keypoints = model_.size()};
    for (const Inlier& inlier : inliers) proposal.inliers.push_back(MatchOf(inlier));
    proposal.neg_log10_nfa = NegLog10NfaOfRanks(proposal, scene_, proposal.inliers, max_turn_rad_);
    return proposal;
  }

  // Refits to the inliers of a window; false if there are too few.
  [[nodiscard]] bool Refit(double factor, Similarity2& map) {
    const std::span<const Inlier> inliers = GatherInliers(map, factor * RadiusPx(map));
    if (inliers.size() < kMinFitted) return false;
    pairs_.clear();
    for (const Inlier& inlier : inliers) {
      const std::size_t vote = inlier.vote;
      pairs_.push_back(
          {{votes_.template_x[vote], votes_.template_y[vote]}, {votes_.scene_x[vote], votes_.scene_y[vote]}});
    }
    const std::optional<Similarity2> fitted = SolveSimilarity(pairs_);
    if (!fitted || fitted->scale <= 0) return false;
    map = *fitted;
    return true;
  }

  [[nodiscard]] double RadiusPx(const Similarity2& map) const {
    return kAgreementSigmas *
           SimilarityEstimator({}, {.noise_px = kKeypointNoise_px, .shape_px = kShapeFraction * size_px_}).SigmaPx(map);
  }

  // The votes that agree in position, scale and rotation, one-to-one by rising error. Valid until the next call.
  [[nodiscard]] std::span<const Inlier> GatherInliers(const Similarity2& map, double radius_px) {
    const auto log_scale = static_cast<float>(std::log(map.scale));
    const auto turn_rad = static_cast<float>(map.rotation_rad);
    const auto max_log = static_cast<float>(std::log(kVoteScaleFactor));
    const std::span<const float> sorted = votes_.log_scales();
    const auto begin = std::ranges::lower_bound(sorted, log_scale - max_log) - sorted.begin();
    const auto end = std::ranges::upper_bound(sorted, log_scale + max_log) - sorted.begin();
    const std::size_t count = kernels::FindAgreeingPairs(
        {votes_.template_x.data(), votes_.template_y.data(), votes_.scene_x.data(), votes_.scene_y.data()},
        static_cast<std::size_t>(begin), static_cast<std::size_t>(end),
        {.a = static_cast<float>(map.scale * std::cos(map.rotation_rad)),
         .b = static_cast<float>(map.scale * std::sin(map.rotation_rad)),
         .shift_x = static_cast<float>(map.translation.x()),
         .shift_y = static_cast<float>(map.translation.y())},
        static_cast<float>(radius_px * radius_px), near_.data(), near_error2_px2_.data());
    agreeing_.clear();
    for (std::size_t k = 0; k < count; ++k) {
      if (AngleBetween(votes_.turn_rad[near_[k]], turn_rad) <= kTurn_rad)
        agreeing_.push_back({near_error2_px2_[k], near_[k]});
    }
    std::ranges::sort(agreeing_, [](const Inlier& a, const Inlier& b) {
      return a.error2_px2 != b.error2_px2 ? a.error2_px2 < b.error2_px2 : a.vote < b.vote;
    });
    inliers_.clear();
    for (const Inlier& one : agreeing_) {
      const RankedMatch& match = MatchOf(one);
      const bool taken = std::ranges::any_of(inliers_, [&](const Inlier& other) {
        return MatchOf(other).template_keypoint == match.template_keypoint ||
               MatchOf(other).scene_keypoint == match.scene_keypoint;
      });
      if (!taken) inliers_.push_back(one);
    }
    return inliers_;
  }

  [[nodiscard]] const RankedMatch& MatchOf(const Inlier& inlier) const { return matches_[votes_.match[inlier.vote]]; }

  const FeatureSet& scene_;
  const KeypointDensity& density_;
  std::span<const Keypoint> model_;
  std::span<const RankedMatch> matches_;
  double max_turn_rad_;
  const std::optional<UprightPrior>& upright_;
  Eigen::Vector2d centre_;
  float length_px_ = 0;
  double size_px_ = 0;
  double area_px2_ = 1;
  double turn_chance_ = 1;  // of two allowed rotations to agree
  Votes votes_;
  // Memory of GatherInliers and Refit.
  std::vector<std::uint32_t> near_;  // of FindAgreeingPairs
  std::vector<float> near_error2_px2_;
  std::vector<Inlier> agreeing_;
  std::vector<Inlier> inliers_;
  std::vector<PointPair> pairs_;
};

}  // namespace

KeypointDensity::KeypointDensity(const FeatureSet& scene)
    : columns_(std::max(1, static_cast<int>(std::ceil(scene.image_width / kCell_px)))),
      rows_(std::max(1, static_cast<int>(std::ceil(scene.image_height / kCell_px)))),
      sums_(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1)) {
  const std::size_t width = static_cast<std::size_t>(columns_) + 1;
  for (const Keypoint& keypoint : scene.keypoints) {
    const auto column = static_cast<std::size_t>(std::clamp(keypoint.x / kCell_px, 0.0, columns_ - 1.0));
    const auto row = static_cast<std::size_t>(std::clamp(keypoint.y / kCell_px, 0.0, rows_ - 1.0));
    ++sums_[(row + 1) * width + column + 1];
  }
  for (std::size_t i = width; i < sums_.size(); ++i) {
    if (i % width == 0) continue;
    sums_[i] += sums_[i - 1] + sums_[i - width] - sums_[i - width - 1];
  }
}

double KeypointDensity::Around(double x, double y, double half_side_px) const {
  const auto first = [&](double place, int count) {
    return static_cast<std::size_t>(std::clamp(std::floor((place - half_side_px) / kCell_px), 0.0, count - 1.0));
  };
  const auto last = [&](double place, int count, std::size_t from) {
    return static_cast<std::size_t>(
        std::clamp(std::floor((place + half_side_px) / kCell_px) + 1, static_cast<double>(from) + 1, 1.0 * count));
  };
  const std::size_t width = static_cast<std::size_t>(columns_) + 1;
  const std::size_t left = first(x, columns_);
  const std::size_t right = last(x, columns_, left);
  const std::size_t top = first(y, rows_);
  const std::size_t bottom = last(y, rows_, top);
  const double count = sums_[bottom * width + right] - sums_[top * width + right] - sums_[bottom * width + left] +
                       sums_[top * width + left];
  const double mean = sums_.back() / (columns_ * rows_);
  return mean > 0 ? count / static_cast<double>((right - left) * (bottom - top)) / mean : 1;
}

std::optional<PoseProposal> ProposePose(const FeatureSet& scene, const KeypointDensity& density,
                                        std::span<const Keypoint> template_keypoints,
                                        std::span<const RankedMatch> matches, const Polygon& outline,
                                        double max_turn_rad, const std::optional<UprightPrior>& upright) {
  if (outline.size() < 3 || matches.size() < kMinInliers) return std::nullopt;
  return Proposer(scene, density, template_keypoints, matches, outline, max_turn_rad, upright).Propose();
}

double NegLog10NfaOfRanks(const PoseProposal& proposal, const FeatureSet& scene, std::vector<RankedMatch> inliers,
                          double max_turn_rad) {
  const double chance = proposal.agreeing_fraction * TurnChance(max_turn_rad);
  std::ranges::stable_sort(inliers, {}, &RankedMatch::rank);
  const auto n = static_cast<double>(proposal.template_keypoints);
  std::vector<const Keypoint*> independent;
  double min_log = 0;  // of C(n, k) p_k^k
  for (const RankedMatch& inlier : inliers) {
    const Keypoint& keypoint = scene.keypoints[inlier.scene_keypoint];
    const bool is_dependent = std::ranges::any_of(independent, [&](const Keypoint* other) {
      return std::hypot(keypoint.x - other->x, keypoint.y - other->y) <
             kSeparationScales * std::max(keypoint.scale_px, other->scale_px);
    });
    if (is_dependent) continue;
    independent.push_back(&keypoint);
    const auto k = static_cast<double>(independent.size());
    min_log = std::min(min_log, LogChoose(n, k) + k * std::log(std::min(1.0, inlier.rank * chance)));
  }
  return -min_log / std::log(10.0) - proposal.log10_pose_count - kDependenceDecades;
}

}  // namespace victorious
