// MLESAC: robust estimation by random sampling; the score of a hypothesis is its likelihood, so that there is no hard
// inlier threshold. Source: P. Torr and A. Zisserman, "MLESAC: a new robust estimator with application to estimating
// image geometry", CVIU 78, 2000.
//
// A residual r of dimension 2 is drawn from a mixture: with probability gamma from a normal distribution with standard
// deviation sigma, else uniformly over an area. Expectation maximisation (EM) finds gamma for each hypothesis, and the
// hypothesis with the largest likelihood wins. It is then refined by EM over the model too (weighted least squares with
// the posterior probabilities). Deterministic for a given seed. Small problems are searched exhaustively.
//
// An estimator is a small class with
//   using Model;
//   static constexpr std::size_t kSampleSize;                           // minimal sample
//   std::size_t size() const;                                           // number of data
//   std::optional<Model> FromSample(span<const uint32_t>) const;        // std::nullopt for a degenerate sample
//   void SquaredResiduals(const Model&, span<double> out) const;        // px^2, one per datum
//   double SigmaPx(const Model&) const;                                 // sigma of inliers under this model
//   std::optional<Model> FromWeights(span<const double>) const;         // weighted least squares over all data
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/random.h"
#include "victorious/geometry/robust/sample_count.h"

namespace victorious {

template <typename E>
concept MlesacEstimator =
    requires(const E& estimator, const typename E::Model& model, std::span<const std::uint32_t> sample,
             std::span<const double> weights, std::span<double> out) {
      { E::kSampleSize } -> std::convertible_to<std::size_t>;
      { estimator.size() } -> std::same_as<std::size_t>;
      { estimator.FromSample(sample) } -> std::same_as<std::optional<typename E::Model>>;
      { estimator.SquaredResiduals(model, out) } -> std::same_as<void>;
      { estimator.SigmaPx(model) } -> std::same_as<double>;
      { estimator.FromWeights(weights) } -> std::same_as<std::optional<typename E::Model>>;
    };

struct MlesacOptions {
  double outlier_area_px2 = 1e6;  ///< area over which outliers are uniform, usually that of the searched image
  double confidence = 0.999;      ///< stop when an outlier-free sample has been drawn with this probability
  int max_hypotheses = 500;
  int refinements = 5;  ///< EM rounds after the search
  std::uint64_t seed = 1;
};

template <typename Model>
struct MlesacResult {
  Model model;
  double gamma = 0;                   ///< the fraction of inliers, by EM
  double log_likelihood = 0;          ///< of the data, under the mixture with the best gamma
  std::vector<double> probabilities;  ///< posterior probability of each datum to be an inlier
  int hypotheses = 0;                 ///< number of hypotheses tried
};

namespace internal {

struct MixtureFit {
  double gamma;
  double log_likelihood;
};

// Fits gamma by EM.
// @param ratios  from LikelihoodRatios
inline MixtureFit FitMixture(std::span<const double> ratios, double log_outlier_density) {
  constexpr int kRounds = 4;
  double gamma = 0.5;
  const double count = static_cast<double>(ratios.size());
  for (int round = 0; round < kRounds; ++round) {
    double posterior = 0;
    for (const double ratio : ratios) posterior += gamma * ratio / (gamma * ratio + (1 - gamma));
    gamma = std::clamp(posterior / count, 1e-3, 1 - 1e-3);
  }
  // Sums the logarithms as the logarithm of products, in blocks that cannot overflow.
  double log_likelihood = count * log_outlier_density;
  double product = 1;
  for (const double ratio : ratios) {
    product *= gamma * ratio + (1 - gamma);
    if (product > 1e200 || product < 1e-200) {
      log_likelihood += std::log(product);
      product = 1;
    }
  }
  return {gamma, log_likelihood + std::log(product)};
}

// Each datum's density as an inlier divided by its density as an outlier.
inline void LikelihoodRatios(std::span<const double> squared_residuals, double sigma, double outlier_area,
                             std::span<double> ratios) {
  const double peak = outlier_area / (2 * std::numbers::pi * sigma * sigma);
  const double factor = -0.5 / (sigma * sigma);
  for (std::size_t i = 0; i < ratios.size(); ++i)
    ratios[i] = peak * std::exp(std::max(-60.0, factor * squared_residuals[i]));
}

}  // namespace internal

/// Estimates the model.
/// @return std::nullopt if there are fewer data than a sample needs, or every sample is degenerate
template <MlesacEstimator Estimator>
std::optional<MlesacResult<typename Estimator::Model>> Mlesac(const Estimator& estimator,
                                                              const MlesacOptions& settings) {
  using Model = typename Estimator::Model;
  constexpr std::size_t kSample = Estimator::kSampleSize;
  const std::size_t count = estimator.size();
  if (count < kSample) return std::nullopt;

  std::vector<double> squared(count);
  std::vector<double> ratios(count);
  std::optional<MlesacResult<Model>> best;
  const double log_outlier_density = -std::log(settings.outlier_area_px2);

  const auto evaluate = [&](const Model& model, double sigma_px) {
    estimator.SquaredResiduals(model, squared);
    internal::LikelihoodRatios(squared, sigma_px, settings.outlier_area_px2, ratios);
    return internal::FitMixture(ratios, log_outlier_density);
  };
  const auto keep = [&](const Model& model, const internal::MixtureFit& fit) {
    best->model = model;
    best->gamma = fit.gamma;
    best->log_likelihood = fit.log_likelihood;
  };
  const auto keep_if_better = [&](const std::optional<Model>& model) {
    if (!model) return false;
    const internal::MixtureFit fit = evaluate(*model, estimator.SigmaPx(*model));
    if (best && !(fit.log_likelihood > best->log_likelihood)) return false;
    if (!best) best.emplace();
    keep(*model, fit);
    return true;
  };

  // Enumerate all samples if they are few; else draw samples until a better one is unlikely to have been missed.
  double combinations = 1;
  for (std::size_t k = 0; k < kSample; ++k) combinations *= static_cast<double>(count - k) / static_cast<double>(k + 1);
  constexpr double kMaxExhaustive = 64;
  const bool exhaustive = combinations <= std::min<double>(kMaxExhaustive, settings.max_hypotheses);
  std::array<std::uint32_t, kSample> sample;
  std::iota(sample.begin(), sample.end(), 0U);
  Random random(settings.seed);
  int needed = settings.max_hypotheses;
  int tried = 0;
  for (; tried < needed; ++tried) {
    if (exhaustive) {
      if (tried > 0) {
        // The next combination in lexicographic order.
        std::size_t k = kSample;
        while (k > 0 && sample[k - 1] == count - kSample + k - 1) --k;
        if (k == 0) break;
        ++sample[k - 1];
        for (; k < kSample; ++k) sample[k] = sample[k - 1] + 1;
      }
    } else {
      for (std::size_t k = 0; k < kSample;) {
        sample[k] = random.Below(static_cast<std::uint32_t>(count));
        if (std::find(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(k), sample[k]) ==
            sample.begin() + static_cast<std::ptrdiff_t>(k)) {
          ++k;
        }
      }
    }
    if (keep_if_better(estimator.FromSample(sample)) && !exhaustive) {
      const double limit = settings.max_hypotheses;  // the number needed may exceed the range of int
      const double num_needed = std::min(limit, SamplesNeeded(best->gamma, kSample, settings.confidence));
      needed = std::min(settings.max_hypotheses, std::max(tried + 1, static_cast<int>(std::ceil(num_needed))));
    }
  }
  if (!best) return std::nullopt;
  best->hypotheses = tried;

  best->probabilities.resize(count);
  const auto posterior = [&] {
    evaluate(best->model, estimator.SigmaPx(best->model));
    for (std::size_t i = 0; i < count; ++i) {
      best->probabilities[i] = best->gamma * ratios[i] / (best->gamma * ratios[i] + (1 - best->gamma));
    }
  };
  for (int round = 0; round < settings.refinements; ++round) {
    posterior();
    // One EM step: accept it only if the likelihood increases at the same sigma. With each model's own sigma, the model
    // of smaller scale would win.
    const double sigma_px = estimator.SigmaPx(best->model);
    const std::optional<Model> refined = estimator.FromWeights(best->probabilities);
    if (!refined) break;
    if (!(evaluate(*refined, sigma_px).log_likelihood > best->log_likelihood)) break;
    keep(*refined, evaluate(*refined, estimator.SigmaPx(*refined)));
  }
  posterior();
  return best;
}

}  // namespace victorious
