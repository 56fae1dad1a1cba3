#include "victorious/search/pose/vote_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"
#include "victorious/kernels/vote_agreement.h"
#include "victorious/search/pose/match_pairs.h"
#include "victorious/search/pose/plane_refinement.h"
#include "victorious/search/pose/rank_nfa.h"
#include "victorious/search/pose/vote_windows.h"

namespace victorious {

namespace {

// The inlier windows that are tried, in parts of the inlier radius: the smaller the viewpoint difference, the smaller
// the best window (docs/adr/0008).
constexpr double kWindowFactors[] = {1.0, 0.5, 0.25};
// Refits per window: a second one changes few inliers.
constexpr int kRefits = 2;
// The expected chance votes of an empty window: bounds the likelihood ratio.
constexpr double kMinExpectedVotes = 1e-6;

// The votes as a structure of arrays, sorted by log_scale.
struct CollectedVotes {
  std::vector<float> log_scale;
  std::vector<float> turn_rad;       // padded for kernels, as the next two
  std::vector<float> x;              // object centre in the scene, px
  std::vector<float> y;              // px
  std::vector<std::uint32_t> match;  // index into the matches

  [[nodiscard]] std::size_t size() const { return match.size(); }
};

struct Vote {
  float log_scale;
  float turn_rad;
  float x;
  float y;
  std::uint32_t match;
};

Vote MakeVote(const Keypoint& scene, const Keypoint& model, const Eigen::Vector2d& centre, std::uint32_t match) {
  const Similarity2 similarity{static_cast<double>(scene.scale_px) / model.scale_px,
                               WrapAngle(static_cast<double>(scene.orientation_rad) - model.orientation_rad),
                               {scene.x, scene.y}};
  const Eigen::Vector2d place = similarity.Apply(centre - Eigen::Vector2d(model.x, model.y));
  return {static_cast<float>(std::log(similarity.scale)), static_cast<float>(similarity.rotation_rad),
          static_cast<float>(place.x()), static_cast<float>(place.y()), match};
}

CollectedVotes CollectVotes(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                            std::span<const RankedMatch> matches, const Eigen::Vector2d& centre,
                            const std::optional<UprightPrior>& upright) {
  std::vector<Vote> order;
  order.reserve(matches.size());
  for (std::uint32_t i = 0; i < matches.size(); ++i) {
    const Vote vote = MakeVote(scene[matches[i].scene_keypoint], model[matches[i].template_keypoint], centre, i);
    if (!upright || upright->IsAllowed({vote.x, vote.y}, vote.turn_rad)) order.push_back(vote);
  }
  std::ranges::stable_sort(order, {}, &Vote::log_scale);
  CollectedVotes votes;
  for (const Vote& vote : order) {
    votes.log_scale.push_back(vote.log_scale);
    votes.turn_rad.push_back(vote.turn_rad);
    votes.x.push_back(vote.x);
    votes.y.push_back(vote.y);
    votes.match.push_back(vote.match);
  }
  for (std::vector<float>* const values : {&votes.turn_rad, &votes.x, &votes.y}) {
    values->resize(values->size() + kernels::kVotePadding);
  }
  return votes;
}

// 1 if two votes agree, else 0: as CountAgreeingVotes.
inline int Agree(const CollectedVotes& votes, std::size_t a, std::size_t b, float reach2_px2, float turn_rad) {
  const float dx = votes.x[a] - votes.x[b];
  const float dy = votes.y[a] - votes.y[b];
  const float difference = std::abs(votes.turn_rad[a] - votes.turn_rad[b]);
  const float turn = std::min(difference, static_cast<float>(2 * kPi) - difference);
  return static_cast<int>(dx * dx + dy * dy < reach2_px2) & static_cast<int>(turn < turn_rad);
}

struct Support {
  int votes = 0;
  double log_likelihood = 0;  ///< Poisson log-likelihood ratio of the count over chance; 0 if chance explains it
};

std::vector<Support> ComputeSupport(const CollectedVotes& votes, const std::vector<kernels::VoteWindow>& windows,
                                    float turn_rad, double scene_area_px2) {
  std::vector<std::int32_t> counts(votes.size());
  kernels::CountAgreeingVotes({votes.x.data(), votes.y.data(), votes.turn_rad.data()}, windows, turn_rad, counts);
  std::vector<Support> all(votes.size());
  for (std::size_t i = 0; i < votes.size(); ++i) {
    const kernels::VoteWindow& window = windows[i];
    const int count = counts[i];
    const double chance = std::min(1.0, kPi * window.reach2_px2 / scene_area_px2) * std::min(1.0, turn_rad / kPi);
    const double expected = std::max(kMinExpectedVotes, static_cast<double>(window.end - window.begin) * chance);
    all[i] = {count, count > expected ? count * std::log(count / expected) - (count - expected) : 0};
  }
  return all;
}

// The positions of the keypoints of all matches as padded arrays, for a first test in single precision.
class MatchPositions {
 public:
  MatchPositions(std::span<const Keypoint> scene, std::span<const Keypoint> model, std::span<const RankedMatch> matches)
      : count_(matches.size()), found_(count_ + kernels::kVotePadding), error2_px2_(found_.size()) {
    for (std::vector<float>& values : values_) values.resize(found_.size());
    for (std::size_t i = 0; i < count_; ++i) {
      const Keypoint& s = scene[matches[i].scene_keypoint];
      const Keypoint& m = model[matches[i].template_keypoint];
      values_[0][i] = m.x;
      values_[1][i] = m.y;
      values_[2][i] = s.x;
      values_[3][i] = s.y;
    }
  }

  // Indices of matches, ascending: all that the map takes to within radius_px of the scene keypoint, and some more.
  std::span<const std::uint32_t> Near(const Similarity2& scene_from_template, double radius_px) {
    constexpr double kRounding_px = 0.1;  // of single precision, for coordinates up to 10^5 px
    const Eigen::Matrix2d linear = scene_from_template.Linear();
    const std::size_t count = kernels::FindAgreeingPairs(
        {values_[0].data(), values_[1].data(), values_[2].data(), values_[3].data()}, 0, count_,
        {.a = static_cast<float>(linear(0, 0)),
         .b = static_cast<float>(linear(1, 0)),
         .shift_x = static_cast<float>(scene_from_template.translation.x()),
         .shift_y = static_cast<float>(scene_from_template.translation.y())},
        static_cast<float>((radius_px + kRounding_px) * (radius_px + kRounding_px)), found_.data(), error2_px2_.data());
    return std::span(found_).first(count);
  }

 private:
  std::size_t count_;
  std::array<std::vector<float>, 4> values_;  // x and y in the template, x and y in the scene, px
  std::vector<std::uint32_t> found_;
  std::vector<float> error2_px2_;
};

// The matches that agree with the pose in position, scale and rotation, one-to-one: each scene and each template
// keypoint only in its match of the smallest residual. By rising residual.
// @param positions  of the matches
std::vector<RankedMatch> GatherInliers(const Similarity2& scene_from_template, double radius_px,
                                       std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                       std::span<const RankedMatch> matches, MatchPositions& positions,
                                       const VoteOptions& options) {
  std::vector<std::pair<double, RankedMatch>> near;
  const double max_log = std::log(kVoteScaleFactor);
  const Eigen::Matrix2d linear = scene_from_template.Linear();
  for (const std::uint32_t i : positions.Near(scene_from_template, radius_px)) {
    const RankedMatch& match = matches[i];
    const Keypoint& s = scene[match.scene_keypoint];
    const Keypoint& m = model[match.template_keypoint];
    const Eigen::Vector2d error =
        linear * Eigen::Vector2d(m.x, m.y) + scene_from_template.translation - Eigen::Vector2d(s.x, s.y);
    if (error.squaredNorm() > radius_px * radius_px) continue;
    if (std::abs(std::log(s.scale_px / (m.scale_px * scene_from_template.scale))) > max_log) continue;
    if (std::abs(WrapAngle(s.orientation_rad - m.orientation_rad - scene_from_template.rotation_rad)) >
        options.turn_rad)
      continue;
    near.emplace_back(error.squaredNorm(), match);
  }
  std::ranges::stable_sort(near, {}, &std::pair<double, RankedMatch>::first);
  std::vector<RankedMatch> kept;
  for (const auto& [error2, match] : near) {
    const bool taken = std::ranges::any_of(kept, [&](const RankedMatch& other) {
      return other.template_keypoint == match.template_keypoint || other.scene_keypoint == match.scene_keypoint;
    });
    if (!taken) kept.push_back(match);
  }
  return kept;
}

// Searches one template in one scene.
class PoseFinder {
 public:
  PoseFinder(const FeatureSet& scene, std::span<const Keypoint> model, std::span<const RankedMatch> matches,
             const Polygon& outline, const VoteOptions& votes, const PoseOptions& options,
             const std::optional<UprightPrior>& upright, std::span<const Point3> points_in_model)
      : scene_(scene),
        model_(model),
        matches_(matches),
        outline_(outline),
        votes_(votes),
        options_(options),
        upright_(upright),
        points_in_model_(points_in_model),
        positions_(scene.keypoints, model, matches),
        size_px_(std::sqrt(std::abs(SignedArea(outline)))),
        scene_area_px2_(std::max(1.0, scene.SearchedBox().Area())) {}

  std::vector<PlanarFit> Find() {
    const Box bounds = BoundingBox(outline_);
    const Eigen::Vector2d centre(bounds.x + bounds.width / 2, bounds.y + bounds.height / 2);
    const CollectedVotes votes = CollectVotes(scene_.keypoints, model_, matches_, centre, upright_);
    const float turn_rad = static_cast<float>(votes_.turn_rad);
    const std::vector<kernels::VoteWindow> windows =
        ComputeVoteWindows(votes.log_scale, static_cast<float>(std::log(kVoteScaleFactor)),
                           static_cast<float>(kCentreFraction * std::hypot(bounds.width, bounds.height)));
    const std::vector<Support> support = ComputeSupport(votes, windows, turn_rad, scene_area_px2_);
    std::vector<bool> used(votes.size());
    std::vector<PlanarFit> fits;
    // A seed without a pose counts, too: replacing it would cost a third of the time, mostly for chance poses
    // (docs/adr/0008).
    int seeds_left = kMaxSeeds;
    while (seeds_left > 0) {
      const std::optional<std::size_t> seed = BestSeed(support, used);
      if (!seed) break;
      const kernels::VoteWindow& window = windows[*seed];
      std::vector<std::uint32_t> members;
      for (std::size_t j = window.begin; j < window.end; ++j) {
        if (Agree(votes, *seed, j, window.reach2_px2, turn_rad) == 0) continue;
        used[j] = true;
        members.push_back(votes.match[j]);
      }
      auto fit = FitPose(std::move(members), window.reach2_px2);
      if (!fit || *fit->neg_log10_nfa < kInstanceNegLog10Nfa) --seeds_left;
      if (!fit) continue;
      if (options_.refine_plane && *fit->neg_log10_nfa > 0) RefineOutline(*fit);
      fits.push_back(std::move(*fit));
    }
    std::ranges::stable_sort(fits, std::greater{}, [](const PlanarFit& fit) { return *fit.neg_log10_nfa; });
    return fits;
  }

 private:
  std::optional<std::size_t> BestSeed(const std::vector<Support>& support, const std::vector<bool>& used) const {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < support.size(); ++i) {
      // Upper bound: several votes may come from one template keypoint; FitPose counts the distinct ones.
      if (used[i] || support[i].votes < votes_.min_votes) continue;
      if (!best || support[i].log_likelihood > support[*best].log_likelihood) best = i;
    }
    return best;
  }

  // Fits a similarity to the voters of a seed by MLESAC and refines it. std::nullopt if there are too few distinct
  // template keypoints or inliers.
  std::optional<PlanarFit> FitPose(std::vector<std::uint32_t> members, double reach2_px2) {
    std::ranges::sort(members);
    std::vector<RankedMatch> voters;
    for (const std::uint32_t member : members) voters.push_back(matches_[member]);
    if (CountTemplateKeypoints(voters) < static_cast<std::size_t>(votes_.min_votes)) return std::nullopt;
    const std::vector<PointPair> pairs = MakePointPairs(scene_.keypoints, model_, voters);
    const auto agreed = Mlesac(SimilarityEstimator(pairs, Noise()), {.outlier_area_px2 = kPi * reach2_px2,
                                                                     .confidence = kPoseConfidence,
                                                                     .max_hypotheses = kMaxPoseHypotheses,
                                                                     .seed = options_.seed});
    if (!agreed) return std::nullopt;
    return BestOverWindows(agreed->model);
  }

  // Refits with windows of 1, 1/2 and 1/4 of the inlier radius and returns the pose of the highest -log10 NFA: the
  // smaller the viewpoint difference, the smaller the best window.
  std::optional<PlanarFit> BestOverWindows(Similarity2 map) {
    std::optional<PlanarFit> best;
    for (const double window_factor : kWindowFactors) {
      std::vector<RankedMatch> inliers = InliersOf(map, window_factor);
      for (int round = 0; round < kRefits; ++round) {
        const auto refined = SolveSimilarity(MakePointPairs(scene_.keypoints, model_, inliers));
        if (!refined) return best;
        map = *refined;
        inliers = InliersOf(map, window_factor);
      }
      if (inliers.size() < static_cast<std::size_t>(options_.min_inliers)) return best;
      PlanarFit fit = MakePose(map, inliers, window_factor);
      if (!best || *fit.neg_log10_nfa > *best->neg_log10_nfa) best = std::move(fit);
    }
    return best;
  }

  PlanarFit MakePose(const Similarity2& map, std::span<const RankedMatch> inliers, double window_factor) const {
    PlanarFit fit;
    fit.scene_from_template = map;
    fit.sigma_px = window_factor * SigmaPx(map);
    fit.distinct_inliers = inliers.size();
    fit.inliers = MakeFitInliers(model_, points_in_model_, inliers);
    fit.extent = Extent(MakePointPairs(scene_.keypoints, model_, inliers), outline_);
    fit.neg_log10_nfa =
        ComputeRankNegLog10Nfa(map, inliers, {.radius_px = window_factor * RadiusPx(map), .widest_px = RadiusPx(map)},
                               size_px_, scene_, model_, votes_) +
        (upright_ ? upright_->SearchReductionDecades() : 0);
    fit.scene_from_template_plane = map.Matrix();
    return fit;
  }

  void RefineOutline(PlanarFit& fit) const {
    const std::vector<PointPair> pairs = MakePointPairs(scene_.keypoints, fit.inliers);
    const double noise_px = kKeypointNoise_px * std::max(1.0, fit.scene_from_template.scale);
    fit.scene_from_template_plane =
        RefinePlane(pairs, fit.scene_from_template, fit.sigma_px, noise_px, scene_area_px2_, outline_);
  }

  SimilarityEstimator::Noise Noise() const {
    return {.noise_px = kKeypointNoise_px, .shape_px = kShapeFraction * size_px_};
  }

  double SigmaPx(const Similarity2& map) const { return SimilarityEstimator({}, Noise()).SigmaPx(map); }

  double RadiusPx(const Similarity2& map) const { return kAgreementSigmas * SigmaPx(map); }

  std::vector<RankedMatch> InliersOf(const Similarity2& map, double window_factor) {
    return GatherInliers(map, window_factor * RadiusPx(map), scene_.keypoints, model_, matches_, positions_, votes_);
  }

  const FeatureSet& scene_;
  std::span<const Keypoint> model_;
  std::span<const RankedMatch> matches_;
  const Polygon& outline_;
  const VoteOptions& votes_;
  const PoseOptions& options_;
  const std::optional<UprightPrior>& upright_;
  std::span<const Point3> points_in_model_;
  MatchPositions positions_;
  double size_px_;
  double scene_area_px2_;
};

}  // namespace

std::vector<PlanarFit> VotePoses(const FeatureSet& scene, std::span<const Keypoint> model,
                                 std::span<const RankedMatch> matches, const Polygon& outline, const VoteOptions& votes,
                                 const PoseOptions& options, const std::optional<UprightPrior>& upright,
                                 std::span<const Point3> points_in_model) {
  if (outline.size() < 3 || matches.size() < static_cast<std::size_t>(votes.min_votes)) return {};
  return PoseFinder(scene, model, matches, outline, votes, options, upright, points_in_model).Find();
}

}  // namespace victorious
