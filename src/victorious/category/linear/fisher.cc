#include "victorious/category/linear/fisher.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/category/common/sampling.h"
#include "victorious/category/common/vocabulary.h"
#include "victorious/category/linear/principal_axes.h"

namespace victorious {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXf;

// The square roots of the descriptors, one column per feature.
MatrixXf RootSiftColumns(const FeatureSet& features) {
  const std::vector<std::uint8_t> roots = RootDescriptors(features.descriptors);
  using Bytes = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>;
  return Eigen::Map<const Bytes>(roots.data(), static_cast<Index>(kDescriptorSize), static_cast<Index>(features.size()))
      .cast<float>();
}

// The projected descriptors, one column per feature; with encoder.append_position, the relative position is appended.
MatrixXf ProjectFeatures(const FisherEncoder& encoder, const FeatureSet& features) {
  const Index dimensions = encoder.projection.rows();
  const auto count = static_cast<Index>(features.size());
  MatrixXf reduced(dimensions + (encoder.append_position ? 2 : 0), count);
  reduced.topRows(dimensions).noalias() = encoder.projection * (RootSiftColumns(features).colwise() - encoder.mean);
  if (!encoder.append_position) return reduced;
  const auto width = static_cast<float>(std::max(1, features.image_width));
  const auto height = static_cast<float>(std::max(1, features.image_height));
  for (Index i = 0; i < count; ++i) {
    const Keypoint& keypoint = features.keypoints[static_cast<std::size_t>(i)];
    reduced(dimensions, i) = keypoint.x / width;
    reduced(dimensions + 1, i) = keypoint.y / height;
  }
  return reduced;
}

// Posteriors P(component | feature), components x features.
MatrixXf Posteriors(const FisherEncoder& encoder, const MatrixXf& reduced) {
  const MatrixXf precision = encoder.deviation.array().square().inverse();
  const VectorXf constant =
      encoder.mixture_weight.array().log() -
      (0.5F * precision.array() * encoder.centre.array().square() + encoder.deviation.array().log())
          .colwise()
          .sum()
          .transpose();
  MatrixXf posteriors = precision.cwiseProduct(encoder.centre).transpose() * reduced;
  posteriors.noalias() -= 0.5F * precision.transpose() * reduced.cwiseAbs2();
  posteriors.colwise() += constant;
  for (auto column : posteriors.colwise()) {
    column = (column.array() - column.maxCoeff()).exp();
    column /= column.sum();
  }
  return posteriors;
}

// Sums over the features of 1, x and x^2, weighted by the posteriors.
struct Moments {
  VectorXf zeroth;  // one per component
  MatrixXf first;   // values x components
  MatrixXf second;
};

Moments ComputeMoments(const FisherEncoder& encoder, const MatrixXf& reduced) {
  const MatrixXf posteriors = Posteriors(encoder, reduced);
  return {.zeroth = posteriors.rowwise().sum(),
          .first = reduced * posteriors.transpose(),
          .second = reduced.cwiseAbs2() * posteriors.transpose()};
}

// Samples at most `max_count` features of all sets, with positions relative to the size of their image.
FeatureSet SampleFeatures(std::span<const FeatureSet* const> sets, std::size_t max_count, Random& random) {
  std::vector<std::pair<const FeatureSet*, std::size_t>> all;
  for (const FeatureSet* set : sets)
    for (std::size_t i = 0; i < set->size(); ++i) all.emplace_back(set, i);
  FeatureSet drawn;
  drawn.image_width = drawn.image_height = 1;
  for (const std::uint32_t i : SampleIndices(all.size(), max_count, random)) {
    const auto& [set, at] = all[i];
    const auto row = std::span(set->descriptors).subspan(at * kDescriptorSize, kDescriptorSize);
    drawn.descriptors.insert(drawn.descriptors.end(), row.begin(), row.end());
    Keypoint keypoint = set->keypoints[at];
    keypoint.x /= static_cast<float>(std::max(1, set->image_width));
    keypoint.y /= static_cast<float>(std::max(1, set->image_height));
    drawn.keypoints.push_back(keypoint);
  }
  return drawn;
}

void FitProjection(const FeatureSet& sample, int dimensions, FisherEncoder& encoder) {
  const PrincipalAxes axes = FitPrincipalAxes(RootSiftColumns(sample));
  encoder.mean = axes.mean;
  encoder.projection = axes.Largest(dimensions).cast<float>();
}

// Fits the mixture by expectation-maximisation; the initial means are single features. Not cv::ml::EM: it
// has no lower bound of a component's variance relative to that of the data, which keeps a component off one feature.
void FitMixture(const MatrixXf& reduced, const FisherOptions& options, FisherEncoder& encoder) {
  const Index count = reduced.cols();
  const Index components = std::min<Index>(options.components, count);
  constexpr float kMinVariance = 1e-6F;
  const VectorXf spread = (reduced.colwise() - VectorXf(reduced.rowwise().mean())).cwiseAbs2().rowwise().mean();
  const VectorXf variance = spread.cwiseMax(kMinVariance);
  // The features are in random order, so the first ones are a random initialisation.
  encoder.centre = reduced.leftCols(components);
  encoder.deviation = (0.5F * variance.array().sqrt()).matrix().replicate(1, components);
  encoder.mixture_weight = VectorXf::Constant(components, 1.0F / static_cast<float>(components));
  for (int i = 0; i < options.iterations; ++i) {
    const Moments moments = ComputeMoments(encoder, reduced);
    for (Index k = 0; k < components; ++k) {
      constexpr float kMinFeatures = 1e-3F;
      constexpr float kMinVarianceFraction = 0.01F;  // avoids the singularity of a component on one feature
      const float weight = std::max(moments.zeroth(k), kMinFeatures);
      encoder.centre.col(k) = moments.first.col(k) / weight;
      const VectorXf own = moments.second.col(k) / weight - encoder.centre.col(k).cwiseAbs2();
      encoder.deviation.col(k) = own.cwiseMax(kMinVarianceFraction * variance).cwiseSqrt();
      encoder.mixture_weight(k) = weight;
    }
    encoder.mixture_weight /= encoder.mixture_weight.sum();
  }
}

}  // namespace

void FisherOptions::ListFields(FieldList& fields) {
  fields.Add("components", components,
             {.min = 0, .max = 4096, .reason = "components of the Gaussian mixture; 0: no Fisher vectors"});
  fields.Add("weight", weight,
             {.min = 0, .max = 100, .reason = "weight of the Fisher kernel relative to that of words"});
}

FisherEncoder FisherEncoder::Learn(std::span<const FeatureSet* const> sets, const FisherOptions& options,
                                   std::uint64_t seed) {
  FisherEncoder encoder;
  if (options.components == 0) return encoder;
  Random random(seed);
  const FeatureSet sample = SampleFeatures(sets, static_cast<std::size_t>(options.samples), random);
  VICTORIOUS_CHECK(sample.size() > 0);
  encoder.append_position = options.append_position;
  FitProjection(sample, options.dimensions, encoder);
  FitMixture(ProjectFeatures(encoder, sample), options, encoder);
  return encoder;
}

VectorXf FisherEncoder::Encode(const FeatureSet& features) const {
  if (features.size() == 0 || size() == 0) return VectorXf::Zero(static_cast<Index>(size()));
  const Moments moments = ComputeMoments(*this, ProjectFeatures(*this, features));
  const Index values = centre.rows();
  VectorXf vector(static_cast<Index>(size()));
  for (Index k = 0; k < centre.cols(); ++k) {
    const auto mean_k = centre.col(k);
    const auto deviation_k = deviation.col(k);
    const float count = moments.zeroth(k);
    const VectorXf first = (moments.first.col(k) - count * mean_k).cwiseQuotient(deviation_k);
    const VectorXf squares =
        moments.second.col(k) - 2 * mean_k.cwiseProduct(moments.first.col(k)) + count * mean_k.cwiseAbs2();
    const VectorXf second = squares.cwiseQuotient(deviation_k.cwiseAbs2()).array() - count;
    vector.segment(2 * values * k, values) = first / std::sqrt(mixture_weight(k));
    vector.segment(2 * values * k + values, values) = second / std::sqrt(2 * mixture_weight(k));
  }
  vector = vector.array().sign() * vector.array().abs().sqrt();
  const float length = vector.norm();
  return length > 0 ? VectorXf(vector / length) : vector;
}

}  // namespace victorious
